// SPDX-License-Identifier: GPL-3.0-or-later
// Batches as a user meets them: what is computed and what is not, and why.

#include "runner/batch_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
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
    EXPECT_EQ(count(run["cells"], "outcome", "ok"), 68u);
    EXPECT_EQ(count(run["cells"], "outcome", "failed"), 12u);
    EXPECT_EQ(count(run["cells"], "cause", "signal"), 8u);
    EXPECT_EQ(count(run["cells"], "number", SIGSEGV), 4u);
    EXPECT_EQ(count(run["cells"], "number", SIGABRT), 4u);
    EXPECT_EQ(count(run["cells"], "cause", "exception"), 4u);
    EXPECT_EQ(outputs().size(), 68u);
    const std::vector<Json> shared = of_step(run, "shared");
    EXPECT_EQ(shared.size(), 20u) << "each is computed once, for four variants";
    EXPECT_EQ(count(shared, "outcome", "ok"), 20u);
    EXPECT_EQ(count(shared, "origin", "ran"), 20u);

    EXPECT_EQ(run_batch({"-j", "2"}).exit_code, 1);
    const Json again = recorded(2);
    EXPECT_EQ(count(again["cells"], "outcome", "ok"), 68u);
    for (const Json& step : again["steps"])
        EXPECT_EQ(step["origin"], step["outcome"] == "failed" ? "ran" : "cached") << step;
    EXPECT_EQ(count(again["steps"], "outcome", "failed"), 12u);
}

TEST_F(Batch, UndeclaredMetric_EndsWith3AndNamesFilterAndMetric) {
    write_workflow("1");
    write_scans("good", 2);
    write_batch("scans/good_01.xyz, {path: scans/good_02.xyz, set: {mode: undeclared-metric}}");
    for (const char* jobs : {"0", "1"}) {
        const ProgramResult ran = run_batch({"-j", jobs, "--no-cache"});
        EXPECT_EQ(ran.exit_code, 3);
        EXPECT_THAT(ran.err, AllOf(HasSubstr("test-step"), HasSubstr("'stray'")));
    }
    const Json run = recorded(2);
    EXPECT_EQ(count(run["cells"], "cause", "fault"), 1u);
    EXPECT_EQ(count(run["cells"], "outcome", "ok"), 1u);
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
    const std::string predicted = run_batch({"--dry-run"}).out;
    EXPECT_THAT(predicted, AllOf(HasSubstr("will run because factor changed 3 → 5 since run 1"),
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

TEST_F(Batch, WithoutScans_RunsEveryVariantOnce) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\nparameters: {views: 1}\nsteps:\n  - virtual-scan: {shape: sphere, views: "
                  "$views, resolution: 5 %diag}\noutputs: {'{scan}.{variant}.ply': virtual-scan}\n");
    folder_.write("b.yaml",
                  "scanmill: 1\nbatch: b\nworkflows: w.yaml\nset: {views: {sweep: [1, 2]}}\ngate: {points: exact}\n");
    const ProgramResult result = run_batch();
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/w.views=1.ply"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/w.views=2.ply"));
    EXPECT_EQ(outputs().size(), 2u);
    EXPECT_EQ(recorded(1)["cells"].size(), 2u);
    const ProgramResult chosen = run_batch({"--scan", "w"});
    EXPECT_EQ(chosen.exit_code, 2);
    EXPECT_THAT(chosen.err, HasSubstr("it has no scans"));
}

/// Cached results belong to their inputs: the output is the same as without the cache.
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

}  // namespace
}  // namespace scanmill::test
