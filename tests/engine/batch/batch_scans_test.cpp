// SPDX-License-Identifier: GPL-3.0-or-later
// Which files a batch means, and what each brings along.

#include <unistd.h>

#include "engine/batch/batch_support.hpp"
#include "scanmill/batch/scans.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

class ScanFiles : public testing::Test {
protected:
    void files(std::initializer_list<const char*> names) {
        for (const char* name : names) folder_.write(name, "x");
    }
    std::vector<std::string> found(const std::string& pattern) {
        std::vector<std::string> names;
        for (const auto& file : scan_files(folder_.path(), pattern))
            names.push_back(file.lexically_relative(folder_.path()).string());
        return names;
    }
    std::string refusal(const std::string& pattern) {
        return test::sentence_of([&] { scan_files(folder_.path(), pattern); });
    }

    test::TemporaryFolder folder_;
};

TEST_F(ScanFiles, Wildcards_StayWithinOneName_InTheOrderOfBytes) {
    files({"s/b.ply", "s/a.ply", "s/B.ply", "s/\xc3\xa4.ply", "s/a.xyz", "s/deep/c.ply", "t/d.ply"});
    EXPECT_THAT(found("s/*.ply"), ElementsAre("s/B.ply", "s/a.ply", "s/b.ply", "s/\xc3\xa4.ply"));
    EXPECT_THAT(found("s/?.ply"), ElementsAre("s/B.ply", "s/a.ply", "s/b.ply"));
    EXPECT_THAT(found("s/[ab].*"), ElementsAre("s/a.ply", "s/a.xyz", "s/b.ply"));
    EXPECT_THAT(found("s/[!ab].ply"), ElementsAre("s/B.ply"));
    EXPECT_THAT(found("[st]/*.ply"), SizeIs(5));
    EXPECT_THAT(found("*/deep/*.ply"), ElementsAre("s/deep/c.ply"));
}

TEST_F(ScanFiles, TwoStars_AreAnyNumberOfFolders) {
    files({"a.ply", "s/b.ply", "s/t/c.ply", "s/t/u/d.ply"});
    EXPECT_THAT(found("**/*.ply"), ElementsAre("a.ply", "s/b.ply", "s/t/c.ply", "s/t/u/d.ply"));
    EXPECT_THAT(found("s/**/*.ply"), ElementsAre("s/b.ply", "s/t/c.ply", "s/t/u/d.ply"));
    EXPECT_THAT(found("**/t/*.ply"), ElementsAre("s/t/c.ply"));
    EXPECT_THAT(found("**/**/d.ply"), ElementsAre("s/t/u/d.ply")) << "once, whatever the ways to it";
    EXPECT_THAT(refusal("s/**"), HasSubstr("'**' matches folders"));
}

TEST_F(ScanFiles, HiddenFilesAndFolders_AreOnlyFoundByTheirNames) {
    files({".hidden.ply", "a.ply", ".git/b.ply", "s/.t/c.ply"});
    EXPECT_THAT(found("*.ply"), ElementsAre("a.ply"));
    EXPECT_THAT(found("**/*.ply"), ElementsAre("a.ply"));
    EXPECT_THAT(found(".hid*"), ElementsAre(".hidden.ply"));
    EXPECT_THAT(found(".git/*.ply"), ElementsAre(".git/b.ply"));
}

TEST_F(ScanFiles, OnlyRegularFiles_AreFound) {
    files({"a.ply/inside", "b.ply"});
    std::filesystem::create_symlink("b.ply", folder_ / "link.ply");
    std::filesystem::create_symlink("nowhere", folder_ / "dangling.ply");
    EXPECT_THAT(found("*.ply"), ElementsAre("b.ply", "link.ply"));
}

TEST_F(ScanFiles, EntriesThatCannotBeRead_AreLeftOutWithAWarning) {
    files({"s/a.ply", "s/deep/b.ply"});
    std::filesystem::create_symlink("nowhere", folder_ / "s/deep/dangling.ply");
    std::filesystem::create_symlink("loop.ply", folder_ / "s/loop.ply");
    std::filesystem::create_symlink("nowhere", folder_ / "s/other.xyz");
    std::vector<std::string> warnings;
    const auto warn = [&](std::string sentence) { warnings.push_back(std::move(sentence)); };
    EXPECT_THAT(scan_files(folder_.path(), "**/*.ply", warn), SizeIs(2));
    EXPECT_THAT(warnings, testing::UnorderedElementsAre(
                              AllOf(HasSubstr("s/deep/dangling.ply' is a link that leads nowhere; it is left out")),
                              AllOf(HasSubstr("s/loop.ply' cannot be read"), HasSubstr("it is left out"))));
}

/// Permissions do not stop root, who becomes somebody else for the search.
TEST_F(ScanFiles, UnreadableFolders_CostTheirFilesAndNoMore) {
    files({"s/a.ply", "s/closed/b.ply", "s/listed/c.ply", "s/open/d.ply"});
    const uid_t self = ::geteuid();
    std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
    std::filesystem::permissions(folder_ / "s/closed", std::filesystem::perms::none);
    std::filesystem::permissions(folder_ / "s/listed", std::filesystem::perms(0444));
    ASSERT_TRUE(self != 0 || ::seteuid(65534) == 0);
    std::vector<std::string> warnings;
    const auto warn = [&](std::string sentence) { warnings.push_back(std::move(sentence)); };
    std::vector<std::filesystem::path> found;
    EXPECT_NO_THROW(found = scan_files(folder_.path(), "s/**/*.ply", warn));
    const std::string closed = test::sentence_of([&] { scan_files(folder_.path(), "s/closed/*.ply", warn); });
    ASSERT_TRUE(self != 0 || ::seteuid(0) == 0);
    for (const char* name : {"s/closed", "s/listed"})
        std::filesystem::permissions(folder_ / name, std::filesystem::perms(0755));
    EXPECT_THAT(found, ElementsAre(folder_ / "s/a.ply", folder_ / "s/open/d.ply"));
    EXPECT_THAT(warnings,
                testing::UnorderedElementsAre(AllOf(HasSubstr("s/closed' cannot be read"), HasSubstr("are left out")),
                                              AllOf(HasSubstr("s/listed' cannot be read"), HasSubstr("are left out"))));
    EXPECT_THAT(closed, HasSubstr("s/closed' cannot be read")) << "the folder that was named itself";
}

TEST_F(ScanFiles, LinksToFolders_AreFollowedByNameButNotByTwoStars) {
    files({"s/a.ply"});
    std::filesystem::create_directory_symlink(".", folder_ / "s/loop");
    EXPECT_THAT(found("s/**/*.ply"), ElementsAre("s/a.ply"));
    EXPECT_THAT(found("s/*/*.ply"), ElementsAre("s/loop/a.ply"));
}

TEST_F(ScanFiles, NameWithSpecialCharacters_IsTakenLiterallyWhenItIsThere) {
    files({"scan[1].ply", "scan1.ply", "*.ply", "x\\y.ply"});
    EXPECT_THAT(found("scan[1].ply"), ElementsAre("scan[1].ply"));
    EXPECT_THAT(found("*.ply"), ElementsAre("*.ply"));
    EXPECT_THAT(found("x\\y.ply"), ElementsAre("x\\y.ply"));
    EXPECT_THAT(found("scan[1].pl?"), ElementsAre("scan1.ply"));
}

TEST_F(ScanFiles, AbsolutePaths_DoNotCountFromTheFolder) {
    files({"s/a.ply"});
    EXPECT_EQ(scan_files("/nowhere", (folder_ / "s/*.ply").string()), std::vector{folder_ / "s/a.ply"});
    EXPECT_EQ(scan_files("/nowhere", (folder_ / "s/a.ply").string()), std::vector{folder_ / "s/a.ply"});
}

TEST_F(ScanFiles, NoFile_SaysWhereWasLooked) {
    files({"s/a.ply"});
    const std::string here = folder_.path().string();
    EXPECT_EQ(refusal("s/*.xyz"), "no file matches 's/*.xyz'; looked in '" + here + "/s'");
    EXPECT_EQ(refusal("t/*.ply"), "no file matches 't/*.ply'; there is no folder '" + here + "/t'");
    EXPECT_EQ(refusal("s/../*/b.ply"), "no file matches 's/../*/b.ply'; looked in '" + here + "'");
    EXPECT_EQ(refusal("s/b.ply"), "there is no file 'b.ply' in '" + here + "/s'");
    EXPECT_EQ(refusal("s"), "'s' is a folder; expected files, as 's/*.ply'");
    EXPECT_THAT(refusal("s/*/"), HasSubstr("ends in a slash"));
    EXPECT_THAT(refusal(""), HasSubstr("the path is empty"));
    EXPECT_THAT(refusal(std::string("a\0b", 3)), HasSubstr("zero byte"));
}

class BatchScans : public test::Batches {
protected:
    static std::string json(const std::string& poses) { return "{\"scanmill\": 1, \"poses\": [" + poses + "]}"; }
    static std::string pose(double x, const std::string& scan = "") {
        return "{" + (scan.empty() ? "" : "\"scan\": \"" + scan + "\", ") +
               "\"rotation\": [0, 0, 0, 1], \"translation\": [" + std::to_string(x) + ", 0, 0]}";
    }
    /// The pose of the only scan, when it is written inline as `text`.
    std::optional<RigidTransform> written(const std::string& text) {
        found_ = scans("[{path: scans/a.ply, unit: mm, pose: " + text + "}]");
        return batch_.scans.at(0).pose;
    }

    std::vector<std::string> found_;
};

TEST_F(BatchScans, EntriesKeepTheirOrder_FilesWithinOneAreSorted) {
    folder_.write("scans/0.xyz", "x");
    EXPECT_THAT(scans("[scans/b.ply, scans/a.ply, 'scans/*.xyz']"), IsEmpty());
    EXPECT_THAT(names(), ElementsAre("scans/b.ply", "scans/a.ply", "scans/0.xyz"));
}

TEST_F(BatchScans, FileOfTwoEntries_IsRefusedNamingBothLines) {
    EXPECT_THAT(scans("\n  - scans/a.ply\n  - scans/../scans/*.ply"),
                ElementsAre(AllOf(StartsWith("b:5:5: "), HasSubstr("a.ply' is listed twice; line 4"))));
    EXPECT_THAT(names(), SizeIs(2));
}

TEST_F(BatchScans, EntriesThatAreNone_AreRefused) {
    EXPECT_THAT(scans("[[a]]"), ElementsAre(HasSubstr("found a list; expected a path, as scans/*.ply, or")));
    EXPECT_THAT(scans("[{unit: mm}]"), ElementsAre(HasSubstr("the scan has no path")));
    EXPECT_THAT(scans("[{path: [a]}]"), ElementsAre(HasSubstr("found a list; expected a path")));
    EXPECT_THAT(scans("[{path: scans/*.ply, untis: mm}]"), ElementsAre(HasSubstr("a scan has no key 'untis'")));
    EXPECT_THAT(scans("[{path: scans/*.ply, frame: [x]}]"), ElementsAre(HasSubstr("expected a text for 'frame'")));
    EXPECT_THAT(scans("[{path: scans/*.ply, frame: '{scan}'}]"), ElementsAre(HasSubstr("unknown placeholder")));
    EXPECT_THAT(scans("[{path: scans/*.ply, truth: '{name}.stl'}]"), ElementsAre(HasSubstr("unknown placeholder")));
    EXPECT_THAT(scans("[{path: scans/*.ply, truth: ''}]"), ElementsAre(HasSubstr("the truth is empty")));
    EXPECT_THAT(scans("[{path: scans/*.ply, truth: [a]}]"), ElementsAre(HasSubstr("expected a file, as truth/")));
    EXPECT_THAT(scans("[{path: scans/*.ply, truth: {unit: mm}}]"), ElementsAre(HasSubstr("the truth has no path")));
    EXPECT_THAT(scans("[{path: scans/*.ply, truth: {path: a.stl, unti: mm}}]"),
                testing::Contains(AllOf(HasSubstr("a truth has no key 'unti'"), HasSubstr("'unit'?"))));
    EXPECT_THAT(scans("[{path: scans/*.ply, in: target.ply}]"), ElementsAre(HasSubstr("as {target: target.ply}")));
    EXPECT_THAT(scans("[{path: scans/*.ply, in: {'a b': t.ply}}]"),
                ElementsAre(HasSubstr("is not a name for an input")));
    EXPECT_THAT(scans("[{path: scans/*.ply, in: {t: []}}]"), ElementsAre(HasSubstr("the list of files")));
    EXPECT_THAT(scans("[{path: scans/*.ply, in: {t: ''}}]"), ElementsAre(HasSubstr("the input 't' is empty")));
    EXPECT_THAT(scans("[{path: scans/*.ply, in: {t: {}}}]"), ElementsAre(HasSubstr("expected a file, as targets/")));
    EXPECT_THAT(scans("[{path: scans/*.ply, in: {t: '{scan}.ply'}}]"), ElementsAre(HasSubstr("unknown placeholder")));
    EXPECT_THAT(scans("[{path: scans/*.ply, pose: }]"), ElementsAre(HasSubstr("expected a file, as poses/")));
}

/// It fails the cells of its scan, not the others.
TEST_F(BatchScans, MissingTruthOrFurtherInput_IsAWarningForEachScan) {
    folder_.write("truth/b.stl", "x");
    EXPECT_THAT(scans("[{path: scans/*.ply, truth: 'truth/{stem}.stl'}]"),
                ElementsAre(AllOf(StartsWith("b:3:36: warning: "),
                                  HasSubstr("truth/a.stl': there is no such file; expected the truth"),
                                  HasSubstr("scans/a.ply"))));
    EXPECT_EQ(batch_.scans[0].truth.files.front(), folder_ / "truth/a.stl");
    EXPECT_EQ(batch_.scans[1].truth.files.front(), folder_ / "truth/b.stl");
    EXPECT_THAT(scans("[{path: scans/a.ply, in: {to: [scans/b.ply, gone.ply]}}]"),
                ElementsAre(AllOf(StartsWith("b:3:52: warning: "), HasSubstr("expected the input 'to' of"))));
    EXPECT_THAT(batch_.scans[0].inputs.at("to").files, SizeIs(2));
}

TEST_F(BatchScans, WildcardsOfFurtherInputs_TakeTheFilesOfEachScan) {
    for (const char* name : {"clouds/a-2.ply", "clouds/a-1.ply", "clouds/b-1.ply", "clouds/c.ply"})
        folder_.write(name, "x");
    EXPECT_THAT(scans("[{path: 'scans/[ab].ply', in: {clouds: ['clouds/{stem}-*.ply', 'clouds/c.ply']}}]"), IsEmpty());
    EXPECT_THAT(batch_.scans[0].inputs.at("clouds").files,
                ElementsAre(folder_ / "clouds/a-1.ply", folder_ / "clouds/a-2.ply", folder_ / "clouds/c.ply"));
    EXPECT_THAT(batch_.scans[1].inputs.at("clouds").files,
                ElementsAre(folder_ / "clouds/b-1.ply", folder_ / "clouds/c.ply"));
}

TEST_F(BatchScans, WildcardsInTheNameOfAScan_MatchThemselves) {
    for (const char* name : {"parts/p[1].ply", "clouds/p[1]-1.ply", "clouds/p1-1.ply"}) folder_.write(name, "x");
    EXPECT_THAT(scans("[{path: 'parts/p[1].ply', in: {clouds: 'clouds/{stem}-*.ply'}}]"), IsEmpty());
    EXPECT_THAT(batch_.scans[0].inputs.at("clouds").files, ElementsAre(folder_ / "clouds/p[1]-1.ply"));
}

TEST_F(BatchScans, WildcardsOfFurtherInputsWithoutAMatch_AreAWarning) {
    folder_.write("clouds/a-1.ply", "x");
    EXPECT_THAT(scans("[{path: 'scans/[ab].ply', in: {clouds: 'clouds/{stem}-*.ply'}}]"),
                ElementsAre(AllOf(HasSubstr(": warning: no file matches 'clouds/b-*.ply'"),
                                  HasSubstr("expected the input 'clouds' of"), HasSubstr("scans/b.ply"))));
    EXPECT_THAT(batch_.scans[1].inputs.at("clouds").files, ElementsAre(folder_ / "clouds/b-*.ply")) << "it is missing";
}

TEST_F(BatchScans, StemOfACompressedScan_HasNeitherExtension) {
    folder_.write("packed/part.ply.gz", "x");
    folder_.write("truth/part.stl", "x");
    EXPECT_THAT(scans("[{path: packed/part.ply.gz, truth: {path: 'truth/{stem}.stl', frame: 'f-{stem}'}}]"), IsEmpty());
    EXPECT_EQ(batch_.scans[0].truth.files.front(), folder_ / "truth/part.stl");
    EXPECT_EQ(batch_.scans[0].truth.frame, "f-part");
}

TEST_F(BatchScans, FolderOfAScan_IsAPlaceholderOfItsFiles) {
    folder_.write("parts/one/scan.ply", "x");
    folder_.write("parts/two/scan.ply", "x");
    folder_.write("truth/one.stl", "x");
    folder_.write("truth/two.stl", "x");
    folder_.write("poses/one.json", json(pose(1)));
    folder_.write("poses/two.json", json(pose(2)));
    EXPECT_THAT(scans("[{path: parts/*/scan.ply, truth: 'truth/{folder}.stl', pose: 'poses/{folder}.json'}]"),
                IsEmpty());
    EXPECT_EQ(batch_.scans[0].truth.files.front(), folder_ / "truth/one.stl");
    EXPECT_EQ(batch_.scans[1].truth.files.front(), folder_ / "truth/two.stl");
    EXPECT_EQ(batch_.scans[1].pose->translation.x(), 2);
}

TEST_F(BatchScans, ManyMissingFiles_AreTenAndANumber) {
    for (int i = 0; i < 13; ++i) folder_.write("many/" + std::to_string(i) + ".ply", "x");
    const auto found = scans("[{path: many/*.ply, truth: 'truth/{stem}.stl'}]");
    ASSERT_THAT(found, SizeIs(11));
    EXPECT_THAT(found.back(), HasSubstr("3 more scans"));
}

TEST_F(BatchScans, ManyMissingFilesOfASetting_AreTenAndANumber) {
    for (int i = 0; i < 13; ++i) folder_.write("many/" + std::to_string(i) + ".ply", "x");
    const auto found = scans("[{path: many/*.ply, set: {n: '{stem}-*.txt'}}]");
    ASSERT_THAT(found, SizeIs(11));
    EXPECT_THAT(found.back(), AllOf(HasSubstr("3 more scans"), HasSubstr("`n`")));
    EXPECT_THAT(batch_.scans[12].missing_settings, SizeIs(1));
}

TEST_F(BatchScans, UnknownPlaceholderBesideAKnownOne_IsAnErrorOfTheSetting) {
    EXPECT_THAT(scans("[{path: scans/*.ply, set: {n: 'x-{stem}-{folde}.txt'}}]"),
                ElementsAre(AllOf(StartsWith("b:3:"), testing::Not(HasSubstr("warning")), HasSubstr("the setting 'n'"),
                                  HasSubstr("the unknown placeholder {folde}; it takes {stem} and {folder}"))));
    EXPECT_THAT(scans("[{path: scans/*.ply, set: {n: '{folde}.txt'}}]"), IsEmpty()) << "a text, not a template";
}

TEST_F(BatchScans, PoseOfAFile_IsTheScansOwnOrTheOnlyOne) {
    folder_.write("poses/a.json", json(pose(1)));
    folder_.write("poses/b.json", json(pose(7, "x.ply") + "," + pose(2, "b")));
    EXPECT_THAT(scans("[{path: scans/*.ply, unit: mm, pose: 'poses/{stem}.json'}]"), IsEmpty());
    EXPECT_EQ(batch_.scans[0].pose->translation.x(), 1);
    EXPECT_EQ(batch_.scans[1].pose->translation.x(), 2);
    EXPECT_EQ(batch_.scans[0].pose->unit, LengthUnit::unknown) << "the file names none: that of the scan";
}

TEST_F(BatchScans, PoseFilesThatDoNotHelp_AreRefusedWithTheirPath) {
    const auto refusal = [&](const std::string& content) {
        folder_.write("p.json", content);
        const auto found = scans("[{path: scans/a.ply, pose: p.json}]");
        EXPECT_THAT(found, ElementsAre(AllOf(StartsWith("b:3:35: '"), HasSubstr("p.json': "))));
        return found.front();
    };
    EXPECT_THAT(refusal("{}"), HasSubstr("with \"scanmill\": 1"));
    EXPECT_THAT(refusal(json(pose(1, "b.ply"))), HasSubstr("has no pose of 'a.ply'; it has poses of b.ply"));
    EXPECT_THAT(refusal(json(pose(1) + "," + pose(2))), HasSubstr("contains 2 poses, none of which names"));
    EXPECT_THAT(refusal(json(pose(1, "a") + "," + pose(2, "a.ply"))), HasSubstr("contains 2 poses of 'a.ply'"));
    EXPECT_THAT(scans("[{path: scans/a.ply, pose: absent.json}]"), ElementsAre(HasSubstr("there is no such file")));
}

TEST_F(BatchScans, RefusedScan_IsAWarning_AndHasItsReason) {
    folder_.write("p.json", json(pose(1, "a.ply") + ",{\"scan\": \"b.ply\", \"refused\": \"no-overlap\"}"));
    EXPECT_THAT(scans("[{path: scans/*.ply, pose: p.json}]"),
                ElementsAre(AllOf(StartsWith("b:3:35: warning: "), HasSubstr("'b.ply'"), HasSubstr("no-overlap"))));
    EXPECT_TRUE(batch_.scans[0].pose);
    EXPECT_TRUE(batch_.scans[0].refusal.empty());
    EXPECT_FALSE(batch_.scans[1].pose);
    EXPECT_THAT(batch_.scans[1].refusal.sentence, AllOf(HasSubstr("p.json"), HasSubstr("no-overlap")));
    EXPECT_THAT(batch_.scans[1].refusal.hint, HasSubstr("register the views again"));
}

TEST_F(BatchScans, MatrixAndQuaternion_AreTheSameMotion) {
    const auto matrix = written("[[0.28, -0.96, 0, 1], [0.96, 0.28, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]");
    EXPECT_THAT(found_, IsEmpty());
    const auto parts = written("{translation: [1, 2, 3], rotation: [0, 0, 0.6, 0.8]}");
    EXPECT_THAT(found_, IsEmpty());
    ASSERT_TRUE(matrix && parts);
    EXPECT_LT((matrix->rotation - parts->rotation).norm(), 1e-15);
    EXPECT_EQ(matrix->translation, Vec3(1, 2, 3));
    EXPECT_EQ(parts->translation, Vec3(1, 2, 3));
    EXPECT_EQ(parts->unit, LengthUnit::millimetre);
}

TEST_F(BatchScans, PosesInPlaceThatAreNone_AreRefusedWhereTheyAreWrong) {
    const auto refusals = [&](const std::string& text) {
        EXPECT_FALSE(written(text)) << text;
        return found_;
    };
    EXPECT_THAT(refusals("[]"), ElementsAre(HasSubstr("a matrix of 0 rows")));
    EXPECT_THAT(refusals("[[1]]"), ElementsAre(HasSubstr("a matrix of 1 row; expected 4 rows")));
    EXPECT_THAT(refusals("[[1, 0, 0, 0], [0, 1, 0], 5, [0, 0, x, 1]]"),
                ElementsAre(HasSubstr("a list of 3 values; expected a row of 4 numbers"), HasSubstr("found '5'"),
                            HasSubstr("'x' is not a finite number")));
    EXPECT_THAT(refusals("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, inf, 0], [0, 0, 0, 1]]"),
                ElementsAre(HasSubstr("'inf' is not a finite number")));
    EXPECT_THAT(refusals("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]]"),
                ElementsAre(HasSubstr("the last row of the matrix is 1 2 3 1; expected 0 0 0 1")));
    EXPECT_THAT(refusals("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]"),
                ElementsAre(HasSubstr("is a reflection")));
    EXPECT_THAT(refusals("{translation: [1, 2, 3]}"), ElementsAre(HasSubstr("the pose has no rotation")));
    EXPECT_THAT(refusals("{rotation: [0, 0, 0, 1]}"), ElementsAre(HasSubstr("the pose has no translation")));
    EXPECT_THAT(refusals("{translation: [1, 2], rotation: [0, 0, 0]}"), SizeIs(2));
    EXPECT_THAT(refusals("{translation: [1, 2, 3], rotation: [0, 0, 0, 2]}"),
                ElementsAre(HasSubstr("the quaternion 0 0 0 2 has the length 2")));
    EXPECT_THAT(refusals("{translatoin: [1, 2, 3], rotation: [0, 0, 0, 1]}"),
                ElementsAre(HasSubstr("the pose has no translation"), HasSubstr("did you mean 'translation'?")));
}

TEST_F(BatchScans, RuleForInvalidRows_IsReadAndNeedsAWorkflowOfPoints) {
    EXPECT_THAT(scans("[{path: scans/a.ply, invalid: drop}, scans/b.ply]"), IsEmpty());
    EXPECT_EQ(batch_.scans[0].invalid, InvalidRows::drop);
    EXPECT_EQ(batch_.scans[1].invalid, InvalidRows::by_format);
    EXPECT_THAT(scans("[{path: scans/a.ply, invalid: keep}]"),
                ElementsAre(AllOf(HasSubstr("'keep'"), HasSubstr("expected drop or refuse"))));
    const std::string batch = "scanmill: 1\nbatch: b\nscans: [{path: scans/*.ply, invalid: drop}]\nworkflows: ";
    EXPECT_THAT(check(batch + "w.yaml\n"), IsEmpty());
    folder_.write("m.yaml",
                  "scanmill: 1\ninputs: {mesh: mesh}\nsteps: [{simplify: {max-error: 1 u}}]\noutputs: "
                  "{'{scan}.stl': simplify}\n");
    EXPECT_THAT(check(batch + "m.yaml\n"), ElementsAre(AllOf(testing::StartsWith("b:3:29: "),
                                                             HasSubstr("no workflow of the batch takes points"))));
}

}  // namespace
}  // namespace scanmill
