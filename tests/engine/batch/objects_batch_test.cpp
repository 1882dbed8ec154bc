// SPDX-License-Identifier: GPL-3.0-or-later
// Entries with `by: folder`: which objects they give, with which files and values, and what is wrong with them.

#include "engine/batch/batch_support.hpp"
#include "scanmill/batch/objects.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

class ObjectsBatch : public test::Batches {
protected:
    ObjectsBatch() {
        for (const char* view : {"a/v2.ply", "a/v1.ply", "b/v1.ply"}) folder_.write(std::string("o/") + view, "x");
        folder_.write("list.yaml",
                      "scanmill: 1\nname: l\ninputs: {views: {kind: points, list: true}}\nparameters: {n: 1}\n"
                      "steps: [combine: , {thin: {count: $n}}]\noutputs: {\"{scan}.ply\": thin}\n");
    }
    /// The findings of the whole check, for the scans in line 3.
    std::vector<std::string> check_objects(const std::string& list, const std::string& workflow = "list.yaml") {
        return check("scanmill: 1\nbatch: b\nscans: [" + list + "]\nworkflows: " + workflow + "\n");
    }
    std::string relative(const std::filesystem::path& file) const {
        return file.lexically_relative(folder_.path()).string();
    }
};

TEST_F(ObjectsBatch, FolderIsAnObject_WithItsFilesInTheOrderOfNames) {
    EXPECT_THAT(scans("[{path: o/*/*.ply, by: folder}]"), IsEmpty());
    EXPECT_THAT(names(), ElementsAre("o/a", "o/b"));
    EXPECT_EQ(batch_.scans[0].name(), "a");
    ASSERT_THAT(batch_.scans[0].views, SizeIs(2));
    EXPECT_EQ(relative(batch_.scans[0].views[0]), "o/a/v1.ply");
    EXPECT_EQ(relative(batch_.scans[0].views[1]), "o/a/v2.ply");
}

TEST_F(ObjectsBatch, ObjectIsOneCell_AndSingleScansStayOne) {
    EXPECT_THAT(check_objects("{path: o/*/*.ply, by: folder}"), IsEmpty());
    EXPECT_EQ(checked_.cells(), 2u);
    EXPECT_THAT(check_objects("{path: o/*/*.ply, by: folder}, scans/*.ply"), IsEmpty());
    EXPECT_EQ(checked_.cells(), 3u);
    ASSERT_THAT(checked_.parts, SizeIs(2));
    EXPECT_TRUE(checked_.has_run_per_scan(checked_.parts[0]));
    EXPECT_FALSE(checked_.has_run_per_scan(checked_.parts[1]));
}

TEST_F(ObjectsBatch, PlaceholdersAreTheObjectsNameAndItsFolder) {
    folder_.write("o/a/truth.stl", "x");
    folder_.write("o/b/truth.stl", "x");
    folder_.write("o/a/n-3.txt", "x");
    EXPECT_THAT(
        scans("[{path: o/*/*.ply, by: folder, truth: \"{folder}/tr*.stl\", frame: \"{stem}\", "
              "in: {more: \"{folder}/v*.ply\"}, set: {n: \"{folder}/n-*.txt\", m: \"x-{stem}\", k: \"{other}\"}}]"),
        ElementsAre(AllOf(HasSubstr("o/b' has no file for `n`: no file matches"))));
    const BatchScan& a = batch_.scans[0];
    EXPECT_EQ(relative(a.truth.files.at(0)), "o/a/truth.stl");
    EXPECT_EQ(a.frame, "{stem}") << "of each view";
    EXPECT_THAT(a.inputs.at("more").files, SizeIs(2));
    EXPECT_EQ(a.settings.at("n").values[0].literal.items[0], "o/a/n-3.txt") << "from the batch file";
    EXPECT_EQ(a.settings.at("m").values[0].literal.items[0], "x-a");
    EXPECT_EQ(a.settings.at("k").values[0].literal.items[0], "{other}");
    EXPECT_THAT(a.missing_settings, IsEmpty());
    EXPECT_THAT(batch_.scans[1].missing_settings.at("n").sentence, HasSubstr("n-*.txt"));
}

TEST_F(ObjectsBatch, WorkflowOfSingleScans_RefusesObjects) {
    EXPECT_THAT(check_objects("{path: o/*/*.ply, by: folder}", "w.yaml"),
                ElementsAre(AllOf(StartsWith("b:4:12: "), HasSubstr("takes one scan per run"),
                                  HasSubstr("the object 'a' has 2 views"), HasSubstr("`list: true`"))));
}

TEST_F(ObjectsBatch, PosesAndNotesThatAPathMatches_AreNotViews) {
    for (const char* other : {"a/views.conf", "a/notes.md", "b/README.txt", "b/poses.json"})
        folder_.write(std::string("o/") + other, "x");
    EXPECT_THAT(scans("[{path: o/*/*, by: folder}]"),
                ElementsAre(AllOf(StartsWith("b:3:"), HasSubstr("warning: "), HasSubstr("o/a/notes.md' and 3 more"))));
    ASSERT_THAT(batch_.scans, SizeIs(2));
    EXPECT_THAT(batch_.scans[0].views, ElementsAre(folder_ / "o/a/v1.ply", folder_ / "o/a/v2.ply"));
    EXPECT_THAT(batch_.scans[1].views, ElementsAre(folder_ / "o/b/v1.ply"));
    EXPECT_THAT(scans("[{path: o/a/*.conf, by: folder}]"),
                ElementsAre(AllOf(HasSubstr("views.conf' is not a scan by its extension"), HasSubstr("*.ply"))));
    EXPECT_THAT(batch_.scans, IsEmpty());
    EXPECT_THAT(scans("[{path: o/b/*.txt, by: folder}]"), IsEmpty()) << "texts alone may be points";
}

TEST_F(ObjectsBatch, FilesInNoFolderOfTheirOwn_AreRefused) {
    folder_.write("v.ply", "x");
    EXPECT_THAT(
        scans("[{path: \"*.ply\", by: folder}]"),
        ElementsAre(AllOf(HasSubstr("v.ply' is in the folder of the batch file"), HasSubstr("objects/*/*.ply"))));
}

TEST_F(ObjectsBatch, EntriesThatContradictThemselves_AreRefused) {
    EXPECT_THAT(scans("[{path: o/*/*.ply, by: name}]"), ElementsAre(HasSubstr("expected `by: folder`")));
    EXPECT_THAT(scans("[{path: o/*/*.ply, poses: p.conf}]"), ElementsAre(HasSubstr("need `by: folder`")));
    EXPECT_THAT(scans("[{path: o/*/*.ply, by: folder, pose: p.conf}]"), ElementsAre(HasSubstr("`poses: FILE`")));
    EXPECT_THAT(
        scans("[{path: o/a/v1.ply, by: folder}, {path: o/a/v2.ply, by: folder}]"),
        ElementsAre(AllOf(HasSubstr("o/a' is listed twice"), HasSubstr("all views of an object in one entry"))));
    folder_.write("o/a/p.conf", "bmesh v1.ply 0 0 0 0 0 0 1\nbmesh v2.ply 0 0 0 0 0 0 1\n");
    EXPECT_THAT(scans("[{path: o/a/*.ply, by: folder, poses: \"{folder}/p.conf\", set: {poses: q.conf}}]"),
                ElementsAre(HasSubstr("so does `poses` in line 3")));
    EXPECT_THAT(check_objects("{path: o/a/*.ply, by: folder, poses: o/a/p.conf}"),
                ElementsAre(AllOf(StartsWith("b:3:"), HasSubstr("no workflow has a parameter 'poses'"))));
}

TEST_F(ObjectsBatch, PosesOfViewsInOneFrame_AreAnErrorOfTheEntry) {
    for (const char* object : {"a", "c"}) {
        folder_.write(std::string("o/") + object + "/v1.ply", "x");
        folder_.write(std::string("o/") + object + "/v2.ply", "x");
        folder_.write(std::string("o/") + object + "/p.conf", "bmesh v1 0 0 0 0 0 0 1\nbmesh v2 0 0 0 0 0 0 1\n");
    }
    const auto write_workflow = [&](const std::string& frame) {
        folder_.write("posed.yaml", "scanmill: 1\nname: p\ninputs: {views: {kind: points, list: true" + frame +
                                        "}}\nparameters: {poses: none}\nsteps: [combine: ]\n");
    };
    const auto findings_of = [&](const std::string& entry) {
        std::vector<std::string> found = check_objects(entry, "posed.yaml");
        std::erase_if(found, [](const std::string& each) { return each.starts_with("posed:"); });
        return found;
    };
    write_workflow("");
    const std::string path = "path: \"o/[ac]/*.ply\", by: folder";
    EXPECT_THAT(findings_of("{" + path + ", frame: part}"),
                ElementsAre(AllOf(StartsWith("b:3:"), HasSubstr("2 views of the object 'a'"),
                                  HasSubstr("the frame 'part'"), HasSubstr("{stem}"))));
    EXPECT_THAT(findings_of("{" + path + ", frame: part, set: {poses: none}}"), IsEmpty());
    EXPECT_THAT(findings_of("{" + path + ", frame: \"f-{stem}\"}"), IsEmpty());
    write_workflow(", frame: part");
    EXPECT_THAT(findings_of("{" + path + "}"), ElementsAre(HasSubstr("the frame 'part'")));
    EXPECT_THAT(findings_of("{" + path + ", frame: \"{stem}\"}"), IsEmpty());
}

TEST_F(ObjectsBatch, FilesOfPosesBesideTheViews_GoByTheirNames) {
    const ObjectFolder object{folder_ / "o/b", {folder_ / "o/b/v1.ply"}};
    folder_.write("o/b/v1.ply.json", "x");
    EXPECT_EQ(poses_beside(object).file, "");
    folder_.write("o/b/made-poses.json", R"({"scanmill": 1, "poses": [{"scan": "v1", "rotation": [0, 0, 0, 1],
                                             "translation": [0, 0, 0]}]})");
    EXPECT_EQ(poses_beside(object).file, folder_ / "o/b/made-poses.json");
    EXPECT_TRUE(poses_beside(object).refusal.empty());
    folder_.write("o/b/other.conf", "x");
    EXPECT_THAT(poses_beside(object).refusal.sentence, AllOf(HasSubstr("made-poses.json"), HasSubstr("other.conf")));
    EXPECT_THAT(poses_beside(object).refusal.hint, HasSubstr("`poses`"));
}

TEST_F(ObjectsBatch, PosesOfCompressedViewsAndOfOthers_AreToldApart) {
    const std::filesystem::path file = folder_.write("p.conf", "bmesh v1.ply 0 0 0 0 0 0 1\nbmesh v2 0 0 0 0 0 0 1\n");
    EXPECT_TRUE(poses_in(file, {"o/a", {"o/a/v1.ply.gz", "o/a/v2.ply"}}).refusal.empty());
    EXPECT_THAT(poses_in(file, {"o/a", {"o/a/v1.ply"}}).refusal.sentence,
                AllOf(HasSubstr("a pose of 'v2'"), HasSubstr("1 view of the object 'a'")));
    EXPECT_THAT(poses_in(file, {"o/a", {"o/a/v1.ply", "o/a/v2.ply", "o/a/v3.ply"}}).refusal.sentence,
                AllOf(HasSubstr("no pose of the view 'v3.ply' of the object 'a'"), HasSubstr("v1.ply and v2")));
    EXPECT_TRUE(poses_in(file, {"o/a", {"o/a/all.ptx"}}).refusal.empty()) << "the file may hold views of any name";
    const std::filesystem::path unnamed =
        folder_.write("p.json", R"({"scanmill": 1, "poses": [{"rotation": [0, 0, 0, 1], "translation": [0, 0, 0]}]})");
    EXPECT_TRUE(poses_in(unnamed, {"o/a", {"o/a/v1.ply"}}).refusal.empty()) << "poses in the order of the views";
    EXPECT_THAT(poses_in(folder_ / "absent.conf", {"o/a", {"o/a/v1.ply"}}).refusal.sentence,
                HasSubstr("'a' has no poses"));
}

}  // namespace
}  // namespace scanmill
