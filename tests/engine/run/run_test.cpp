// SPDX-License-Identifier: GPL-3.0-or-later
// Running: every node once, values reach the right ports, what was asked for is what runs.

#include "scanmill/run/run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/run/run_fixture.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;

using test::Run;

TEST_F(Run, StepsSharedByVariants_RunOnce) {
    const RunReport report = run("  - test-step: {factor: 2, log: " + log() +
                                     "}\n  - id: b\n    test-step: {factor: {sweep: [3, 4, 5]}, log: " + log() + "}\n",
                                 {scan("a.xyz")}, "outputs: {'{scan}-{variant}.xyz': b}\n");
    EXPECT_TRUE(report.outcome() == Outcome::ok);
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
    EXPECT_TRUE(report.outcome() == Outcome::ok);
    EXPECT_EQ(runs_logged(), 2u);
    EXPECT_EQ(test::content_of(folder_ / "out/a.xyz"), test::content_of(folder_ / "out/b.xyz"));
    EXPECT_NE(test::content_of(folder_ / "out/a.xyz"), test::content_of(folder_ / "out/c.xyz"));
}

TEST_F(Run, ListInput_ReachesThePortWhole) {
    request_.inputs = {{"others", {scan("b.xyz", "5 5 5\n6 6 6\n"), scan("c.xyz", "7 7 7\n8 8 8\n9 9 9\n")}}};
    const RunReport report = run("  - test-step:\n    in: {points: scan, more: others}\n", {scan("a.xyz")}, "",
                                 "{scan: points, others: [points]}");
    EXPECT_TRUE(report.outcome() == Outcome::ok) << report.cells[0].failure.whole().what();
    EXPECT_EQ(graph_.nodes.back().inputs.size(), 3u);
}

TEST_F(Run, OptionalPortOfAKindThatAnotherPortTakes_StaysOpenWithoutIn) {
    run("  - test-step:\n", {scan("a.xyz")});
    ASSERT_EQ(graph_.nodes.back().inputs.size(), 1u);
    EXPECT_EQ(graph_.nodes.back().inputs[0].port, "points");
}

TEST_F(Run, OnlyUntilAndSave_SelectVariantsAndSteps) {
    const std::string steps = "  - id: a\n    test-step: {factor: {sweep: [1, 2]}, log: " + log() +
                              "}\n  - id: b\n    test-step: {factor: 7, log: " + log() + "}\n";
    request_.only = {"factor=2"};
    request_.until = "a";
    request_.save = {"a"};
    const RunReport report = run(steps, {scan("s.xyz")}, "outputs: {'{scan}-{variant}.xyz': b}\n");
    EXPECT_TRUE(report.outcome() == Outcome::ok);
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
    EXPECT_FALSE(report.outcome() == Outcome::ok);
    EXPECT_FALSE(report.cells[0].failure);
}

TEST_F(Run, Warnings_AreKeptWithTheirStep) {
    const RunReport report = run("  - test-step: {mode: warn}\n", {scan("a.xyz")});
    EXPECT_EQ(report.nodes[1].warnings.size(), 1u);
    EXPECT_TRUE(report.outcome() == Outcome::ok);
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

TEST_F(Run, WorkflowWithoutInputs_RunsOnceUnderItsOwnName) {
    const RunReport report = run("  - test-step:\n", {}, "outputs: {'{scan}.ply': test-step.mesh}\n", "{}");
    EXPECT_THAT(graph_.scan_names, ElementsAre("w"));
    EXPECT_EQ(report.cells.size(), 1u);
}

}  // namespace
}  // namespace scanmill
