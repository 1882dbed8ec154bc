// SPDX-License-Identifier: GPL-3.0-or-later
// The messages of a batch during its run, for people and for programs, also with several workers.

#include <cstdlib>

#include "runner/batch_fixture.hpp"
#include "support/folders.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(Batch, NobodyListening_IsNoReasonToStop) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("scans/*.xyz");
    for (const char* where : {">/dev/full", ">&-", "2>/dev/full", "2>&-", "--json >/dev/full", "--json | head -1"}) {
        std::filesystem::remove_all(folder_ / "out");
        const std::string command = "cd '" + folder_.path().string() + "' && (SCANMILL_PLUGIN_PATH='" +
                                    test::test_plugin_folder() + "' XDG_CACHE_HOME=home '" + test::program_file() +
                                    "' batch b.yaml -o out --no-cache " + where + ") > /dev/null 2>&1";
        const int status = std::system(command.c_str());
        EXPECT_TRUE(WIFEXITED(status)) << where;
        EXPECT_EQ(outputs().size(), 3u) << where;
        const bool loses_results = std::string(where).starts_with(">") || std::string(where).ends_with("full");
        if (loses_results && !std::string(where).starts_with("2")) {
            EXPECT_EQ(WEXITSTATUS(status), 3) << where;
        }
    }
}

TEST_F(Batch, Json_IsALineForEverythingThatHappens) {
    write_workflow("{sweep: [1, 2]}");
    write_scans("scan", 2);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: fail}}");
    const ProgramResult result = run_batch({"--json", "-j", "2"});
    EXPECT_EQ(result.exit_code, 1);
    std::map<std::string, std::size_t> events;
    std::vector<Json> lines;
    std::istringstream stream(result.out);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(Json::parse(line));
        ++events[lines.back()["event"]];
    }
    ASSERT_GE(lines.size(), 2u);
    EXPECT_EQ(lines.front()["event"], "run-started");
    EXPECT_EQ(lines.front()["scanmill"], 1);
    EXPECT_EQ(lines.front()["run"], 1);
    EXPECT_EQ(lines.back()["event"], "run-ended");
    EXPECT_EQ(lines.back()["ok"], 2);
    EXPECT_EQ(lines.back()["failed"], 2);
    EXPECT_EQ(events["step-started"], 8u);
    EXPECT_EQ(events["step-ended"], 8u);
    EXPECT_EQ(events["cell-ended"], 4u);
    EXPECT_EQ(events["output-written"], 2u);
    for (const Json& line : lines)
        if (line["event"] == "step-ended" && line["outcome"] == "failed") {
            EXPECT_EQ(line["cause"], "refused");
            EXPECT_THAT(line["error"].get<std::string>(), HasSubstr("was asked to fail"));
        }
}

TEST_F(Batch, PlainLines_TellEveryStepAndFailure) {
    write_workflow("{sweep: [1, 2]}");
    write_scans("scan", 2);
    write_batch("scans/scan_01.xyz, {path: scans/scan_02.xyz, set: {mode: fail}}");
    const ProgramResult result = run_batch();
    EXPECT_THAT(result.err, AllOf(HasSubstr("scan_01.xyz [factor=1]: last"), HasSubstr("was asked to fail"),
                                  HasSubstr("in step 'last' ("), HasSubstr("on scan '"),
                                  HasSubstr("under variant 'factor=2'"), Not(HasSubstr("\x1b"))));
    EXPECT_THAT(result.out, HasSubstr("2 of 4 failed"));
}

TEST_F(Batch, FailFast_BeginsNothingNew) {
    write_workflow("1");
    write_scans("scan", 30);
    write_batch("{path: scans/*.xyz, set: {mode: fail}}");
    const ProgramResult result = run_batch({"-j", "1", "--fail-fast"});
    EXPECT_EQ(result.exit_code, 1);
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "outcome", "failed"), 1u);
    EXPECT_EQ(count(run["cells"], "outcome", "skipped"), 29u);
}

TEST_F(Batch, NumberOfWorkers_ChangesNoByte) {
    write_workflow();
    write_scans("scan", 6);
    write_batch("scans/*.xyz");
    std::map<std::string, std::string> expected;
    for (const char* jobs : {"0", "1", "2", "5"}) {
        std::filesystem::remove_all(folder_ / "out");
        ASSERT_EQ(run_batch({"-j", jobs, "--no-cache"}).exit_code, 0) << jobs;
        ASSERT_EQ(outputs().size(), 24u);
        if (expected.empty()) expected = outputs();
        EXPECT_EQ(outputs(), expected) << jobs;
    }
}

/// What one variant made and another needs passes through the cache, whoever made it, or is made by who has it.
TEST_F(Batch, MoreWorkersThanScans_ComputeSharedStepsOnce) {
    write_workflow();
    write_scans("scan", 1);
    write_batch("{path: scans/*.xyz, set: {mode: slow}}");
    for (const char* keep : {"worth", "never"}) {
        std::filesystem::remove_all(folder_ / "out");
        std::filesystem::remove_all(folder_ / "home");
        ASSERT_EQ(run_batch({"-j", "4", "--keep", keep}).exit_code, 0);
        const Json run = recorded(1);
        EXPECT_EQ(run["steps"].size(), 6u) << keep;
        EXPECT_EQ(count(run["steps"], "origin", "ran"), 6u);
    }
}

/// Two ways to the same values: what comes after them is the same step on the same inputs.
TEST_F(Batch, StepsOnEqualValues_RunOnce_AlsoWhenTheyComeUpTogether) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - id: a\n    test-step: {mode: "
                  "{sweep: [slow, warn]}}\n  - id: b\n    test-step: {mode: slow, factor: 2}\n    in: {points: "
                  "a.points}\noutputs: {'{scan}.{variant}.ply': b}\n");
    write_scans("scan", 3);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch({"-j", "4", "--keep", "always"}).exit_code, 0);
    const std::vector<Json> second = of_step(recorded(1), "b");
    EXPECT_EQ(second.size(), 6u);
    EXPECT_EQ(count(second, "origin", "ran"), 3u);
    EXPECT_EQ(count(second, "origin", "same inputs"), 3u);
    EXPECT_EQ(outputs().size(), 6u);
}

TEST_F(Batch, NoBatch_IsRefusedWithTheWayOut) {
    write_workflow();
    write_scans("scan", 1);
    write_batch("scans/*.xyz");
    const ProgramResult workflow = scanmill({"batch", "w.yaml"});
    EXPECT_EQ(workflow.exit_code, 2);
    EXPECT_THAT(workflow.err, AllOf(HasSubstr("no key `batch`"), HasSubstr("scanmill run")));
    const ProgramResult batch = scanmill({"run", "b.yaml", "scans/scan_01.xyz"});
    EXPECT_EQ(batch.exit_code, 2);
    EXPECT_THAT(batch.err, HasSubstr("scanmill batch b.yaml"));
    EXPECT_EQ(scanmill({"batch", "missing.yaml"}).exit_code, 2);
    write_batch("scans/*.ply");
    const ProgramResult nothing = run_batch();
    EXPECT_EQ(nothing.exit_code, 2);
    EXPECT_THAT(nothing.err, HasSubstr("b.yaml:3:"));
    EXPECT_THAT(scanmill({"worker"}).err, HasSubstr("only scanmill itself starts workers"));
    EXPECT_THAT(scanmill({"--help"}).out, Not(HasSubstr("worker ")));
}

}  // namespace
}  // namespace scanmill::test
