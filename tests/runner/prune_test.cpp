// SPDX-License-Identifier: GPL-3.0-or-later
// `runs DIR --prune`: what goes, what stays, and every refusal.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "scanmill/records/run_records.hpp"
#include "scanmill/session/output_lock.hpp"
#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/report_page.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Prune : public testing::Test {
protected:
    Prune() {
        for (const char* name : {"a", "b", "c d:é"})
            folder_.write(std::string(name) + ".xyz", "0 0 0\n1 0 0\n0 2 0\n1 2 2\n");
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points}\nparameters: {size: 0.1 u}\nsteps:\n"
                      "  - voxel-thin: {bin-size: $size}\n    expect: {kept: \"> 3\"}\noutputs: {'sub/{scan}.ply': "
                      "voxel-thin}\n");
    }
    ProgramResult scanmill(const std::vector<std::string>& arguments) {
        return scanmill_program(arguments, {.folder = folder_.path(), .cache = folder_ / "home"});
    }
    void run(const std::string& scan, const std::string& size = "0.1 u") {
        scanmill({"run", "w.yaml", scan, "-o", "out", "-q", "--set", "size=" + size});
    }
    ProgramResult prune(const std::string& keep, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"runs", "out", "--prune", "--keep", keep};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return scanmill(arguments);
    }
    std::vector<int> runs() {
        std::vector<int> numbers;
        const auto listed = nlohmann::json::parse(scanmill({"runs", "out", "--json"}).out);
        for (const auto& run : listed["runs"]) numbers.push_back(run["id"]);
        return numbers;
    }
    bool exists(const std::string& file) const { return fs::exists(folder_ / "out" / file); }

    TemporaryFolder folder_;
};

TEST_F(Prune, OldRunsGo_WithTheFilesThatNoOtherRunNames) {
    run("c d:é.xyz");
    run("a.xyz");
    run("a.xyz");
    run("b.xyz");
    const ProgramResult result = prune("2");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("removed 2 runs (1 to 2) and 1 file ("), HasSubstr("the records had ")));
    EXPECT_THAT(runs(), ElementsAre(3, 4));
    EXPECT_FALSE(exists("sub/c d:é.ply")) << "only run 1 named it";
    EXPECT_FALSE(exists("sub/c d:é.ply.json"));
    EXPECT_TRUE(exists("sub/a.ply")) << "run 3 names it, too";
    EXPECT_TRUE(exists("sub/b.ply"));
    EXPECT_THAT(scanmill({"runs", "out", "show", "1"}).err,
                HasSubstr("there is no run 1 in 'out/scanmill.sqlite'; it has the runs 3 to 4"));
    EXPECT_EQ(scanmill({"runs", "out", "show", "3"}).exit_code, 0);
    run("a.xyz");
    EXPECT_THAT(runs(), ElementsAre(3, 4, 5)) << "numbers are not used again";
    EXPECT_THAT(prune("7").out, HasSubstr("removed 0 runs (none) and 0 files"));
}

TEST_F(Prune, AcceptedRunsStay_AndRevokedOnesGo) {
    for (int night = 0; night < 4; ++night) run("a.xyz");
    scanmill({"report", "out", "--accept", "--run", "1", "--who", "Ann", "--why", "good"});
    scanmill({"report", "out", "--accept", "--run", "2", "--who", "Ann", "--why", "good"});
    scanmill({"report", "out", "--revoke", "--who", "Ann", "--why", "by mistake"});
    prune("1");
    EXPECT_THAT(runs(), ElementsAre(1, 4));
    EXPECT_THAT(scanmill({"report", "out"}).out, HasSubstr("against run 1")) << "the gate still has its baseline";
}

TEST_F(Prune, AFileThatSomethingElseChanged_Stays) {
    run("a.xyz");
    run("b.xyz");
    folder_.write("out/sub/a.ply", "mine\n");
    const ProgramResult result = prune("1");
    EXPECT_THAT(result.out, HasSubstr("1 file of these runs stays, because something else changed it since"));
    EXPECT_EQ(content_of(folder_ / "out/sub/a.ply"), "mine\n");
}

TEST_F(Prune, AFailedResultGoes_WithItsEmptyFolders) {
    run("a.xyz", "9 u");
    ASSERT_TRUE(exists("failed/sub/a.ply"));
    run("b.xyz");
    EXPECT_THAT(prune("1").out, HasSubstr("and 1 file ("));
    EXPECT_FALSE(exists("failed"));
}

TEST_F(Prune, AKeptRunThatLostItsFiles_IsWarnedOf_AndListed) {
    run("a.xyz");
    run("b.xyz");
    fs::remove(folder_ / "out/sub/b.ply");
    EXPECT_THAT(scanmill({"runs", "out"}).out, HasSubstr("0 B, 1 gone"));
    const ProgramResult result = prune("1");
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.err, HasSubstr("warning: run 2 stays, but 1 file that it wrote is gone"));
    EXPECT_THAT(runs(), ElementsAre(2));
}

TEST_F(Prune, AFolderMovedBehindALink_KeepsTheFilesOfRunsThatStay) {
    run("a.xyz");
    fs::create_directories(folder_ / "disk");
    fs::rename(folder_ / "out", folder_ / "disk/out");
    fs::create_directory_symlink("disk/out", folder_ / "out");
    run("a.xyz");
    EXPECT_THAT(prune("1").out, HasSubstr("removed 1 run (1) and 0 files"));
    EXPECT_TRUE(exists("sub/a.ply")) << "run 2 names it by its new path";
}

TEST_F(Prune, AnOutputThatIsCalledLikeADescription_Stays) {
    run("a.xyz");
    folder_.write("out/sub/a.ply.json", "{\"mine\": 1}\n");
    run("b.xyz");
    prune("1");
    EXPECT_FALSE(exists("sub/a.ply"));
    EXPECT_EQ(content_of(folder_ / "out/sub/a.ply.json"), "{\"mine\": 1}\n") << "it does not describe the file";
}

TEST_F(Prune, InterruptedRuns_DoNotCount) {
    run("a.xyz");
    RunRecords records = RunRecords::append_to(folder_ / "out" / records_file);
    RunStart start;
    start.workflow = "w";
    records.begin(start);  // killed: it has no end
    records.end(records.begin(start), "interrupted", 1);
    EXPECT_THAT(prune("1").out, HasSubstr("removed 0 runs"));
    EXPECT_TRUE(exists("sub/a.ply"));
    run("b.xyz");
    EXPECT_THAT(prune("1").out, HasSubstr("removed 3 runs (1 to 3)"));
    EXPECT_THAT(runs(), ElementsAre(4));
}

TEST_F(Prune, AnOutputThatAKeptRunReads_Stays) {
    run("a.xyz");
    folder_.write("next.yaml",
                  "scanmill: 1\nname: next\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: 0.1 u}\n"
                  "outputs: {'{scan}-next.ply': voxel-thin}\n");
    scanmill({"run", "next.yaml", "out/sub/a.ply", "-o", "out", "-q"});
    run("b.xyz");
    EXPECT_THAT(prune("1").out, HasSubstr("1 file of these runs stays, because runs that stay read files of its name"));
    EXPECT_TRUE(exists("sub/a.ply"));
}

TEST_F(Prune, PreviewsOfRemovedRuns_Go) {
    if (!has_report_page()) GTEST_SKIP() << no_report_page;
    const auto previews = [&] {
        std::size_t count = 0;
        for (const auto& entry : fs::directory_iterator(folder_ / "out/previews"))
            count += entry.path().extension() == ".png";
        return count;
    };
    folder_.write("b.xyz", "0 0 0\n1 0 0\n0 3 0\n1 2 5\n");
    run("a.xyz");
    scanmill({"report", "out", "--html", "page.html"});
    const std::size_t of_first = previews();
    ASSERT_GE(of_first, 1u);
    run("b.xyz");
    scanmill({"report", "out", "--html", "page.html"});
    const std::size_t of_both = previews();
    ASSERT_GT(of_both, of_first);
    EXPECT_THAT(prune("1", {"--dry-run"}).out, HasSubstr("would remove previews for pages ("));
    EXPECT_EQ(previews(), of_both);
    EXPECT_THAT(prune("1").out, HasSubstr("removed previews for pages ("));
    EXPECT_EQ(previews(), of_both - of_first);
    EXPECT_THAT(prune("1").out, Not(HasSubstr("previews")));
}

TEST_F(Prune, DryRun_NamesTheFilesAndRemovesNothing) {
    run("a.xyz");
    run("b.xyz");
    const ProgramResult result = prune("1", {"--dry-run"});
    EXPECT_THAT(result.out, AllOf(HasSubstr("out/sub/a.ply\n"), HasSubstr("would remove 1 run (1) and 1 file")));
    EXPECT_THAT(runs(), ElementsAre(1, 2));
    EXPECT_TRUE(exists("sub/a.ply"));
    const auto document = nlohmann::json::parse(prune("1", {"--json"}).out);
    EXPECT_EQ(document["runs"], nlohmann::json({1}));
    EXPECT_EQ(document["files"].size(), 1u);
    EXPECT_FALSE(exists("sub/a.ply"));
}

TEST_F(Prune, WhileARunWrites_IsRefused) {
    run("a.xyz");
    run("b.xyz");
    const OutputLock lock(folder_ / "out", {"scanmill", "batch"}, [](const std::string&) {});
    const ProgramResult refused = prune("1");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("the output folder 'out' is in use"));
    EXPECT_THAT(runs(), ElementsAre(1, 2));
    EXPECT_TRUE(exists("sub/a.ply"));
}

TEST_F(Prune, WrongArguments_AreRefused) {
    run("a.xyz");
    EXPECT_THAT(scanmill({"runs", "out", "--prune"}).err, HasSubstr("--prune needs the number of runs to keep"));
    EXPECT_THAT(prune("0").err, HasSubstr("--prune needs the number of runs to keep, at least 1"));
    EXPECT_EQ(prune("-1").exit_code, 2);
    EXPECT_EQ(prune("many").exit_code, 2);
    EXPECT_THAT(scanmill({"runs", "out", "--keep", "3"}).err, HasSubstr("--keep is for --prune"));
    EXPECT_THAT(scanmill({"runs", "out", "show", "1", "--prune", "--keep", "3"}).err,
                HasSubstr("--prune removes runs, and `show` prints one"));
    EXPECT_THAT(scanmill({"runs", "nowhere", "--prune", "--keep", "3"}).err, HasSubstr("nowhere"));
    EXPECT_THAT(runs(), ElementsAre(1));
}

}  // namespace
}  // namespace scanmill::test
