// SPDX-License-Identifier: GPL-3.0-or-later
// Objects of many views: folders of views in batches and on the command line of `run`.

#include <set>

#include "runner/batch_fixture.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

namespace fs = std::filesystem;

class Objects : public Batch {
protected:
    Objects() {
        folder_.write("w.yaml",
                      "scanmill: 1\nname: joined\ninputs: {views: {kind: points, list: true, frame: \"{stem}\"}}\n"
                      "parameters: {poses: none}\nsteps:\n  - merge: {poses: $poses}\n"
                      "  - voxel-thin: {bin-size: 0.001 u}\noutputs: {\"{scan}.ply\": voxel-thin}\n");
    }
    /// A view of eight points that no other view has.
    void write_view(const std::string& file) {
        const double at = 10 * static_cast<double>(++scans_);
        std::string text =
            "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\n"
            "property double z\nend_header\n";
        for (int i = 0; i < 8; ++i) text += fmt::format("{} {} {}\n", at + i % 2, i / 2 % 2, i / 4);
        folder_.write(file, text);
    }
    /// FOLDER/v1.ply … and, with `poses`, FOLDER/views.conf.
    void write_object(const std::string& folder, int views, bool poses = true) {
        for (int view = 1; view <= views; ++view) write_view(fmt::format("{}/v{}.ply", folder, view));
        if (poses) write_poses(folder + "/views.conf", views);
    }
    void write_poses(const std::string& file, int views) {
        std::string text;
        for (int view = 1; view <= views; ++view) text += fmt::format("bmesh v{}.ply 0 0 {} 0 0 0 1\n", view, view);
        folder_.write(file, text);
    }
    void write_objects(const std::string& entry, const std::string& rest = "") {
        folder_.write("b.yaml", "scanmill: 1\nbatch: b\nscans: [" + entry + "]\nworkflows: w.yaml\n" + rest);
    }
    /// The cell of a scan in the recorded run.
    static Json cell(const Json& run, const std::string& scan) {
        for (const Json& cell : run["cells"])
            if (cell["scan"] == scan) return cell;
        return {};
    }
    /// The scans of the steps that the recorded run computed.
    static std::set<std::string> computed(const Json& run) {
        std::set<std::string> scans;
        for (const Json& step : run["steps"])
            if (step["origin"] == "ran") scans.insert(step["scan"].get<std::string>());
        return scans;
    }
    static double height(const PointCloud& cloud) {
        const BoundingBox box = bounding_box(cloud.positions.span());
        return box.high.z() - box.low.z();
    }
    ProgramResult run(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"run", "w.yaml"});
        arguments.insert(arguments.end(), {"-o", "out"});
        return scanmill(arguments);
    }
};

TEST_F(Objects, TwelveOfSixViews_AreTwelveCells_AndARerunComputesOnlyWhatIsNew) {
    for (int object = 1; object <= 12; ++object) write_object(fmt::format("objects/o{:02}", object), 6, object != 5);
    fs::remove(folder_ / "objects/o03/v4.ply");
    const std::string view = content_of(folder_ / "objects/o07/v2.ply");
    folder_.write("objects/o07/v2.ply", view.substr(0, view.size() - 20));
    write_objects("{path: objects/*/*.ply, by: folder, poses: \"{folder}/*.conf\"}");
    EXPECT_THAT(scanmill({"check", "b.yaml"}).out,
                HasSubstr("12 objects of 71 view files, 1 workflow, 1 variant, 12 cells"));

    const ProgramResult first = run_batch({"--keep", "always"});
    EXPECT_EQ(first.exit_code, 1);
    EXPECT_THAT(first.out, HasSubstr("3 of 12 failed"));
    EXPECT_THAT(first.err, AllOf(ContainsRegex("views.conf' has a pose of 'v4.ply'.* 5 views of the object 'o03'"),
                                 ContainsRegex("the object 'o05' has no poses: no file matches"),
                                 HasSubstr("objects/o07/v2.ply'")));
    const Json report = recorded(1);
    EXPECT_EQ(count(report["cells"], "outcome", "ok"), 9u);
    EXPECT_EQ(cell(report, "objects/o07")["outcome"], "failed");
    EXPECT_THAT(outputs(), SizeIs(9));
    const auto cloud = read_points(folder_ / "out/o01.ply");
    EXPECT_EQ(cloud->size(), 48u);
    EXPECT_EQ(height(*cloud), 6) << "the views are moved by their poses";

    EXPECT_EQ(run_batch({"--keep", "always"}).exit_code, 1);
    EXPECT_THAT(computed(recorded(2)), testing::IsSubsetOf({"objects/o03", "objects/o05", "objects/o07"}));
    write_view("objects/o09/v7.ply");
    write_poses("objects/o09/views.conf", 7);
    EXPECT_EQ(run_batch({"--keep", "always"}).exit_code, 1);
    EXPECT_THAT(computed(recorded(3)),
                AllOf(testing::Contains("objects/o09"),
                      testing::IsSubsetOf({"objects/o03", "objects/o05", "objects/o07", "objects/o09"})));
    EXPECT_EQ(read_points(folder_ / "out/o09.ply")->size(), 56u);
}

TEST_F(Objects, PosesBesideTheViews_AreFoundAndSaid) {
    write_object("objects/a", 2);
    write_object("objects/b", 2, false);
    write_objects("{path: objects/*/*.ply, by: folder}");
    EXPECT_THAT(scanmill({"check", "b.yaml", "--plan"}).out,
                AllOf(HasSubstr("object a: 2 view files in objects/a, poses in objects/a/views.conf\n"),
                      HasSubstr("object b: 2 view files in objects/b\n")));
    const ProgramResult ran = run_batch();
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(height(*read_points(folder_ / "out/a.ply")), 2);
    EXPECT_EQ(height(*read_points(folder_ / "out/b.ply")), 1);
    write_objects("{path: objects/*/*.ply, by: folder}", "set: {poses: none}\n");
    ASSERT_EQ(run_batch().exit_code, 0);
    EXPECT_EQ(height(*read_points(folder_ / "out/a.ply")), 1) << "a setting wins";
}

TEST_F(Objects, PosesThatDoNotFit_FailTheirObjectAlone) {
    for (const char* object : {"good", "other", "two"}) write_object(fmt::format("objects/{}", object), 2);
    folder_.write("objects/other/views.conf", "bmesh v1.ply 0 0 0 0 0 0 1\nbmesh left.ply 0 0 0 0 0 0 1\n");
    write_poses("objects/two/second.conf", 2);
    write_objects("{path: objects/*/*.ply, by: folder}");
    for (const ProgramResult& ran : {run_batch(), run({"objects/good", "objects/other", "objects/two/"})}) {
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_THAT(ran.out, AllOf(HasSubstr("2 of 3 failed"), HasSubstr("good.ply")));
        EXPECT_THAT(ran.err, AllOf(HasSubstr("no pose of the view 'v2.ply' of the object 'other'"),
                                   HasSubstr("'two' has 2 files of poses, 'second.conf' and 'views.conf'\n"),
                                   ContainsRegex("hint: add the pose of the view"), HasSubstr("hint: give one as")));
    }
    write_objects("{path: objects/two/*.ply, by: folder, poses: \"{folder}/se*.conf\"}");
    EXPECT_EQ(run_batch().exit_code, 0);
}

TEST_F(Objects, MissingPosesAndSettings_FailOnlyTheWorkflowsThatTakeThem) {
    write_object("objects/a", 2);
    write_poses("objects/a/second.conf", 2);
    folder_.write("objects/b/v1.ply", content_of(folder_ / "objects/a/v1.ply"));
    const auto write_workflow = [&](const std::string& name, const std::string& parameters, const std::string& merge) {
        folder_.write(name + ".yaml", "scanmill: 1\nname: " + name + "\n" + parameters +
                                          "inputs: {views: {kind: points, list: true, frame: \"{stem}\"}}\nsteps: [" +
                                          merge + "]\noutputs: {\"{workflow}-{scan}.ply\": merge}\n");
    };
    write_workflow("plain", "", "merge: ");
    write_workflow("named", "parameters: {file: none}\n", "{merge: {poses: $file}}");
    folder_.write("b.yaml",
                  "scanmill: 1\nbatch: b\nscans: [{path: objects/*/*.ply, by: folder, set: {file: "
                  "\"{folder}/view?.json\"}}]\nworkflows: [w.yaml, plain.yaml, named.yaml]\n");
    const ProgramResult ran = run_batch();
    EXPECT_EQ(ran.exit_code, 1) << ran.err;
    const Json report = recorded(1);
    std::map<std::string, std::string> outcomes;
    for (const Json& cell : report["cells"])
        outcomes[cell["workflow"].get<std::string>() + " " + cell["scan"].get<std::string>()] = cell["outcome"];
    EXPECT_THAT(outcomes,
                ElementsAre(testing::Pair("joined objects/a", "failed"), testing::Pair("joined objects/b", "ok"),
                            testing::Pair("named objects/a", "failed"), testing::Pair("named objects/b", "failed"),
                            testing::Pair("plain objects/a", "ok"), testing::Pair("plain objects/b", "ok")));
}

TEST_F(Objects, DryRun_NamesThePosesOfEachObject) {
    write_object("objects/a", 2);
    write_object("objects/b", 2, false);
    EXPECT_THAT(run({"objects/a", "objects/b", "--dry-run"}).out, HasSubstr("        reads objects/a/views.conf\n"));
    const Json plan = Json::parse(run({"objects/a", "objects/b", "--dry-run", "--json"}).out);
    std::vector<Json> files;
    for (const Json& node : plan["nodes"])
        if (node["step"] == "merge") files.push_back(node.value("parameter-files", Json()));
    EXPECT_THAT(files, ElementsAre(Json{"objects/a/views.conf"}, Json()));
}

TEST_F(Objects, FoldersOnTheCommandLine_AreOneObjectEach) {
    write_object("objects/part.v2", 3);
    write_object("objects/b", 2);
    folder_.write("objects/b/notes.md", "x");
    const ProgramResult ran = run({"objects/part.v2/", "objects/b/"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(read_points(folder_ / "out/part.v2.ply")->size(), 24u) << "the name of a folder has no extension";
    EXPECT_EQ(read_points(folder_ / "out/b.ply")->size(), 16u);
    const Json report = recorded(1);
    EXPECT_EQ(cell(report, "objects/b")["outcome"], "ok");
    EXPECT_EQ(scanmill({"report", "out"}).exit_code, 0);
    ASSERT_EQ(run({"objects/b/v1.ply", "objects/b/v2.ply", "--set", "poses=objects/b/views.conf"}).exit_code, 0);
    EXPECT_EQ(content_of(folder_ / "out/joined.ply"), content_of(folder_ / "out/b.ply"))
        << "a folder is the same as its files";
}

TEST_F(Objects, ArgumentsThatAreNoObjects_AreRefusedInASentence) {
    write_object("objects/a", 2);
    fs::create_directories(folder_ / "empty");
    folder_.write("texts/notes.md", "x");
    const auto refusal = [&](const std::vector<std::string>& arguments) {
        const ProgramResult ran = run(arguments);
        EXPECT_EQ(ran.exit_code, 2) << ran.err;
        return ran.err;
    };
    EXPECT_THAT(refusal({"empty"}),
                AllOf(HasSubstr("the folder 'empty' has no views: it has no files"), HasSubstr("hint: ")));
    EXPECT_THAT(refusal({"texts/"}), HasSubstr("none of its 1 file is a scan"));
    EXPECT_THAT(refusal({"objects"}), HasSubstr("as objects/*/"));
    EXPECT_THAT(
        refusal({"objects/a", "objects/a/v1.ply"}),
        AllOf(HasSubstr("'objects/a' is a folder and 'objects/a/v1.ply' is a file"), HasSubstr("only folders")));
}

TEST_F(Objects, TwoFoldersOfOneName_NeedTwoNamesOfOutputs) {
    write_object("a/x", 2);
    write_object("b/x", 2);
    write_objects("{path: \"[ab]/x/*.ply\", by: folder}");
    for (const ProgramResult& ran : {run_batch(), run({"a/x", "b/x"})})
        EXPECT_THAT(ran.err, AllOf(HasSubstr("a/x"), HasSubstr("b/x"), HasSubstr("x.ply"), HasSubstr("{folder}")));
    const std::string workflow = content_of(folder_ / "w.yaml");
    folder_.write("w.yaml",
                  workflow.substr(0, workflow.find("outputs")) + "outputs: {\"{folder}-{scan}.ply\": voxel-thin}\n");
    ASSERT_EQ(run_batch().exit_code, 0);
    EXPECT_TRUE(fs::exists(folder_ / "out/a-x.ply"));
    EXPECT_TRUE(fs::exists(folder_ / "out/b-x.ply"));
}

TEST_F(Objects, OneObject_RunsAlone) {
    write_object("objects/a", 2);
    write_object("objects/b", 2);
    write_objects("{path: objects/*/*.ply, by: folder}");
    for (const char* name : {"objects/b", "objects/b/"}) {
        fs::remove_all(folder_ / "out");
        ASSERT_EQ(run_batch({"--scan", name}).exit_code, 0);
        EXPECT_THAT(outputs(), ElementsAre(testing::Key("b.ply")));
    }
}

TEST_F(Objects, FileOfSeveralViews_IsAllOfThem) {
    std::string scan = "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    std::string scans;
    for (int view = 0; view < 2; ++view) {
        scans += scan;
        for (int i = 0; i < 4; ++i) scans += fmt::format("{} {} 1 0.5\n", 7 * view + i, i * i);
    }
    folder_.write("objects/room/all.ptx", scans);
    write_object("objects/room", 1);
    const ProgramResult ran = run({"objects/room"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const auto cloud = read_points(folder_ / "out/room.ply");
    EXPECT_EQ(cloud->size(), 16u);
    EXPECT_EQ(cloud->columns.find("source")->number(15), 2) << "three views";
}

TEST_F(Objects, PosesBesideAFileWithItsOwn_AreWarnedOf) {
    folder_.write("objects/room/all.ptx",
                  "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
                  "1 0 1 0.5\n2 1 1 0.5\n3 4 1 0.5\n4 9 1 0.5\n");
    write_poses("objects/room/views.conf", 1);
    write_objects("{path: objects/*/*.ptx, by: folder}");
    for (const ProgramResult& ran : {run_batch(), run({"objects/room"})}) {
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_THAT(ran.err, AllOf(HasSubstr("takes the poses in its views, as 'all.ptx'"),
                                   HasSubstr("'objects/room/views.conf' is not used")));
    }
    EXPECT_THAT(run({"objects/room", "--set", "poses=none"}).err, testing::Not(HasSubstr("is not used")));
}

TEST_F(Objects, Results_AreNoObject_AndNoViews) {
    write_object("o1", 2);
    write_objects("{path: \"*/*.ply\", by: folder}");
    EXPECT_EQ(scanmill({"batch", "b.yaml", "-o", "results"}).exit_code, 0);
    const ProgramResult again = scanmill({"batch", "b.yaml", "-o", "results"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.err, HasSubstr("'results' holds results (scanmill.sqlite), so it is not taken as an object"));
    const ProgramResult named = run({"results"});
    EXPECT_EQ(named.exit_code, 2);
    EXPECT_THAT(named.err, HasSubstr("'results' holds results (scanmill.sqlite), which do not count as views"));
}

TEST_F(Objects, ViewsBesideTheBatch_AreRefused_HoweverTheBatchIsNamed) {
    write_view("v1.ply");
    write_objects("{path: \"*.ply\", by: folder}");
    for (const char* name : {"b.yaml", "./b.yaml"}) {
        const ProgramResult checked = scanmill({"check", name});
        EXPECT_EQ(checked.exit_code, 2) << name;
        EXPECT_THAT(checked.err, HasSubstr("v1.ply' is in the folder of the batch file")) << name;
    }
}

TEST_F(Objects, ATextBesideOtherViews_IsNoView) {
    write_object("o1", 2);
    folder_.write("o1/README.txt", "Views of the first day\n");
    const ProgramResult ran = run({"o1"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("'o1/README.txt' is not taken as a view"));
}

}  // namespace
}  // namespace scanmill::test
