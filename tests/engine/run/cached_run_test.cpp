// SPDX-License-Identifier: GPL-3.0-or-later
// Runs with a cache: nothing is computed twice, what changed is, results are the same bytes either way.

#include <gmock/gmock.h>

#include "engine/run/cached_run_fixture.hpp"
#include "scanmill/cache/prediction.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using enum Origin;

TEST_F(CachedRun, TheSameAgain_ComputesNothingAndWritesTheSame) {
    EXPECT_THAT(origins(run_two("factor: 2", "factor: 3, mode: warn")), ElementsAre(ran, ran, ran));
    const std::string first = content_of(folder_ / "out/a.ply");
    fs::remove(folder_ / "out/a.ply");
    const RunReport again = run_two("factor: 2", "factor: 3, mode: warn");
    EXPECT_THAT(origins(again), ElementsAre(cached, cached, cached));
    EXPECT_TRUE(again.outcome() == Outcome::ok);
    EXPECT_EQ(content_of(folder_ / "out/a.ply"), first);
    EXPECT_EQ(again.nodes[2].metrics.find("points")->value, 4);
    EXPECT_EQ(again.nodes[0].properties.find("points")->value, 4);
    EXPECT_THAT(again.nodes[2].warnings, ElementsAre(HasSubstr("asked to warn"))) << "a warning holds for the result";
    EXPECT_EQ(again.nodes[1].resolved.find("factor") != nullptr, true);
    EXPECT_THAT(told_, IsEmpty());
}

TEST_F(CachedRun, AnotherParameter_RunsTheStepsBelowItAndNoOthers) {
    run_two("factor: 2", "factor: 3");
    EXPECT_THAT(origins(run_two("factor: 2", "factor: 4")), ElementsAre(cached, cached, ran));
    EXPECT_THAT(origins(run_two("factor: 5", "factor: 4")), ElementsAre(cached, ran, ran));
    EXPECT_EQ(world_of_second_point(), Vec3(20, 0, 0));
}

TEST_F(CachedRun, CommentsOrderAndNames_ChangeNothing) {
    run_two("factor: 2, length: 1 u", "factor: 3");
    EXPECT_THAT(origins(run("# a comment\n  - id: other\n    test-step: {length: 1 u, factor: 2}\n"
                            "  - {test-step: {factor: 3}, id: name}\n",
                            {scan("renamed.xyz")}, "outputs: {'{scan}.ply': name.points}\n")),
                ElementsAre(cached, cached, cached));
    EXPECT_TRUE(fs::exists(folder_ / "out/renamed.ply"));
}

TEST_F(CachedRun, ChangeThatMakesNoDifference_IsCutOffBelow) {
    run_two("factor: 2, length: 1 u", "factor: 3");
    // Another mesh, which no step takes, and the same points.
    EXPECT_THAT(origins(run_two("factor: 2, length: 2 u", "factor: 3")), ElementsAre(cached, ran, same_inputs));
    EXPECT_THAT(origins(run_two("factor: 2, length: 2 u", "factor: 3")), ElementsAre(cached, cached, cached))
        << "from then on its plan is known too";
}

TEST_F(CachedRun, LengthsThatResolveToTheSame_AreTheSame) {
    run_two("length: 50 %diag", "factor: 3");  // the diagonal is 3
    EXPECT_THAT(origins(run_two("length: 1.5 u", "factor: 3")), ElementsAre(cached, same_inputs, same_inputs));
}

TEST_F(CachedRun, AnotherContentUnderTheSameName_IsAnotherScan) {
    run_two("factor: 2", "factor: 3");
    fs::remove(folder_ / "a.xyz");
    scan("a.xyz", "0 0 0\n7 0 0\n");
    prepare("  - test-step: {factor: 2}\n", {(folder_ / "a.xyz").string()});
    EXPECT_FALSE(predict(graph_, &cache_)[0].cached);
}

TEST_F(CachedRun, ScanThatChangesAfterPlanning_Fails) {
    prepare("  - test-step:\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': test-step}\n");
    scan("a.xyz", "0 0 0\n7 0 0\n");
    const RunReport report = run_graph();
    EXPECT_THAT(report.cells[0].failure.whole().what(), HasSubstr("changed during the run"));
    EXPECT_FALSE(fs::exists(folder_ / "out/a.ply"));
}

TEST_F(CachedRun, Failures_AreNotRemembered) {
    const std::string bad = "  - test-step: {mode: fail}\n";
    EXPECT_EQ(run(bad, {scan("a.xyz")}).nodes[1].outcome, Outcome::failed);
    const RunReport again = run(bad, {scan("a.xyz")});
    EXPECT_EQ(again.nodes[1].outcome, Outcome::failed);
    EXPECT_EQ(again.nodes[1].origin, ran);
}

TEST_F(CachedRun, ExpectationsOfWhatIsCached_AreAskedAgain) {
    const auto expecting = [&](const std::string& points) {
        return run("  - test-step: {factor: 2}\n    expect: {points: " + points + "}\n", {scan("a.xyz")});
    };
    EXPECT_TRUE(expecting("4").outcome() == Outcome::ok);
    const RunReport unmet = expecting("'> 4'");
    EXPECT_THAT(unmet.cells[0].failure.whole().what(),
                testing::AllOf(HasSubstr("points"), HasSubstr("in step 'test-step'")));
    EXPECT_EQ(unmet.nodes[1].origin, cached);
    EXPECT_TRUE(expecting("4").outcome() == Outcome::ok);
}

TEST_F(CachedRun, FileOfAParameterThatChangesMeanwhile_FailsTheStep) {
    // The step itself changes it: it appends to its log.
    folder_.write("log", "");
    const RunReport report = run("  - test-step: {log: " + log() + "}\n", {scan("a.xyz")});
    EXPECT_THAT(report.cells[0].failure.whole().what(), HasSubstr("log' changed during the run"));
    EXPECT_FALSE(cache_.run_key(graph_.nodes[1].key));
}

TEST_F(CachedRun, StepThatReadsWhatHasNoContent_IsNeverCached) {
    const std::string steps = "  - test-step: {log: " + log() + "}\n";
    EXPECT_TRUE(run(steps, {scan("a.xyz")}).outcome() == Outcome::ok);  // the log is not there yet
    fs::remove(folder_ / "log");
    const RunReport again = run(steps, {scan("a.xyz")});
    EXPECT_EQ(again.nodes[1].origin, ran);
    EXPECT_THAT(again.nodes[1].why, HasSubstr("a folder or a file that cannot be hashed"));
}

TEST_F(CachedRun, WarningsOfReading_NameTheFileThatWasRead) {
    const std::string text = "# unit furlong\n" + small_scan;
    run("  - test-step:\n", {scan("a.xyz", text)});
    const RunReport copy = run("  - test-step:\n", {scan("b.xyz", text)});
    EXPECT_EQ(copy.nodes[0].origin, cached);
    EXPECT_THAT(copy.nodes[0].warnings,
                ElementsAre(testing::AllOf(HasSubstr("/b.xyz': the unit"), testing::Not(HasSubstr("a.xyz")))));
}

TEST_F(CachedRun, EqualStepsThatExpectOtherThings_AreAskedEach) {
    request_.inputs = {{"other", {scan("b.xyz")}}};
    const RunReport report =
        run("  - id: one\n    test-step:\n    in: {points: scan}\n    expect: {points: 4}\n"
            "  - id: two\n    test-step:\n    in: {points: other}\n    expect: {points: '> 4'}\n",
            {scan("a.xyz")}, "", "{scan: points, other: points}");
    EXPECT_THAT(report.cells[0].failure.whole().what(), HasSubstr("in step 'two'"));
}

TEST_F(CachedRun, VariantsAndScans_ShareWhatIsEqual) {
    const std::string steps =
        "  - id: shared\n    test-step: {factor: 2}\n  - id: last\n    test-step: {factor: {sweep: [3, 4]}}\n";
    const std::string tail = "outputs: {'{scan}-{variant}.ply': last.points}\n";
    EXPECT_THAT(origins(run(steps, {scan("a.xyz"), scan("b.xyz")}, tail)), ElementsAre(ran, ran, ran, ran));
    EXPECT_THAT(origins(run(steps, {scan("a.xyz"), scan("c.xyz", "0 0 0\n9 0 0\n")}, tail)),
                ElementsAre(cached, cached, cached, cached, ran, ran, ran, ran));
}

}  // namespace
}  // namespace scanmill::test
