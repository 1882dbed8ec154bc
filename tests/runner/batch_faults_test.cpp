// SPDX-License-Identifier: GPL-3.0-or-later
// Filters that take their process along, or more than their share.

#include "runner/faults_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class Faults : public FaultyBatch {};

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
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("something other than a std::exception was thrown"));
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
    EXPECT_EQ(count(run["cells"], "outcome", "ok"), 1u);
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
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("exited with code 0"));
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
    EXPECT_THAT(step["error"].get<std::string>(), HasSubstr("its last output: about to crash"));
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

TEST_F(Faults, ManyTinyScans_NeedNoMoreMemoryThanFew) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer keeps what was given back";
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
