// SPDX-License-Identifier: GPL-3.0-or-later
// Unattended batches: the records and messages explain afterwards what happened.

#include <chrono>
#include <csignal>
#include <regex>
#include <thread>

#include "runner/faults_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class Unwatched : public FaultyBatch {
protected:
    /// Scans a and b, of which b misbehaves by `mode`, under two variants.
    ProgramResult night(const std::string& mode, const std::vector<std::string>& more = {}) {
        write_batch("scans/a_01.xyz, {path: scans/b_01.xyz, set: {mode: " + mode + "}}");
        return run_batch(more);
    }
    void two_scans() {
        write_workflow("{sweep: [1, 2]}");
        write_scans("a", 1);
        write_scans("b", 1);
    }
    bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / "out" / name); }
    static std::vector<nlohmann::json> lines(const std::string& text) {
        std::vector<nlohmann::json> all;
        std::istringstream stream(text);
        for (std::string line; std::getline(stream, line);) all.push_back(nlohmann::json::parse(line));
        return all;
    }
    static std::size_t times(const std::string& text, const std::string& part) {
        std::size_t found = 0;
        for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
        return found;
    }
};

// Signals.

TEST_F(Unwatched, KilledStep_IsReportedAsKilled_WithMemoryAndHint) {
    const Json step = poisoned("kill");
    expect_failure();
    EXPECT_EQ(step["cause"], "signal");
    EXPECT_EQ(step["number"], SIGKILL);
    EXPECT_GT(step["peak-memory"], 96 << 20);
    EXPECT_THAT(step["error"].get<std::string>(),
                AllOf(ContainsRegex("SIGKILL .*largest memory was "), HasSubstr("may have run out of memory"),
                      HasSubstr("limits: {memory: ")));
}

TEST_F(Unwatched, StepThatClosesTheChannelAndGoesOn_IsEnded) {
    const Json step = poisoned("close-channel");
    expect_failure();
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("closed the channel"));
}

TEST_F(Unwatched, ClosedTerminal_IsAnInterrupt_AlsoIfItSignalsTwice) {
    const ProgramResult result = interrupted_batch({SIGHUP, SIGHUP});
    EXPECT_EQ(result.exit_code, 130);
    EXPECT_THAT(result.err, HasSubstr("interrupted"));
    EXPECT_EQ(outputs().size(), 2u);
    EXPECT_EQ(recorded(1)["run"]["outcome"], "interrupted");
}

TEST_F(Unwatched, Nohup_GoesOnWithoutItsTerminal) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("{path: scans/*.xyz, set: {mode: slow}}");
    std::signal(SIGHUP, SIG_IGN);  // as nohup does; programs inherit it
    RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
    std::signal(SIGHUP, SIG_DFL);
    while (!batch.has_ended() && batch.err().find("scan_01.xyz: shared") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    batch.signal(SIGHUP);
    EXPECT_EQ(batch.wait().exit_code, 0);
    EXPECT_EQ(outputs().size(), 3u);
}

// Files of an earlier run.

TEST_F(Unwatched, FailedCells_MoveTheFilesOfAnEarlierRunAside) {
    two_scans();
    ASSERT_EQ(night("pass").exit_code, 0);
    const std::string before = content_of(folder_ / "out/b_01.factor=1.ply");
    const ProgramResult result = night("fail");
    EXPECT_EQ(result.exit_code, 1);
    for (const char* variant : {"1", "2"}) {
        const std::string file = fmt::format("b_01.factor={}.ply", variant);
        EXPECT_FALSE(exists(file));
        EXPECT_FALSE(exists(file + ".json"));
        EXPECT_TRUE(exists(file + ".previous"));
        EXPECT_TRUE(exists(file + ".previous.json"));
        EXPECT_THAT(result.err, HasSubstr("the file of an earlier run was moved to '" +
                                          (folder_ / "out" / file).string() + ".previous'"));
        EXPECT_TRUE(exists(fmt::format("a_01.factor={}.ply", variant))) << "this one did not fail";
    }
    EXPECT_EQ(content_of(folder_ / "out/b_01.factor=1.ply.previous"), before);
    EXPECT_THAT(result.out, ContainsRegex("2 files of an earlier run.* moved to .*[.]previous"));

    const ProgramResult again = night("fail", {"--json"});
    EXPECT_THAT(again.err, Not(HasSubstr("earlier run"))) << "there is nothing left to move";
    EXPECT_EQ(content_of(folder_ / "out/b_01.factor=1.ply.previous"), before);
    ASSERT_EQ(night("pass").exit_code, 0);
    EXPECT_TRUE(exists("b_01.factor=1.ply"));
}

TEST_F(Unwatched, MovedFiles_AreInTheEvents) {
    two_scans();
    ASSERT_EQ(night("pass").exit_code, 0);
    std::size_t moved = 0;
    for (const Json& event : lines(night("fail", {"--json"}).out))
        if (event["event"] == "cell-ended")
            for (const Json& output : event["outputs"])
                if (output.contains("moved-to")) {
                    ++moved;
                    EXPECT_EQ(output["moved-to"], output["file"].get<std::string>() + ".previous");
                }
    EXPECT_EQ(moved, 2u);
}

TEST_F(Unwatched, UnmetExpectation_MovesTheFileAside) {
    write_scans("a", 1);
    write_batch("scans/*.xyz");
    for (const char* points : {"5", "6"}) {
        folder_.write("w.yaml", fmt::format("scanmill: 1\nname: w\ninputs: {{scan: points}}\nsteps:\n  - test-step:\n"
                                            "    expect: {{points: {}}}\noutputs: {{'{{scan}}.ply': test-step}}\n",
                                            points));
        EXPECT_EQ(run_batch().exit_code, points[0] == '5' ? 0 : 1);
        EXPECT_EQ(exists("a_01.ply"), points[0] == '5');
    }
    EXPECT_TRUE(exists("a_01.ply.previous"));
}

TEST_F(Unwatched, UnmetExpectation_IsShownByItsFilesUntilTheNextSuccess) {
    const auto expecting = [&](int points) {
        folder_.write("w.yaml", fmt::format("scanmill: 1\nname: w\ninputs: {{scan: points}}\nsteps:\n  - test-step:\n"
                                            "    expect: {{points: {}}}\noutputs: {{'{{scan}}.ply': test-step}}\n",
                                            points));
    };
    write_scans("a", 1);
    write_batch("scans/*.xyz");
    expecting(6);
    for (const char* jobs : {"0", "1"}) {
        const ProgramResult result = run_batch({"-j", jobs});
        EXPECT_EQ(result.exit_code, 1);
        EXPECT_FALSE(exists("a_01.ply"));
        EXPECT_TRUE(exists("failed/a_01.ply"));
        EXPECT_THAT(result.err, HasSubstr("out/failed/a_01.ply'"));
        EXPECT_THAT(result.out, ContainsRegex("1 failed .*out/failed'"));
    }
    const Json output = recorded(2)["cells"][0]["outputs"][0];
    EXPECT_EQ(output["outcome"], "failed");
    EXPECT_EQ(output["evidence"], (std::filesystem::canonical(folder_ / "out") / "failed/a_01.ply").string());
    EXPECT_TRUE(output.contains("sha256"));
    expecting(5);
    EXPECT_EQ(run_batch().exit_code, 0);
    EXPECT_TRUE(exists("a_01.ply"));
    EXPECT_FALSE(exists("failed"));
}

TEST_F(Unwatched, InterruptedCells_KeepTheFilesOfAnEarlierRun) {
    write_workflow("1");
    write_scans("scan", 1);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch().exit_code, 0);
    write_batch("{path: scans/*.xyz, set: {mode: wait}}");
    RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
    while (!batch.has_ended() && batch.err().find("scan_01.xyz: shared") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    batch.signal(SIGTERM);
    EXPECT_EQ(batch.wait().exit_code, 130);
    EXPECT_EQ(outputs().size(), 1u);
    EXPECT_FALSE(exists("scan_01.default.ply.previous"));
}

/// Failed cells stay what they are: neither a crash nor another exit code.
TEST_F(Unwatched, FileThatCannotBeMoved_IsAWarning) {
    two_scans();
    ASSERT_EQ(night("pass").exit_code, 0);
    std::filesystem::create_directories(folder_ / "out/b_01.factor=1.ply.previous/folder");
    const ProgramResult result = night("fail");
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, AllOf(HasSubstr("warning: a file of an earlier run is still there: '"),
                                  HasSubstr("b_01.factor=1.ply' cannot be moved to '")));
    EXPECT_THAT(result.out, ContainsRegex("1 file of an earlier run.* could not be moved"));
    EXPECT_TRUE(exists("b_01.factor=1.ply"));
    EXPECT_FALSE(exists("b_01.factor=2.ply"));
    EXPECT_EQ(count(recorded(2)["cells"], "outcome", "failed"), 2u);
}

TEST_F(Unwatched, FolderThatBecameReadOnly_IsAWarning) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nparameters: {mode: pass}\nsteps:\n  - test-step: "
                  "{mode: $mode}\noutputs: {'sub/{scan}.ply': test-step}\n");
    write_scans("scan", 1);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch().exit_code, 0);
    using std::filesystem::perms;
    std::filesystem::permissions(folder_.path(), perms::all);
    std::filesystem::permissions(folder_ / "out", perms::all);
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out"))
        if (entry.is_regular_file()) std::filesystem::permissions(entry.path(), perms::all);
    std::filesystem::permissions(folder_ / "out/sub",
                                 perms::owner_read | perms::owner_exec | perms::others_read | perms::others_exec);
    write_batch("{path: scans/*.xyz, set: {mode: fail}}");
    ProgramOptions unprivileged = options();
    unprivileged.without_rights = true;
    const ProgramResult result =
        scanmill_program({"batch", "b.yaml", "-o", "out", "--no-cache", "-j", "1"}, unprivileged);
    std::filesystem::permissions(folder_ / "out/sub", perms::owner_all);
    if (result.exit_code > 100) GTEST_SKIP() << "the program may not be run without root's rights here";
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("a file of an earlier run is still there: '"));
    EXPECT_TRUE(exists("sub/scan_01.ply"));
}

TEST_F(Unwatched, FailedFolderThatIsReadOnly_IsOneWarning) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\n    expect: {points: 99}\n"
                  "outputs: {'{scan}.ply': test-step}\n");
    write_scans("scan", 2);
    write_batch("scans/*.xyz");
    std::filesystem::create_directories(folder_ / "out/failed");
    using std::filesystem::perms;
    std::filesystem::permissions(folder_.path(), perms::all);
    std::filesystem::permissions(folder_ / "out", perms::all);
    std::filesystem::permissions(folder_ / "out/failed",
                                 perms::owner_read | perms::owner_exec | perms::others_read | perms::others_exec);
    ProgramOptions unprivileged = options();
    unprivileged.without_rights = true;
    const ProgramResult result =
        scanmill_program({"batch", "b.yaml", "-o", "out", "--no-cache", "-j", "1"}, unprivileged);
    std::filesystem::permissions(folder_ / "out/failed", perms::owner_all);
    if (result.exit_code > 100) GTEST_SKIP() << "the program may not be run without root's rights here";
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_EQ(times(result.err, "warning: "), 1u) << result.err;
    EXPECT_THAT(result.err, ContainsRegex("outputs of failed cells cannot be written to .*out/failed'.*Permission"));
    EXPECT_EQ(times(result.err, "error: "), 2u) << result.err;
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "out/failed"));
    EXPECT_EQ(count(recorded(1)["cells"], "outcome", "failed"), 2u);
}

TEST_F(Unwatched, InputThatAnOutputWouldBeMovedTo_IsRefusedBeforeTheRun) {
    write_workflow("1");
    folder_.write("out/a.default.ply.previous", "1 0 0\n");
    std::filesystem::create_directories(folder_ / "scans");
    std::filesystem::create_hard_link(folder_ / "out/a.default.ply.previous", folder_ / "scans/a.xyz");
    write_batch("scans/a.xyz");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("a.default.ply.previous' is an input"));
}

// Names.

TEST_F(Unwatched, ProgressAndWarnings_NameTheVariant_UnlessAllShareTheStep) {
    two_scans();
    const ProgramResult result = night("warn", {"-j", "1"});
    EXPECT_THAT(result.err, AllOf(HasSubstr("scans/a_01.xyz: shared "), HasSubstr("scans/a_01.xyz [factor=1]: last "),
                                  HasSubstr("scans/a_01.xyz [factor=2]: last "),
                                  HasSubstr("warning: scans/b_01.xyz [factor=1]: last: was asked to warn\n"),
                                  HasSubstr("warning: scans/b_01.xyz [factor=2]: last: was asked to warn\n")));
}

TEST_F(Unwatched, StepOfSomeVariants_IsNamedByTheirNumber_InEventsByTheirNames) {
    write_scans("a", 1);
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - id: first\n    test-step: {factor: "
                  "{sweep: [1, 2]}}\n  - id: last\n    test-step: {mode: {sweep: [warn, doubt, slow]}}\n    in: "
                  "{points: first.points}\noutputs: {'{scan}.{variant}.ply': last}\n");
    write_batch("scans/*.xyz");
    const ProgramResult result = run_batch({"-j", "1", "--json"});
    EXPECT_THAT(result.err, AllOf(HasSubstr("[3 of 6 variants]: first"), HasSubstr("doubt: scans/a_01.xyz [")));
    for (const Json& event : lines(result.out))
        if (event["event"] == "step-ended") {
            const std::string step = event["step"];
            EXPECT_EQ(event["variants"].size(), step == "read" ? 6u : step == "first" ? 3u : 1u) << event;
        }
}

TEST_F(Unwatched, StepOfOneWorkflowOfSeveral_IsNamedByIt) {
    write_scans("a", 1);
    for (const char* name : {"one", "two"})
        folder_.write(fmt::format("{}.yaml", name),
                      fmt::format("scanmill: 1\nname: {0}\ninputs: {{scan: points}}\nsteps:\n  - test-step: {{factor: "
                                  "{1}}}\noutputs: {{'{{scan}}.{0}.ply': test-step}}\n",
                                  name, name[0] == 'o' ? 1 : 2));
    folder_.write("b.yaml", "scanmill: 1\nbatch: b\nscans: [scans/*.xyz]\nworkflows: [one.yaml, two.yaml]\n");
    EXPECT_THAT(run_batch().err,
                AllOf(HasSubstr("scans/a_01.xyz [one]: test-step "), HasSubstr("scans/a_01.xyz [two]: test-step ")));
}

TEST_F(Unwatched, BrokenScan_IsReportedOnce_AndRecordedForEveryCell) {
    write_workflow();
    write_scans("a", 1);
    folder_.write("scans/broken.xyz", "1 2\n");
    write_batch("scans/*.xyz");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(times(result.err, "error: "), 1u) << result.err;
    EXPECT_EQ(times(result.out, "broken.xyz"), 1u) << result.out;
    EXPECT_THAT(result.out, HasSubstr("4 of 8 failed (1 file could not be read);"));
    const Json run = recorded(1);
    EXPECT_EQ(run["cells"].size(), 8u);
    EXPECT_EQ(count(run["cells"], "outcome", "failed"), 4u);
}

TEST_F(Unwatched, FailureOfASharedStep_IsReportedOnce_WithItsVariants) {
    write_workflow();
    write_scans("a", 1);
    write_batch("{path: scans/*.xyz, set: {first: fail}}");
    const ProgramResult result = run_batch();
    EXPECT_EQ(times(result.err, "error: "), 1u) << result.err;
    EXPECT_THAT(result.err, HasSubstr("\n  under all 4 variants\n"));
    EXPECT_THAT(result.out, HasSubstr("4 of 4 failed;"));
}

/// The worker that ran the shared step ends with the first variant; the second still gets the step's value.
TEST_F(Unwatched, ValuesOutliveTheirWorker) {
    write_workflow("{sweep: [1, 2]}");
    write_scans("a", 1);
    write_batch("{path: scans/*.xyz, set: {mode: crash}}", "limits: {retries: 1}\n");
    const ProgramResult result = run_batch({"-j", "1", "--keep", "never"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, Not(HasSubstr(" s, again\n")));
    EXPECT_EQ(of_step(recorded(1), "shared").size(), 1u);
    const std::regex counts("\\[(\\d+)/(\\d+)\\]");
    for (std::sregex_iterator found(result.err.begin(), result.err.end(), counts), end; found != end; ++found)
        EXPECT_LE(std::stoi((*found)[1]), std::stoi((*found)[2])) << found->str();
}

}  // namespace
}  // namespace scanmill::test
