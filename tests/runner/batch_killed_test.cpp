// SPDX-License-Identifier: GPL-3.0-or-later
// Runners and workers that are interrupted or killed.

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include "runner/faults_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

class Killed : public FaultyBatch {};

TEST_F(Killed, Interrupt_EndsWhatWillNotEnd_AndKeepsWhatWasDone) {
    const ProgramResult result = interrupted_batch({SIGINT});
    EXPECT_EQ(result.exit_code, 130);
    EXPECT_THAT(result.err, HasSubstr("interrupted"));
    EXPECT_EQ(outputs().size(), 2u) << "scans of equal settings come together: the first and the third";
    const Json run = recorded(1);
    EXPECT_EQ(run["run"]["outcome"], "interrupted");
    EXPECT_EQ(count(run["cells"], "outcome", "ok"), 2u);
}

/// The shell that started the batch is killed as soon as the first step has begun.
TEST_F(Killed, Parent_EndsTheBatchThatAskedForIt) {
    write_workflow("1");
    write_scans("scan", 1);
    write_batch("{path: scans/*.xyz, set: {mode: wait}}");
    const std::string command = fmt::format(
        "cd '{}'; export HOME=$PWD SCANMILL_PLUGIN_PATH='{}'; "
        "bash -c '\"{}\" batch b.yaml -o out -j 1 --stop-with-parent --json >events 2>/dev/null & "
        "until grep -q step-started events; do sleep 0.05; done; kill -9 $$' 2>/dev/null",
        folder_.path().string(), test_plugin_folder(), program_file());
    EXPECT_NE(std::system(command.c_str()), 0);
    const auto last_event = [&] {
        const std::string events = content_of(folder_ / "events");
        return events.find("\"event\":\"run-ended\"") != std::string::npos;
    };
    for (int tries = 0; tries < 300 && !last_event(); ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(last_event());
    EXPECT_EQ(recorded(1)["run"]["outcome"], "interrupted");
}

TEST_F(Killed, Runner_KilledAtAnyMoment_LeavesARunThatIsFinishedByTheNext) {
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

/// All that a run found: cell → outcome; and (step, scan) → metrics and properties; and output → its hash.
std::map<std::string, std::string> results_of(const nlohmann::json& run) {
    std::map<std::string, std::string> results;
    for (const auto& cell : run["cells"]) {
        const std::string name = cell["scan"].get<std::string>() + " " + cell["variant"].get<std::string>();
        results[name] = cell["outcome"].get<std::string>();
        for (const auto& output : cell["outputs"])
            results[std::filesystem::path(output["file"].get<std::string>()).filename()] =
                output.value("sha256", "") + output.value("bytes", nlohmann::json()).dump() +
                output["properties"].dump();
    }
    for (const auto& step : run["steps"])
        results[step["step"].get<std::string>() + step["key"].get<std::string>()] =
            step["outcome"].dump() + step.value("parameters", nlohmann::json()).dump() +
            step.value("metrics", nlohmann::json()).dump() + step.value("properties", nlohmann::json()).dump();
    return results;
}

/// Twenty batches are killed at moments spread over an undisturbed one's time: the whole process group at once, as when
/// a machine loses power, or the main process alone. Then each is run again.
TEST_F(Killed, RunAfterAKillAtAnyMoment_GivesTheResultsOfAnUndisturbedOne) {
    write_workflow("{sweep: [1, 2]}");
    write_scans("slow", 4);
    write_scans("failed", 1);
    write_scans("doubted", 1);
    write_batch(
        "{path: scans/slow_*.xyz, set: {mode: slow}}, {path: scans/failed_01.xyz, set: {mode: fail}}, "
        "{path: scans/doubted_01.xyz, set: {mode: doubt}}");
    const std::vector<std::string> arguments{"batch", "b.yaml", "-o", "out", "-j", "2"};
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(scanmill(arguments).exit_code, 1);
    const auto whole = std::chrono::steady_clock::now() - begin;
    const auto expected_files = outputs();
    ASSERT_EQ(expected_files.size(), 10u);
    const auto expected = results_of(recorded(1));

    std::mt19937 random(23);
    std::size_t killed_before_the_run = 0, interrupted = 0, ended = 0;
    for (int kill = 0; kill < 20; ++kill) {
        SCOPED_TRACE(kill);
        std::filesystem::remove_all(folder_ / "home");
        std::filesystem::remove_all(folder_ / "out");
        ProgramOptions own = options();
        own.own_group = true;
        RunningProgram batch(arguments, own);
        std::this_thread::sleep_for(whole * std::uniform_real_distribution<double>(0, 1)(random));
        kill % 2 == 0 ? batch.signal_group(SIGKILL) : batch.signal(SIGKILL);
        batch.wait();

        const Json before = Json::parse(scanmill({"runs", "out", "--json"}).out, nullptr, false);
        const bool had_begun = before.is_object() && before.contains("runs") && !before["runs"].empty();
        ASSERT_EQ(scanmill(arguments).exit_code, 1);
        EXPECT_EQ(outputs(), expected_files);
        EXPECT_EQ(results_of(recorded(had_begun ? 2 : 1)), expected);
        if (!had_begun) {
            ++killed_before_the_run;
            continue;
        }
        const Json runs = Json::parse(scanmill({"runs", "out", "--json"}).out)["runs"];
        ASSERT_EQ(runs.size(), 2u) << "the killed run stays";
        if (runs[0].contains("killed")) {
            ++interrupted;
            EXPECT_EQ(runs[0]["outcome"], "interrupted");
        } else {
            ++ended;  // it was killed after its end, or too late
        }
        EXPECT_EQ(runs[1]["outcome"], "failed");
    }
    RecordProperty("killed-before-the-run", static_cast<int>(killed_before_the_run));
    RecordProperty("interrupted", static_cast<int>(interrupted));
    RecordProperty("killed-after-the-end", static_cast<int>(ended));
    EXPECT_GT(interrupted, 2u) << "of the others " << killed_before_the_run << " were killed before their run began, "
                               << ended << " after its end";
}

TEST_F(Killed, RunAfterAKill_ComputesOnlyWhatWasNotFinished) {
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
    const Json first = Json::parse(scanmill({"runs", "out", "--json"}).out)["runs"][0];
    EXPECT_EQ(first["outcome"], "interrupted");
    EXPECT_EQ(first["killed"], true);
    EXPECT_THAT(scanmill({"runs", "out"}).out, HasSubstr("interrupted"));
}

/// The numbers of the processes that this one has started.
std::vector<int> children_of(int process) {
    std::ifstream list(fmt::format("/proc/{0}/task/{0}/children", process));
    std::vector<int> children;
    for (int child; list >> child;) children.push_back(child);
    return children;
}

TEST_F(Killed, SecondBatchIntoTheFolder_IsRefused_UntilTheFirstIsKilled) {
    write_workflow("1");
    write_scans("scan", 2);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: loop}}");
    RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1", "--no-cache"}, options());
    while (!batch.has_ended() && batch.err().find("scan_02.xyz: shared") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    write_batch("scans/scan_01.xyz");
    for (const char* command : {"batch", "run"}) {
        const ProgramResult second =
            command[0] == 'b' ? run_batch() : scanmill({"run", "w.yaml", "scans/scan_01.xyz", "-o", "out"});
        EXPECT_EQ(second.exit_code, 2);
        EXPECT_THAT(second.err, testing::AllOf(HasSubstr("the output folder 'out' is in use: process "),
                                               HasSubstr(fmt::format("process {} (", batch.process())),
                                               HasSubstr("batch b.yaml -o out -j 1"), HasSubstr("hint: ")));
    }
    EXPECT_EQ(run_batch({"--dry-run"}).exit_code, 0) << "what only reads is not refused";
    Json runs = Json::parse(scanmill({"runs", "out", "--json"}).out)["runs"];
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_EQ(runs[0]["outcome"], "running");
    EXPECT_THAT(scanmill({"runs", "out", "show", "1"}).out, HasSubstr("running"));
    batch.signal(SIGKILL);
    batch.wait();
    EXPECT_EQ(run_batch().exit_code, 0) << "the lock of a killed process does not stay";
    runs = Json::parse(scanmill({"runs", "out", "--json"}).out)["runs"];
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_EQ(runs[0]["outcome"], "interrupted");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/scanmill.lock"));
}

TEST_F(Killed, WorkerKilledFromOutside_FailsWhatItWasDoing) {
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
    EXPECT_EQ(count(run["cells"], "outcome", "ok"), 2u);
    EXPECT_EQ(count(run["cells"], "number", SIGKILL), 1u);
}

TEST_F(Killed, WorkerAskedToEndByOthers_IsNoInterrupt) {
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
    EXPECT_EQ(count(run["cells"], "outcome", "ok"), 2u);
    EXPECT_EQ(count(run["cells"], "number", SIGTERM), 1u);
}

TEST_F(Killed, Workers_EndWithTheirRunner) {
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

TEST_F(Killed, NoScratchFolder_IsLeftBehind) {
    write_workflow("1");
    write_scans("scan", 2);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: crash}}");
    std::filesystem::create_directory(folder_ / "tmp");
    ProgramOptions own = options();
    own.environment.push_back("TMPDIR=" + (folder_ / "tmp").string());
    EXPECT_EQ(scanmill_program({"batch", "b.yaml", "-o", "out", "-j", "2"}, own).exit_code, 1);
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp"));
}

}  // namespace
}  // namespace scanmill::test
