// SPDX-License-Identifier: GPL-3.0-or-later
// Batches as a user meets them: what is computed and what is not, what is said of it, and what stays of it.

#include <cstdlib>

#include "runner/batch_fixture.hpp"
#include "scanmill/work/sha256.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(Batch, TwentyScansUnderFourVariants_ThreePoisoned_LoseOnlyThose) {
    write_workflow();
    write_scans("good", 17);
    write_scans("bad", 3);
    write_batch(
        "scans/good_*.xyz, {path: scans/bad_01.xyz, set: {mode: crash}}, {path: scans/bad_02.xyz, set: {mode: abort}}, "
        "{path: scans/bad_03.xyz, set: {mode: throw-number}}");
    const ProgramResult first = run_batch({"-j", "2"});
    EXPECT_EQ(first.exit_code, 1);
    const Json run = recorded(1);
    ASSERT_EQ(run["cells"].size(), 80u);
    EXPECT_EQ(count(run["cells"], "outcome", "done"), 68u);
    EXPECT_EQ(count(run["cells"], "outcome", "failed"), 12u);
    EXPECT_EQ(count(run["cells"], "cause", "signal"), 8u);
    EXPECT_EQ(count(run["cells"], "number", SIGSEGV), 4u);
    EXPECT_EQ(count(run["cells"], "number", SIGABRT), 4u);
    EXPECT_EQ(count(run["cells"], "cause", "exception"), 4u);
    EXPECT_EQ(outputs().size(), 68u);
    const std::vector<Json> shared = of_step(run, "shared");
    EXPECT_EQ(shared.size(), 20u) << "each is computed once, for four variants";
    EXPECT_EQ(count(shared, "outcome", "done"), 20u);
    EXPECT_EQ(count(shared, "origin", "ran"), 20u);

    EXPECT_EQ(run_batch({"-j", "2"}).exit_code, 1);
    const Json again = recorded(2);
    EXPECT_EQ(count(again["cells"], "outcome", "done"), 68u);
    for (const Json& step : again["steps"])
        EXPECT_EQ(step["origin"], step["outcome"] == "failed" ? "ran" : "cached") << step;
    EXPECT_EQ(count(again["steps"], "outcome", "failed"), 12u);
}

TEST_F(Batch, CommentKeyOrderAndFileName_RunNothingAgain) {
    write_workflow();
    write_scans("scan", 3);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch({"--keep", "always"}).exit_code, 0);
    const auto before = outputs();

    folder_.write("w.yaml",
                  "# the same\nscanmill: 1\nparameters: {first: pass, mode: pass}\noutputs: {'{scan}.{variant}.ply': "
                  "last}\ninputs: {scan: points}\nname: w\nsteps:\n  - test-step: {factor: 0.5, mode: $first}\n    id: "
                  "shared\n  - in: {points: shared.points}\n    id: last\n    test-step:\n      factor: {sweep: [1, 2, "
                  "3, 4]}  # as before\n      mode: $mode\n");
    std::filesystem::rename(folder_ / "scans", folder_ / "moved");
    std::filesystem::rename(folder_ / "moved/scan_03.xyz", folder_ / "moved/other.xyz");
    write_batch("moved/*.xyz");
    EXPECT_THAT(run_batch({"--dry-run"}).out,
                AllOf(HasSubstr("0 to compute, 18 cached, 12 cells"), Not(HasSubstr("will run"))));
    ASSERT_EQ(run_batch().exit_code, 0);
    const Json run = recorded(2);
    EXPECT_EQ(count(run["steps"], "origin", "cached"), run["steps"].size());
    for (const auto& [name, bytes] : before)
        if (name.starts_with("scan_01") || name.starts_with("scan_02")) {
            EXPECT_EQ(outputs()[name], bytes) << name;
        }
}

TEST_F(Batch, ChangedParameter_RunsTheStepsBelowIt_AndSaysWhyBeforehand) {
    write_workflow("3");
    write_scans("scan", 2);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch({"--keep", "always"}).exit_code, 0);
    write_workflow("5");
    const std::string foreseen = run_batch({"--dry-run"}).out;
    EXPECT_THAT(foreseen, AllOf(HasSubstr("will run because factor changed 3 → 5 since run 1"),
                                HasSubstr("2 to compute, 4 cached")));
    ASSERT_EQ(run_batch({"--keep", "always"}).exit_code, 0);
    const Json run = recorded(2);
    for (const Json& step : run["steps"]) {
        EXPECT_EQ(step["origin"], step["step"] == "last" ? "ran" : "cached");
        if (step["step"] == "last") {
            EXPECT_EQ(step["why"], "factor changed 3 → 5 since run 1");
        }
    }
}

TEST_F(Batch, ScansOwnSettings_OverrideTheBatchs) {
    write_workflow("$factor");
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nparameters: {factor: 1}\nsteps:\n  - "
                  "test-step: {factor: $factor}\noutputs: {'{scan}.{variant}.xyz': test-step.points}\n");
    folder_.write("scans/a.xyz", "1 0 0\n0 1 0\n0 0 1\n");
    folder_.write("scans/b.xyz", "1 0 0\n0 1 0\n0 0 2\n");
    write_batch("scans/a.xyz, {path: scans/b.xyz, set: {factor: 7}}", "set: {factor: {sweep: [2, 3]}}\n");
    ASSERT_EQ(run_batch().exit_code, 0);
    const auto files = outputs();
    ASSERT_EQ(files.size(), 3u);
    EXPECT_THAT(files.at("a.factor=2.xyz"), HasSubstr("2 0 0"));
    EXPECT_THAT(files.at("a.factor=3.xyz"), HasSubstr("3 0 0"));
    EXPECT_THAT(files.at("b.default.xyz"), HasSubstr("7 0 0"));
}

TEST_F(Batch, UnitFrameAndPose_TravelWithTheScan) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs: "
                  "{'{scan}.ply': test-step.points}\n");
    folder_.write("scans/a.xyz", "1 0 0\n0 1 0\n0 0 1\n");
    write_batch(
        "{path: scans/a.xyz, unit: mm, frame: part, pose: [[0, -1, 0, 10], [1, 0, 0, 0], [0, 0, "
        "1, 0], [0, 0, 0, 1]]}");
    ASSERT_EQ(run_batch().exit_code, 0);
    const std::string text = scanmill({"info", "out/a.ply"}).out;
    EXPECT_THAT(text, AllOf(HasSubstr("mm"), HasSubstr("part")));
    scanmill({"convert", "out/a.ply", "out/a.xyz"});
    EXPECT_THAT(content_of(folder_ / "out/a.xyz"), HasSubstr("\n10 1 0\n9 0 0\n10 0 1\n")) << "turned, then moved";
}

TEST_F(Batch, TwoWorkflows_ShareWhatIsEqual) {
    write_workflow("2");
    folder_.write("v.yaml",
                  "scanmill: 1\nname: v\ninputs: {scan: points}\nsteps:\n  - test-step: {factor: 0.5}\n"
                  "outputs: {'{workflow}-{scan}.ply': test-step}\n");
    write_scans("scan", 2);
    folder_.write("b.yaml", "scanmill: 1\nbatch: b\nscans: [scans/*.xyz]\nworkflows: [w.yaml, v.yaml]\n");
    ASSERT_EQ(run_batch().exit_code, 0);
    const Json run = recorded(1);
    EXPECT_EQ(run["cells"].size(), 4u);
    EXPECT_EQ(run["steps"].size(), 6u) << "two reads, two shared steps, two more";
    EXPECT_EQ(count(run["cells"], "workflow", "v"), 2u);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/v-scan_01.ply"));
}

TEST_F(Batch, TwoCellsOfOneFile_AreRefusedBeforeAnythingRuns) {
    write_workflow("2");
    folder_.write("scans/one/a.xyz", "1 0 0\n");
    folder_.write("scans/two/a.xyz", "2 0 0\n");
    write_batch("scans/**/a.xyz");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, AllOf(HasSubstr("would both write"), HasSubstr("{workflow}")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

/// One of them may fail its expectation; then nobody could say what the file is.
TEST_F(Batch, OneFileOfTwoWorkflowsThatExpectDifferentThings_IsRefused) {
    write_scans("scan", 1);
    const std::string head =
        "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\n    expect: {points: ";
    folder_.write("strict.yaml", head + "77}\noutputs: {'{scan}.ply': test-step}\n");
    folder_.write("lax.yaml", head + "5}\noutputs: {'{scan}.ply': test-step}\n");
    folder_.write("b.yaml", "scanmill: 1\nbatch: b\nscans: [scans/*.xyz]\nworkflows: [strict.yaml, lax.yaml]\n");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("would both write"));
}

/// Reading what all scans share is the only thing that is done more than once.
TEST_F(Batch, SharedInput_BelongsToEveryScan) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points, other: points}\nsteps:\n  - test-step: "
                  "{mode: slow}\n    in: {points: scan, more: [other]}\noutputs: {'{scan}.ply': test-step}\n");
    write_scans("scan", 6);
    folder_.write("other.xyz", "5 5 5\n");
    std::map<std::string, std::string> expected;
    for (const char* jobs : {"0", "3"}) {
        std::filesystem::remove_all(folder_ / "out");
        std::vector<std::string> arguments{"run", "w.yaml"};
        for (int i = 1; i <= 6; ++i) arguments.push_back(fmt::format("scans/scan_{:02}.xyz", i));
        arguments.insert(arguments.end(), {"--in", "other=other.xyz", "-o", "out", "--no-cache", "-j", jobs});
        const ProgramResult result = scanmill(arguments);
        ASSERT_EQ(result.exit_code, 0) << result.err;
        const Json run = recorded(1);
        EXPECT_EQ(run["steps"].size(), 13u) << "seven reads, one of which is the shared one, and six steps";
        if (expected.empty()) expected = outputs();
        EXPECT_EQ(outputs(), expected);
    }
}

/// What is cached stands on what it was made from: the same is written as if nothing were cached.
TEST_F(Batch, ExpectationAddedBeforeWhatIsCached_FailsItToo) {
    write_scans("scan", 1);
    write_batch("scans/*.xyz");
    const auto workflow = [&](const std::string& expect) {
        folder_.write("w.yaml", "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - id: a\n    test-step:\n" +
                                    expect +
                                    "  - id: b\n    test-step: {factor: 2}\n    in: {points: a.points}\n"
                                    "outputs: {'{scan}.ply': b}\n");
    };
    workflow("");
    ASSERT_EQ(run_batch({"--keep", "always"}).exit_code, 0);
    std::filesystem::remove_all(folder_ / "out");
    workflow("    expect: {points: 77}\n");
    EXPECT_EQ(run_batch({"--keep", "always"}).exit_code, 1);
    EXPECT_EQ(outputs().size(), 0u);
}

TEST_F(Batch, TruthAndPoseFiles_AreNotReplaced) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs: "
                  "{'{scan}.ply': test-step}\n");
    folder_.write("in/p.xyz", "1 2 3\n4 5 6\n");
    folder_.write("out/p.ply", "the truth");
    write_batch("{path: in/p.xyz, truth: out/p.ply}");
    EXPECT_EQ(run_batch().exit_code, 2);
    EXPECT_EQ(content_of(folder_ / "out/p.ply"), "the truth");
    const std::string pose = "{\"scanmill\": 1, \"poses\": [{\"rotation\": [0, 0, 0, 1], \"translation\": [1, 0, 0]}]}";
    folder_.write("out/p.ply.json", pose);
    write_batch("{path: in/p.xyz, pose: out/p.ply.json}");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("is an input"));
    EXPECT_EQ(content_of(folder_ / "out/p.ply.json"), pose);
}

TEST_F(Batch, EqualScansOfOneName_NeedTwoFiles_WhichTheFolderGives) {
    const auto workflow = [&](const std::string& name) {
        folder_.write("w.yaml", "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs: {'" +
                                    name + "': test-step}\n");
    };
    folder_.write("scans/one/a.xyz", "1 2 3\n4 5 6\n");
    folder_.write("scans/two/a.xyz", "1 2 3\n4 5 6\n");
    write_batch("{path: scans/*/a.xyz, frame: lab, unit: mm}");
    workflow("{scan}.ply");
    EXPECT_EQ(run_batch().exit_code, 2);
    workflow("{folder}/{scan}.ply");
    ASSERT_EQ(run_batch().exit_code, 0);
    const Json described = Json::parse(content_of(folder_ / "out/two/a.ply.json"));
    EXPECT_EQ(described["scan"], "scans/two/a.xyz");
    EXPECT_EQ(described["steps"][0]["file"], "scans/two/a.xyz") << "though it was read as the other one";
    EXPECT_EQ(described["steps"][0]["frame"], "lab");
    EXPECT_EQ(described["steps"][0]["unit"], "mm");
    Sha256 hash;
    hash.add(content_of(folder_ / "out/two/a.ply"));
    EXPECT_EQ(described["file"]["sha256"], hash.text());
}

TEST_F(Batch, NobodyListening_IsNoReasonToStop) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("scans/*.xyz");
    for (const char* where : {">/dev/full", ">&-", "2>/dev/full", "2>&-", "--json >/dev/full", "--json | head -1"}) {
        std::filesystem::remove_all(folder_ / "out");
        const std::string command = "cd '" + folder_.path().string() +
                                    "' && (SCANMILL_PLUGIN_PATH='" SCANMILL_TEST_PLUGIN_DIR
                                    "' XDG_CACHE_HOME=home '" SCANMILL_PROGRAM "' batch b.yaml -o out --no-cache " +
                                    where + ") > /dev/null 2>&1";
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
    EXPECT_EQ(lines.back()["done"], 2);
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
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("scan_01.xyz: last"), HasSubstr("was asked to fail"), HasSubstr("in step 'last' ("),
                      HasSubstr("on scan '"), HasSubstr("under variant 'factor=2'"), Not(HasSubstr("\x1b"))));
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
    EXPECT_THAT(scanmill({"worker"}).err, HasSubstr("is started by scanmill itself"));
    EXPECT_THAT(scanmill({"--help"}).out, Not(HasSubstr("worker ")));
}

}  // namespace
}  // namespace scanmill::test
