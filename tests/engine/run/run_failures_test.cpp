// SPDX-License-Identifier: GPL-3.0-or-later
// What fails in a run, how it is said, and that it takes nothing else along.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/run/run_fixture.hpp"
#include "scanmill/base/error.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::HasSubstr;

using test::Run;

TEST_F(Run, FailingAlternative_LeavesTheOthersAlone) {
    const RunReport report =
        run("  - id: x\n    one-of:\n      - {id: good, test-step: {factor: 2}}\n      - {id: bad, test-step: {mode: "
            "fail}}\n"
            "      - {id: worse, test-step: {mode: throw}}\n      - {id: huge, test-step: {mode: out-of-memory}}\n  - "
            "id: after\n    test-step: {log: " +
                log() + "}\n",
            {scan("a.xyz")}, "outputs: {'{scan}-{variant}.xyz': after}\n");
    ASSERT_EQ(report.cells.size(), 4u);
    EXPECT_EQ(report.cells[0].outcome, Outcome::ok);
    for (int failed = 1; failed < 4; ++failed) EXPECT_EQ(report.cells[failed].outcome, Outcome::failed);
    EXPECT_THAT(report.cells[1].failure.whole().what(),
                AllOf(HasSubstr("in step 'bad' (w.yaml:8:19)"), HasSubstr("a.xyz'"), HasSubstr("hint: ")));
    EXPECT_THAT(report.cells[2].failure.whole().what(), HasSubstr("an unexpected error: "));
    EXPECT_THAT(report.cells[3].failure.whole().what(), HasSubstr("the machine is out of memory"));
    EXPECT_EQ(runs_logged(), 1u) << "nothing runs on what failed";
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/a-good.xyz"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/a-bad.xyz"));
}

TEST_F(Run, UndeclaredMetric_IsAFaultThatNamesFilterAndMetric) {
    const RunReport report = run("  - test-step: {mode: undeclared-metric}\n", {scan("a.xyz")});
    EXPECT_TRUE(report.has_fault());
    EXPECT_EQ(report.cells[0].failure.cause, Cause::fault);
    EXPECT_THAT(report.cells[0].failure.whole().what(), AllOf(HasSubstr("test-step"), HasSubstr("'stray'")));
    EXPECT_FALSE(run("  - test-step: {mode: fail}\n", {scan("a.xyz")}).has_fault());
}

TEST_F(Run, BadScan_FailsItsCellOnly) {
    const RunReport report =
        run("  - test-step:\n", {scan("bad.xyz", "1 2\n"), (folder_ / "missing.xyz").string(), scan("good.xyz")},
            "outputs: {'{scan}.xyz': test-step}\n");
    EXPECT_EQ(report.cells[0].outcome, Outcome::failed);
    EXPECT_EQ(report.cells[1].outcome, Outcome::failed);
    EXPECT_THAT(report.cells[1].failure.whole().what(), HasSubstr("missing.xyz"));
    EXPECT_EQ(report.cells[2].outcome, Outcome::ok);
}

TEST_F(Run, EmptyMesh_IsAnError) {
    const RunReport report = run("  - test-step: {mode: empty}\n", {scan("a.xyz")});
    EXPECT_THAT(report.cells[0].failure.whole().what(), HasSubstr("the result has no triangles"));
}

TEST_F(Run, Expectations_AreComparedWithMetricsAndFacts) {
    EXPECT_TRUE(run("  - test-step:\n    expect: {points: 4}\n", {scan("a.xyz")}).outcome() == Outcome::ok);
    EXPECT_TRUE(
        run("  - test-step: {length: 10 %diag}\n    expect: {points: [3, 5], length: '< 0.31 u'}\n", {scan("a.xyz")})
            .outcome() == Outcome::ok);
    const RunReport unmet =
        run("  - test-step:\n    expect: {points: '> 4'}\n", {scan("a.xyz")}, "outputs: {'{scan}.xyz': test-step}\n");
    EXPECT_EQ(unmet.cells[0].outcome, Outcome::failed);
    EXPECT_THAT(unmet.cells[0].failure.whole().what(), HasSubstr("expected points > 4, found 4"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/a.xyz"));
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

TEST_F(Run, LinkOutOfTheOutputFolder_IsRefused) {
    std::filesystem::create_directories(folder_ / "out");
    std::filesystem::create_directories(folder_ / "elsewhere");
    std::filesystem::create_directory_symlink(folder_ / "elsewhere", folder_ / "out/sub");
    EXPECT_THROW(run("  - test-step:\n", {scan("a.xyz")}, "outputs: {'sub/{scan}.xyz': test-step}\n"), Error);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "elsewhere/a.xyz"));
}

}  // namespace
}  // namespace scanmill
