// SPDX-License-Identifier: GPL-3.0-or-later
// Running: every node once, failures stay where they are, values reach the right ports, outputs are whole.

#include "scanmill/engine/run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/run_fixture.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using test::Run;

TEST_F(Run, StepsSharedByVariants_RunOnce) {
    const RunReport report = run("  - test-step: {factor: 2, log: " + log() +
                                     "}\n  - id: b\n    test-step: {factor: {sweep: [3, 4, 5]}, log: " + log() + "}\n",
                                 {scan("a.xyz")}, "outputs: {'{scan}-{variant}.xyz': b}\n");
    EXPECT_TRUE(report.all_done());
    EXPECT_EQ(report.cells.size(), 3u);
    EXPECT_EQ(runs_logged(), 4u) << "one shared step and three of its own";
    const auto points = read_points(folder_ / "out/a-factor=4.xyz");
    EXPECT_EQ(points->positions[1] + points->frame.origin, Vec3(8, 0, 0));
}

TEST_F(Run, EqualContentUnderTwoExtensions_IsReadAsEachSays) {
    // Four columns of a PTS file are x, y, z and an intensity.
    const std::string rows = "2\n1 2 3 4\n5 6 7 8\n";
    run("  - test-step:\n", {scan("a.xyz", rows), scan("b.pts", rows)}, "outputs: {'{scan}.ply': test-step}\n");
    EXPECT_TRUE(read_points(folder_ / "out/a.ply")->columns.find("c4"));
    EXPECT_TRUE(read_points(folder_ / "out/b.ply")->columns.find("intensity"));
}

TEST_F(Run, Until_LeavesOutVariantsWithoutTheStep) {
    request_.until = "a";
    const RunReport report =
        run("  - one-of: [{id: a, test-step: }, {id: b, test-step: {factor: 2}}]\n"
            "  - id: last\n    test-step: {factor: 3}\n",
            {scan("x.xyz")}, "outputs: {'{scan}-{variant}.xyz': last}\n");
    EXPECT_EQ(report.cells.size(), 1u);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(Run, TwoFilesOfEqualContent_AreComputedOnceAndWrittenTwice) {
    const RunReport report =
        run("  - test-step: {log: " + log() + "}\n", {scan("a.xyz"), scan("b.xyz"), scan("c.xyz", "0 0 0\n1 1 1\n")},
            "outputs: {'{scan}.xyz': test-step}\n");
    EXPECT_TRUE(report.all_done());
    EXPECT_EQ(runs_logged(), 2u);
    EXPECT_EQ(test::content_of(folder_ / "out/a.xyz"), test::content_of(folder_ / "out/b.xyz"));
    EXPECT_NE(test::content_of(folder_ / "out/a.xyz"), test::content_of(folder_ / "out/c.xyz"));
}

TEST_F(Run, FailingAlternative_LeavesTheOthersAlone) {
    const RunReport report =
        run("  - id: x\n    one-of:\n      - {id: good, test-step: {factor: 2}}\n      - {id: bad, test-step: {mode: "
            "fail}}\n"
            "      - {id: worse, test-step: {mode: throw}}\n      - {id: huge, test-step: {mode: out-of-memory}}\n  - "
            "id: after\n    test-step: {log: " +
                log() + "}\n",
            {scan("a.xyz")}, "outputs: {'{scan}-{variant}.xyz': after}\n");
    ASSERT_EQ(report.cells.size(), 4u);
    EXPECT_EQ(report.cells[0].outcome, Outcome::done);
    for (int failed = 1; failed < 4; ++failed) EXPECT_EQ(report.cells[failed].outcome, Outcome::failed);
    EXPECT_THAT(report.cells[1].failure.text,
                AllOf(HasSubstr("in step 'bad' (w.yaml:8:19)"), HasSubstr("a.xyz'"), HasSubstr("hint: ")));
    EXPECT_THAT(report.cells[2].failure.text, HasSubstr("an unexpected error: "));
    EXPECT_THAT(report.cells[3].failure.text, HasSubstr("memory did not suffice"));
    EXPECT_EQ(runs_logged(), 1u) << "nothing runs on what failed";
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/a-good.xyz"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/a-bad.xyz"));
}

TEST_F(Run, BadScan_FailsItsCellOnly) {
    const RunReport report =
        run("  - test-step:\n", {scan("bad.xyz", "1 2\n"), (folder_ / "missing.xyz").string(), scan("good.xyz")},
            "outputs: {'{scan}.xyz': test-step}\n");
    EXPECT_EQ(report.cells[0].outcome, Outcome::failed);
    EXPECT_EQ(report.cells[1].outcome, Outcome::failed);
    EXPECT_THAT(report.cells[1].failure.text, HasSubstr("missing.xyz"));
    EXPECT_EQ(report.cells[2].outcome, Outcome::done);
}

TEST_F(Run, EmptyMesh_IsAnError) {
    const RunReport report = run("  - test-step: {mode: empty}\n", {scan("a.xyz")});
    EXPECT_THAT(report.cells[0].failure.text, HasSubstr("the result has no triangles"));
}

TEST_F(Run, Expectations_AreComparedWithMetricsAndFacts) {
    EXPECT_TRUE(run("  - test-step:\n    expect: {points: 4}\n", {scan("a.xyz")}).all_done());
    EXPECT_TRUE(
        run("  - test-step: {length: 10 %diag}\n    expect: {points: [3, 5], length: '< 0.31 u'}\n", {scan("a.xyz")})
            .all_done());
    const RunReport unmet =
        run("  - test-step:\n    expect: {points: '> 4'}\n", {scan("a.xyz")}, "outputs: {'{scan}.xyz': test-step}\n");
    EXPECT_EQ(unmet.cells[0].outcome, Outcome::failed);
    EXPECT_THAT(unmet.cells[0].failure.text, HasSubstr("expected points > 4, found 4"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/a.xyz"));
}

TEST_F(Run, Lengths_AreResolvedOnceAgainstTheFirstInput) {
    const auto length_of = [&](const std::string& written) {
        const RunReport report =
            run("  - test-step: {length: " + written + "}\n", {scan("a.xyz", "# unit mm\n" + test::small_scan)});
        return report.nodes[1].metrics.find("length")->value;
    };
    EXPECT_DOUBLE_EQ(length_of("10 %diag"), 0.3);
    EXPECT_DOUBLE_EQ(length_of("0.5 u"), 0.5);
    EXPECT_DOUBLE_EQ(length_of("1 cm"), 10);
    EXPECT_DOUBLE_EQ(length_of("1 in"), 25.4);
    // Nearest neighbours: 1, 1, 2 and sqrt(8): of four the upper median is 2.
    EXPECT_DOUBLE_EQ(length_of("2 spacing"), 4);
}

TEST_F(Run, AbsoluteLengthOnAScanOfUnknownUnit_Fails) {
    const RunReport report = run("  - test-step: {length: 1 mm}\n", {scan("a.xyz")});
    EXPECT_THAT(report.cells[0].failure.text,
                AllOf(HasSubstr("unit is not declared"), HasSubstr("--unit mm"), HasSubstr("'length'")));
    request_.unit = LengthUnit::metre;
    EXPECT_DOUBLE_EQ(run("  - test-step: {length: 1 mm}\n", {scan("a.xyz")}).nodes[1].metrics.find("length")->value,
                     0.001);
}

TEST_F(Run, UnitOfTheWorkflowInput_IsTheScans) {
    const RunReport report =
        run("  - test-step: {length: 1 cm}\n", {scan("a.xyz")}, "outputs: {'{scan}.xyz': test-step}\n",
            "{scan: {kind: points, unit: m, frame: part}}");
    EXPECT_DOUBLE_EQ(report.nodes[1].metrics.find("length")->value, 0.01);
    const auto written = read_points(folder_ / "out/a.xyz");
    EXPECT_EQ(written->frame.unit, LengthUnit::metre);
    EXPECT_EQ(written->frame.name, "part");
}

TEST_F(Run, InputsOfDifferentUnits_AreRefused) {
    request_.inputs = {{"others", {scan("b.xyz", "# unit m\n" + test::small_scan)}}};
    const RunReport report =
        run("  - test-step:\n    in: {points: scan, more: others}\n", {scan("a.xyz", "# unit mm\n" + test::small_scan)},
            "", "{scan: points, others: [points]}");
    EXPECT_THAT(report.cells[0].failure.text, HasSubstr("different units: mm at 'points', m at 'more'"));
}

TEST_F(Run, ListInput_ReachesThePortWhole) {
    request_.inputs = {{"others", {scan("b.xyz", "5 5 5\n6 6 6\n"), scan("c.xyz", "7 7 7\n8 8 8\n9 9 9\n")}}};
    const RunReport report = run("  - test-step:\n    in: {points: scan, more: others}\n", {scan("a.xyz")}, "",
                                 "{scan: points, others: [points]}");
    EXPECT_TRUE(report.all_done()) << report.cells[0].failure.text;
    EXPECT_EQ(graph_.nodes.back().inputs.size(), 3u);
}

TEST_F(Run, OptionalPortOfAKindThatAnotherPortTakes_StaysOpenWithoutIn) {
    run("  - test-step:\n", {scan("a.xyz")});
    ASSERT_EQ(graph_.nodes.back().inputs.size(), 1u);
    EXPECT_EQ(graph_.nodes.back().inputs[0].port, "points");
}

TEST_F(Run, UnfedOrUnknownInputs_AreRefusedBeforeTheRun) {
    const std::string inputs = "{scan: points, other: points}";
    const std::string steps = "  - test-step:\n    in: {points: scan}\n";
    EXPECT_THROW(run(steps, {scan("a.xyz")}, "", inputs), Error);
    request_.inputs = {{"othr", {"x"}}};
    try {
        run(steps, {scan("a.xyz")}, "", inputs);
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), HasSubstr("did you mean 'other'?"));
    }
    request_.inputs = {{"other", {"x", "y"}}};
    EXPECT_THROW(run(steps, {scan("a.xyz")}, "", inputs), Error);
}

TEST_F(Run, DistantScan_KeepsItsCoordinatesThroughSteps) {
    const std::string distant =
        "500000.000001 4900000.25 0\n500001.5 4900000.5 0\n500000.125 4900002.75 1\n500001 4900001 2\n";
    const RunReport report = run("  - test-step:\n", {scan("a.xyz", distant)}, "outputs: {'{scan}.xyz': test-step}\n");
    EXPECT_TRUE(report.all_done());
    EXPECT_EQ(test::content_of(folder_ / "out/a.xyz"), distant);
}

TEST_F(Run, OnlyUntilAndSave_SelectVariantsAndSteps) {
    const std::string steps = "  - id: a\n    test-step: {factor: {sweep: [1, 2]}, log: " + log() +
                              "}\n  - id: b\n    test-step: {factor: 7, log: " + log() + "}\n";
    request_.only = {"factor=2"};
    request_.until = "a";
    request_.save = {"a"};
    const RunReport report = run(steps, {scan("s.xyz")}, "outputs: {'{scan}-{variant}.xyz': b}\n");
    EXPECT_TRUE(report.all_done());
    EXPECT_EQ(runs_logged(), 1u);
    EXPECT_EQ(report.cells.size(), 1u);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/s.factor=2.a.ply"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/s-factor=2.xyz"));
}

TEST_F(Run, Cancelling_EndsTheRunAndKeepsWhatWasFinished) {
    int asked = 0;
    settings_.is_cancelled = [&] { return ++asked > 3; };
    const RunReport report = run("  - test-step: {mode: wait}\n", {scan("a.xyz"), scan("b.xyz", "0 0 0\n1 1 1\n")});
    EXPECT_TRUE(report.interrupted);
    EXPECT_FALSE(report.all_done());
    EXPECT_THAT(report.cells[0].failure.text, IsEmpty());
}

TEST_F(Run, Warnings_AreKeptWithTheirStep) {
    const RunReport report = run("  - test-step: {mode: warn}\n", {scan("a.xyz")});
    EXPECT_EQ(report.nodes[1].warnings.size(), 1u);
    EXPECT_TRUE(report.all_done());
}

TEST_F(Run, PlanKeys_KnowContentUnitSeedAndParametersAndNoPath) {
    const auto key = [&](const std::string& steps, const std::string& file) {
        run(steps, {file});
        return graph_.nodes.back().key;
    };
    const std::string a = scan("a.xyz"), copy = scan("elsewhere/copy.xyz"), other = scan("o.xyz", "0 0 0\n1 1 1\n");
    const std::string first = key("  - test-step:\n", a);
    EXPECT_EQ(key("  - id: renamed\n    test-step: {factor: 1}\n", copy), first);
    EXPECT_NE(key("  - test-step: {factor: 2}\n", a), first);
    EXPECT_NE(key("  - test-step:\n", other), first);
    request_.seed = 1;
    EXPECT_NE(key("  - test-step:\n", a), first);
    request_.seed = 0;
    request_.unit = LengthUnit::millimetre;
    EXPECT_NE(key("  - test-step:\n", a), first);
    request_.unit = LengthUnit::unknown;
    settings_.threads = 2;
    EXPECT_EQ(key("  - test-step:\n", a), first);
}

TEST_F(Run, LinkOutOfTheOutputFolder_IsRefused) {
    std::filesystem::create_directories(folder_ / "out");
    std::filesystem::create_directories(folder_ / "elsewhere");
    std::filesystem::create_directory_symlink(folder_ / "elsewhere", folder_ / "out/sub");
    EXPECT_THROW(run("  - test-step:\n", {scan("a.xyz")}, "outputs: {'sub/{scan}.xyz': test-step}\n"), Error);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "elsewhere/a.xyz"));
}

TEST_F(Run, WorkflowWithoutInputs_RunsOnceUnderItsOwnName) {
    const RunReport report = run("  - test-step:\n", {}, "outputs: {'{scan}.ply': test-step.mesh}\n", "{}");
    EXPECT_THAT(graph_.scan_names, ElementsAre("w"));
    EXPECT_EQ(report.cells.size(), 1u);
}

}  // namespace
}  // namespace scanmill
