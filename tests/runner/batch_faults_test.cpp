// SPDX-License-Identifier: GPL-3.0-or-later
// What goes wrong in the night: filters that take their process along, runners that are killed, disks that fill up.

#include <chrono>
#include <fstream>
#include <random>
#include <thread>

#include "runner/batch_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Faults : public Batch {
protected:
    /// Three scans, the second of which misbehaves; returns the record of its step.
    Json poisoned(const std::string& mode, const std::string& limits = "", std::vector<std::string> more = {}) {
        write_workflow("{sweep: [1, 2]}");
        write_scans("a", 1);
        write_scans("b", 1);
        write_scans("c", 1);
        write_batch("scans/a_*.xyz, {path: scans/b_01.xyz, set: {mode: " + mode + "}}, scans/c_*.xyz", limits);
        more.insert(more.end(), {"-j", "1"});
        result_ = run_batch(more);
        run_ = recorded(1);
        EXPECT_EQ(run_["cells"].size(), 6u) << result_.err;
        for (const Json& cell : run_["cells"])
            if (cell["scan"] != "scans/b_01.xyz") {
                EXPECT_EQ(cell["outcome"], "done") << cell;
            }
        for (const Json& step : run_["steps"])
            if (step["scan"] == "scans/b_01.xyz" && step["step"] == "last") return step;
        return {};
    }
    void expect_failure() const {
        EXPECT_EQ(result_.exit_code, 1);
        EXPECT_EQ(count(run_["cells"], "outcome", "failed"), 2u);
        EXPECT_THAT(result_.err, AllOf(HasSubstr("in step 'last' ("), HasSubstr("on scan 'scans/b_01.xyz'")));
    }

    ProgramResult result_;
    Json run_;
};

TEST_F(Faults, Crash_FailsItsCellsWithSignalMemoryAndLog) {
    const Json step = poisoned("crash");
    expect_failure();
    EXPECT_EQ(step["cause"], "signal");
    EXPECT_EQ(step["number"], SIGSEGV);
    EXPECT_GT(step["peak-memory"], 1'000'000);
    EXPECT_EQ(step["log"], Json({"about to crash"}));
    EXPECT_EQ(step["authored"]["mode"], "crash");
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("SIGSEGV"));
}

TEST_F(Faults, Abort_IsASignal) {
    const Json step = poisoned("abort");
    expect_failure();
    EXPECT_EQ(step["number"], SIGABRT);
}

TEST_F(Faults, ForeignException_IsNoCrash) {
    const Json step = poisoned("throw-number");
    expect_failure();
    EXPECT_EQ(step["cause"], "exception");
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("says nothing of itself"));
}

TEST_F(Faults, EndlessLoop_IsEndedAtTheLimitOfTheStep) {
    const Json step = poisoned("loop", "limits: {step: {time: 500 ms}}\n");
    expect_failure();
    EXPECT_EQ(step["cause"], "time");
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("500 ms"));
}

TEST_F(Faults, EndlessLoop_IsEndedAtTheLimitOfTheCell) {
    const Json step = poisoned("loop", "limits: {time: 500 ms}\n");
    expect_failure();
    EXPECT_EQ(step["cause"], "time");
}

TEST_F(Faults, EndlessAllocation_EndsAtTheLimit) {
    const Json step = poisoned("allocate", "limits: {memory: 512 MiB}\n");
    expect_failure();
    EXPECT_EQ(step["cause"], "memory");
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("512 MiB"));
    EXPECT_GT(step["peak-memory"], 100'000'000);
    EXPECT_LT(step["peak-memory"], 1'500'000'000);
}

TEST_F(Faults, MemoryOfAStepThatFailed_IsThereForTheNextScan) {
    write_workflow("1");
    write_scans("scan", 1);
    std::string many;
    for (int i = 0; i < 400'000; ++i) many += fmt::format("{} {} {}\n", i, i % 7, i % 11);
    folder_.write("scans/scan_02.xyz", many);
    write_batch("{path: scans/scan_01.xyz, set: {first: allocate}}, scans/scan_02.xyz", "limits: {memory: 512 MiB}\n");
    EXPECT_EQ(run_batch({"-j", "1", "--no-cache"}).exit_code, 1);
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "cause", "memory"), 1u);
    EXPECT_EQ(count(run["cells"], "outcome", "done"), 1u);
}

TEST_F(Faults, WarningsWithoutEnd_AreCutShort) {
    const Json step = poisoned("babble");
    EXPECT_EQ(result_.exit_code, 0);
    ASSERT_EQ(step["warnings"].size(), 1001u);
    EXPECT_EQ(step["warnings"][1000], "there were more than 1000 warnings");
}

TEST_F(Faults, ClosedStreams_DoNoHarm) {
    poisoned("close-streams");
    EXPECT_EQ(result_.exit_code, 0);
}

TEST_F(Faults, Exit_IsNoSuccess) {
    const Json step = poisoned("exit");
    expect_failure();
    EXPECT_EQ(step["cause"], "exit");
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("exit code 0"));
}

TEST_F(Faults, WritingToStandardOutput_DoesNoHarmAndIsKept) {
    const Json step = poisoned("write", "", {"--json"});
    EXPECT_EQ(result_.exit_code, 0);
    EXPECT_THAT(result_.out, Not(HasSubstr("\nline ")));
    ASSERT_EQ(step["log"].size(), 50u) << "the last";
    EXPECT_EQ(step["log"][48], "line 100");
    EXPECT_EQ(step["log"][49], "and on standard error");
    for (const Json& other : run_["steps"])
        if (other["scan"] != "scans/b_01.xyz") {
            EXPECT_FALSE(other.contains("log")) << other;
        }
}

/// With one worker the third scan, whose path is relative, comes after the second.
TEST_F(Faults, WhatAFilterLeavesBehind_DoesNotReachTheNextScan) {
    poisoned("change-folder", "", {"--no-cache"});
    EXPECT_EQ(result_.exit_code, 0) << result_.err;
    std::filesystem::remove_all(folder_ / "out");
    scans_ = 0;
    const Json leaking = poisoned("leak", "", {"--no-cache"});
    EXPECT_EQ(result_.exit_code, 0) << result_.err;
    ASSERT_TRUE(leaking.contains("log"));
    EXPECT_EQ(leaking["log"][0], "scanmill: the worker is replaced: 3 more files are open");
}

TEST_F(Faults, Retries_AreCounted) {
    const Json step = poisoned("crash", "limits: {retries: 2}\n");
    expect_failure();
    EXPECT_EQ(step["attempts"], 3);
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("it wrote last: about to crash"));
    EXPECT_THAT(result_.err, HasSubstr("attempt 2 of 3 failed"));
    const Json refused =
        (std::filesystem::remove_all(folder_ / "out"), scans_ = 0, poisoned("fail", "limits: {retries: 2}\n"));
    EXPECT_EQ(refused["attempts"], 1) << "what a filter refuses it would refuse again";
}

TEST_F(Faults, CrashInASharedStep_FailsAllThatNeedIt) {
    write_workflow();
    write_scans("scan", 2);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {first: crash}}");
    EXPECT_EQ(run_batch().exit_code, 1);
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "outcome", "failed"), 4u);
    EXPECT_EQ(count(of_step(run, "shared"), "outcome", "failed"), 1u) << "it is tried once";
    EXPECT_EQ(of_step(run, "last").size(), 4u) << "of the other scan";
}

TEST_F(Faults, Interrupt_EndsWhatWillNotEnd_AndKeepsWhatWasDone) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: loop}}, scans/scan_03.xyz");
    RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
    while (!batch.has_ended() && batch.err().find("scan_02.xyz: shared") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    batch.signal(SIGINT);
    const ProgramResult result = batch.wait();
    EXPECT_EQ(result.exit_code, 130);
    EXPECT_THAT(result.err, HasSubstr("interrupted"));
    EXPECT_EQ(outputs().size(), 2u) << "scans of equal settings come together: the first and the third";
    const Json run = recorded(1);
    EXPECT_EQ(run["run"]["outcome"], "interrupted");
    EXPECT_EQ(count(run["cells"], "outcome", "done"), 2u);
}

TEST_F(Faults, Runner_KilledAtAnyMoment_LeavesARunThatIsFinishedByTheNext) {
    write_workflow("{sweep: [1, 2]}");
    write_scans("scan", 8);
    write_batch("{path: scans/*.xyz, set: {mode: slow}}");
    ASSERT_EQ(run_batch({"-j", "2", "--no-cache"}).exit_code, 0);
    const auto expected = outputs();
    ASSERT_EQ(expected.size(), 16u);
    std::filesystem::remove_all(folder_ / "out");

    std::mt19937 random(4);
    std::uniform_int_distribution<int> moment(0, 250);
    for (int kill = 0; kill < 30; ++kill) {
        if (kill % 10 == 0) std::filesystem::remove_all(folder_ / "home");
        if (kill % 10 == 0) std::filesystem::remove_all(folder_ / "out");
        RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "2"}, options());
        std::this_thread::sleep_for(std::chrono::milliseconds(moment(random)));
        batch.signal(SIGKILL);
        batch.wait();
        if (std::filesystem::exists(folder_ / "out"))
            for (const auto& [name, bytes] : outputs()) {
                ASSERT_TRUE(expected.contains(name)) << name << " is no output";
                EXPECT_EQ(bytes, expected.at(name)) << "outputs are whole: " << name;
            }
    }
    ASSERT_EQ(run_batch({"-j", "2"}).exit_code, 0);
    EXPECT_EQ(outputs(), expected);
}

TEST_F(Faults, RunAfterAKill_ComputesOnlyWhatWasNotFinished) {
    write_workflow("1");
    write_scans("scan", 6);
    write_batch("{path: scans/*.xyz, set: {mode: slow}}");
    {
        RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1", "--keep", "always"}, options());
        while (!batch.has_ended() && batch.err().find("scan_03.xyz: last") == std::string::npos)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        batch.signal(SIGKILL);
    }
    ASSERT_EQ(run_batch({"-j", "1", "--keep", "always"}).exit_code, 0);
    const Json run = recorded(2);
    for (const Json& step : run["steps"])
        for (const char* finished : {"scan_01", "scan_02", "scan_03"})
            if (step["scan"].get<std::string>().find(finished) != std::string::npos) {
                EXPECT_EQ(step["origin"], "cached") << step;
            }
    EXPECT_GT(count(run["steps"], "origin", "ran"), 0u);
    EXPECT_FALSE(recorded(1)["run"].contains("ended"));
    EXPECT_EQ(Json::parse(scanmill({"runs", "out", "--json"}).out)["runs"][0]["outcome"], "unfinished");
}

TEST_F(Faults, TwoBatchesOnOneCache_DoNotDisturbEachOther) {
    write_workflow();
    write_scans("scan", 6);
    write_batch("scans/*.xyz");
    RunningProgram one({"batch", "b.yaml", "-o", "one", "-j", "2", "--keep", "always"}, options());
    RunningProgram two({"batch", "b.yaml", "-o", "two", "-j", "2", "--keep", "always"}, options());
    EXPECT_EQ(one.wait().exit_code, 0);
    EXPECT_EQ(two.wait().exit_code, 0);
    EXPECT_EQ(outputs("one").size(), 24u);
    EXPECT_EQ(outputs("one"), outputs("two"));
}

TEST_F(Faults, ScanChangedAfterPlanning_FailsAndIsNotTakenForTheOld) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("{path: scans/scan_01.xyz, set: {mode: loop}}, scans/scan_02.xyz, scans/scan_03.xyz",
                "limits: {step: {time: 1 s}}\n");
    RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
    while (!batch.has_ended() && batch.err().find("scan_01.xyz: shared") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    folder_.write("scans/scan_02.xyz", "7 7 7\n8 8 8\n9 9 7\n");
    std::filesystem::remove(folder_ / "scans/scan_03.xyz");
    const ProgramResult result = batch.wait();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("scan_02.xyz' changed while the run was going on"), HasSubstr("scan_03.xyz")));
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "outcome", "failed"), 3u);
    EXPECT_THAT(outputs(), IsEmpty());
}

TEST_F(Faults, ReadOnlyCache_IsToldOnceAndGivesWhatItHas) {
    write_workflow();
    write_scans("scan", 2);
    write_batch("scans/*.xyz");
    std::filesystem::create_directory(folder_ / "locked");
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::all);
    std::filesystem::permissions(folder_ / "locked",
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec |
                                     std::filesystem::perms::others_read | std::filesystem::perms::others_exec);
    ProgramOptions unprivileged = options();
    unprivileged.without_rights = true;
    const ProgramResult result =
        scanmill_program({"batch", "b.yaml", "-o", "out", "-j", "2", "--cache", "locked"}, unprivileged);
    if (result.exit_code > 100) GTEST_SKIP() << "skipped: the program may not be run without root's rights here";
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(outputs().size(), 8u);
    EXPECT_THAT(result.err, HasSubstr("does not keep what is new"));
    EXPECT_EQ(result.err.find("does not keep"), result.err.rfind("does not keep")) << "several workers, one sentence";
}

TEST_F(Faults, FilesThatMayNotGrow_FailWhatCannotBeWritten) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs: "
                  "{'{scan}.ply': test-step.points}\n");
    write_scans("scan", 1);
    std::string many;
    for (int i = 0; i < 20000; ++i) many += fmt::format("{} {} {}\n", i, i % 7, i % 11);
    folder_.write("scans/scan_02.xyz", many);
    write_batch("scans/*.xyz");
    ProgramOptions limited = options();
    limited.file_limit = 200'000;
    const ProgramResult result = scanmill_program({"batch", "b.yaml", "-o", "out", "--keep", "always"}, limited);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, AllOf(HasSubstr("scan_02.ply"), HasSubstr("does not keep what is new")));
    EXPECT_EQ(outputs().size(), 1u) << "the small one, and nothing half-written";
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "cause", "output"), 1u);
    ASSERT_EQ(run_batch().exit_code, 0) << "once there is room";
    EXPECT_EQ(outputs().size(), 2u);
}

TEST_F(Faults, RecordsThatCannotGrow_AreToldAndTheRunGoesOn) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("scans/*.xyz");
    ProgramOptions limited = options();
    limited.file_limit = 20'000;
    const ProgramResult result = scanmill_program({"batch", "b.yaml", "-o", "out"}, limited);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.err, HasSubstr("recorded"));
    EXPECT_EQ(outputs().size(), 3u + std::filesystem::exists(folder_ / "out/scanmill.sqlite-journal"));
}

/// The numbers of the processes that this one has started.
std::vector<int> children_of(int process) {
    std::ifstream list(fmt::format("/proc/{0}/task/{0}/children", process));
    std::vector<int> children;
    for (int child; list >> child;) children.push_back(child);
    return children;
}

TEST_F(Faults, WorkerKilledFromOutside_FailsWhatItWasDoing) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: loop}}, scans/scan_03.xyz");
    RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
    while (!batch.has_ended() && batch.err().find("scan_02.xyz: shared") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    for (const int worker : children_of(batch.process())) ::kill(worker, SIGKILL);
    EXPECT_EQ(batch.wait().exit_code, 1);
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "outcome", "done"), 2u);
    EXPECT_EQ(count(run["cells"], "number", SIGKILL), 1u);
}

TEST_F(Faults, WorkerAskedToEndByOthers_IsNoInterrupt) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: wait}}, scans/scan_03.xyz");
    RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
    while (!batch.has_ended() && batch.err().find("scan_02.xyz: shared") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    for (const int worker : children_of(batch.process())) ::kill(worker, SIGTERM);
    EXPECT_EQ(batch.wait().exit_code, 1);
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "outcome", "done"), 2u);
    EXPECT_EQ(count(run["cells"], "number", SIGTERM), 1u);
}

TEST_F(Faults, Workers_EndWithTheirRunner) {
    write_workflow("1");
    write_scans("scan", 1);
    write_batch("{path: scans/scan_01.xyz, set: {mode: loop}}");
    std::vector<int> workers;
    {
        RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
        while (!batch.has_ended() && batch.err().find("scan_01.xyz: shared") == std::string::npos)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        workers = children_of(batch.process());
        batch.signal(SIGKILL);
    }
    ASSERT_EQ(workers.size(), 1u);
    for (int tries = 0; tries < 1000 && ::kill(workers[0], 0) == 0; ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_NE(::kill(workers[0], 0), 0) << "it would loop for ever";
}

TEST_F(Faults, NoScratchFolder_IsLeftBehind) {
    write_workflow("1");
    write_scans("scan", 2);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: crash}}");
    std::filesystem::create_directory(folder_ / "tmp");
    ProgramOptions own = options();
    own.environment.push_back("TMPDIR=" + (folder_ / "tmp").string());
    EXPECT_EQ(scanmill_program({"batch", "b.yaml", "-o", "out", "-j", "2"}, own).exit_code, 1);
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp"));
}

/// No machine has room for two such cells: one after the other still runs.
TEST_F(Faults, CellsThatDoNotFitBesideEachOther_RunOneAfterTheOther) {
    write_workflow("1");
    write_scans("scan", 4);
    for (const char* memory : {"1000 TiB", "600 MiB"}) {
        write_batch("{path: scans/*.xyz, set: {mode: slow}}", fmt::format("limits: {{memory: {}}}\n", memory));
        const ProgramResult result = run_batch({"-j", "3", "--json", "--no-cache"});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        int running = 0, most = 0;
        std::istringstream stream(result.out);
        for (std::string line; std::getline(stream, line);) {
            const Json event = Json::parse(line);
            running += event["event"] == "step-started";
            running -= event["event"] == "step-ended";
            most = std::max(most, running);
        }
        if (memory[0] == '1')
            EXPECT_EQ(most, 1);
        else
            EXPECT_GE(most, 2);
    }
}

TEST_F(Faults, ClockThatMoved_IsNoReasonToTrustOrRunAnything) {
    write_workflow("1");
    write_scans("scan", 2);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch({"--keep", "always"}).exit_code, 0);
    using namespace std::chrono_literals;
    const auto now = std::filesystem::file_time_type::clock::now();
    std::filesystem::last_write_time(folder_ / "scans/scan_01.xyz", now + 24h);
    std::filesystem::last_write_time(folder_ / "scans/scan_02.xyz", now - 24h * 365);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "home"))
        if (entry.is_regular_file()) std::filesystem::last_write_time(entry.path(), now + 48h);
    EXPECT_THAT(run_batch({"--dry-run"}).out, HasSubstr("0 to compute"));
    folder_.write("scans/scan_01.xyz", "7 7 7\n8 8 8\n9 9 7\n");
    std::filesystem::last_write_time(folder_ / "scans/scan_01.xyz", now + 24h);
    EXPECT_THAT(run_batch({"--dry-run"}).out, HasSubstr("3 to compute, 3 cached"));
}

TEST_F(Faults, ManyTinyScans_NeedNoMoreMemoryThanFew) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "skipped: a sanitizer keeps what was given back";
#endif
    write_workflow("1");
    write_scans("scan", 200);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch({"-j", "1", "--no-cache", "-q"}).exit_code, 0);
    const std::vector<Json> steps = of_step(recorded(1), "last");
    ASSERT_EQ(steps.size(), 200u);
    const auto peak = [&](std::size_t from, std::size_t to) {
        double most = 0;
        for (std::size_t i = from; i < to; ++i) most = std::max(most, steps[i]["peak-memory"].get<double>());
        return most;
    };
    EXPECT_LT(peak(150, 200), 1.05 * peak(10, 60));
}

}  // namespace
}  // namespace scanmill::test
