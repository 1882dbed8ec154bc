// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts on runs made by hand: what trips the gate, and that nothing else does.

#include "scanmill/compare/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/compare/made_runs.hpp"
#include "support/numbers.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const double infinite = std::numeric_limits<double>::infinity();

/// The verdict when hausdorff goes from one value to another under one rule.
Verdict judged(const std::string& rule, double accepted, double found) {
    return compared(run_of_one(2, found, {{"hausdorff", rule, {}}}), run_of_one(1, accepted)).cells[0].verdict;
}

TEST(Comparison, WithoutAnAcceptedRun_EverythingIsNew) {
    const Comparison comparison = compare(run_of_one(1, 0.5, {{"hausdorff", "+1 %", {}}}), nullptr);
    EXPECT_EQ(comparison.verdict, Verdict::is_new);
    EXPECT_EQ(comparison.cells[0].verdict, Verdict::is_new);
    EXPECT_FALSE(comparison.tripped() || comparison.accepted);
    EXPECT_THAT(comparison.cells[0].metrics, IsEmpty());
}

TEST(Comparison, EqualRuns_Pass) {
    const Comparison comparison = compared(run_of_one(2, 0.5, {{"hausdorff", "exact", {}}}), run_of_one(1, 0.5));
    EXPECT_EQ(comparison.verdict, Verdict::passed);
    EXPECT_EQ(comparison.count(Verdict::passed), 1u);
    EXPECT_THAT(what_changed(comparison), IsEmpty());
    EXPECT_THAT(comparison.cells[0].command, IsEmpty());
}

TEST(Comparison, EveryFormOfRule_LimitsWhatItSays) {
    EXPECT_EQ(judged("+1 %", 0.5, 0.505), Verdict::passed) << "on the limit";
    EXPECT_EQ(judged("+1 %", 0.1, 0.101), Verdict::passed) << "on the limit, up to rounding";
    EXPECT_EQ(judged("+1 %", 0.5, 0.5051), Verdict::regressed);
    EXPECT_EQ(judged("+1 %", 0.5, 0.499), Verdict::passed);
    EXPECT_EQ(judged("+1 %", 0.5, 0.4), Verdict::improved);
    EXPECT_EQ(judged("-1 %", 0.5, 0.4), Verdict::regressed);
    EXPECT_EQ(judged("-1 %", 0.5, 0.6), Verdict::improved);
    EXPECT_EQ(judged("1 %", 0.5, 0.4), Verdict::regressed);
    EXPECT_EQ(judged("1 %", 0.5, 0.6), Verdict::regressed);
    EXPECT_EQ(judged("1 %", 0.5, 0.502), Verdict::passed);
    EXPECT_EQ(judged("+0.01 mm", 0.5, 0.51), Verdict::passed);
    EXPECT_EQ(judged("+0.01 mm", 0.5, 0.52), Verdict::regressed);
    EXPECT_EQ(judged("+1 %diag", 0.5, 2.5), Verdict::passed) << "1 % of the diagonal of 200 mm";
    EXPECT_EQ(judged("+1 %diag", 0.5, 2.6), Verdict::regressed);
    EXPECT_EQ(judged("exact", 0.5, 0.5), Verdict::passed);
    EXPECT_EQ(judged("exact", 0.5, std::nextafter(0.5, 1)), Verdict::regressed);
}

/// A run with a measured genus, and that of the truth; nan: none.
RunDetails run_with_genus(std::int64_t id, double genus, double truth, const std::string& rule = "= truth") {
    RunDetails run = run_of_one(id, 0.5, {{"genus", rule, {}}});
    Metrics& metrics = step_of(run, run.cells[0], "measure-surface").metrics;
    metrics.set("genus", genus, Unit::count);
    metrics.set("truth-genus", truth, Unit::count);
    return run;
}

Verdict judged_by_truth(double accepted, double found, double truth, const std::string& rule = "= truth") {
    return compared(run_with_genus(2, found, truth, rule), run_with_genus(1, accepted, truth, rule)).cells[0].verdict;
}

TEST(Comparison, RuleOfTheTruth_RequiresItsValueWhateverWasAccepted) {
    EXPECT_EQ(judged_by_truth(1, 1, 1), Verdict::passed);
    EXPECT_EQ(judged_by_truth(1, 2, 1), Verdict::regressed);
    EXPECT_EQ(judged_by_truth(2, 2, 1), Verdict::regressed) << "the accepted run was wrong, too";
    EXPECT_EQ(judged_by_truth(2, 1, 1), Verdict::improved);
    EXPECT_EQ(judged_by_truth(4, 2, 1), Verdict::improved) << "nearer";
    EXPECT_EQ(judged_by_truth(2, 0, 1), Verdict::regressed) << "as far on the other side";
    const Comparison wrong = compared(run_with_genus(2, 3, 1), run_with_genus(1, 2, 1));
    EXPECT_THAT(wrong.cells[0].reasons,
                Contains(AllOf(HasSubstr("genus"), HasSubstr("2"), HasSubstr("3"), HasSubstr("= truth (1)"))));
}

TEST(Comparison, RuleOfTheTruth_NeedsNoAcceptedRun) {
    EXPECT_EQ(compare(run_with_genus(1, 1, 1), nullptr).cells[0].verdict, Verdict::is_new);
    const Comparison wrong = compare(run_with_genus(1, 3, 1), nullptr);
    EXPECT_EQ(wrong.cells[0].verdict, Verdict::regressed);
    EXPECT_THAT(wrong.cells[0].reasons, Contains(AllOf(HasSubstr("genus"), HasSubstr("3"), HasSubstr("truth (1)"))));
}

TEST(Comparison, RuleOfTheTruth_WithoutItsValue_CannotBeApplied) {
    const Comparison comparison = compared(run_with_genus(2, 1, nan), run_with_genus(1, 1, nan));
    EXPECT_EQ(comparison.cells[0].verdict, Verdict::failed);
    EXPECT_THAT(comparison.cells[0].reasons, Contains(HasSubstr("truth-genus")));
}

TEST(Comparison, ValueThatMovesTowardsTheTruth_IsNoRegression) {
    EXPECT_EQ(judged_by_truth(3, 1, 1, "exact"), Verdict::improved);
    EXPECT_EQ(judged_by_truth(1, 3, 1, "exact"), Verdict::regressed);
    EXPECT_EQ(judged_by_truth(3, 2, 1, "1 %"), Verdict::improved);
    EXPECT_EQ(judged_by_truth(3, 1, nan, "exact"), Verdict::regressed) << "no truth is known";
}

TEST(Comparison, ZeroNegativeAndInfiniteValues_HaveLimits) {
    EXPECT_EQ(judged("+1 %", 0, 0), Verdict::passed);
    EXPECT_EQ(judged("+1 %", 0, 1e-9), Verdict::regressed) << "a share of nothing is nothing";
    EXPECT_EQ(judged("+1 %", -1, -0.995), Verdict::passed);
    EXPECT_EQ(judged("+1 %", -1, -0.9), Verdict::regressed);
    EXPECT_EQ(judged("+1 %", 0.5, infinite), Verdict::regressed);
    EXPECT_EQ(judged("+1 %", infinite, infinite), Verdict::passed);
    EXPECT_EQ(judged("+1 %", infinite, 0.5), Verdict::improved);
    EXPECT_EQ(judged("+1 mm", infinite, 0.5), Verdict::improved);
}

TEST(Comparison, AValueThatIsGone_IsARegression) {
    EXPECT_EQ(judged("+1 %", 0.5, nan), Verdict::regressed);
    EXPECT_EQ(judged("+1 %", nan, 0.5), Verdict::passed) << "listed, and trips nothing";
    EXPECT_EQ(judged("+1 %", nan, nan), Verdict::passed);
    const Comparison gone = compared(run_of_one(2, nan, {{"hausdorff", "+1 %", {}}}), run_of_one(1, 0.5));
    EXPECT_THAT(gone.cells[0].reasons, ElementsAre("hausdorff is gone; it was 0.5 mm"));
    const Comparison added = compared(run_of_one(2, 0.5, {{"hausdorff", "+1 %", {}}}), run_of_one(1, nan));
    ASSERT_THAT(added.cells[0].metrics, SizeIs(1));
    EXPECT_EQ(added.cells[0].metrics[0].effect, Effect::listed);
    EXPECT_FALSE(added.cells[0].metrics[0].accepted);
}

TEST(Comparison, Reasons_GiveTheNumbers) {
    const Comparison comparison = compared(run_of_one(2, 0.75, {{"hausdorff", "+1 %", {}}}), run_of_one(1, 0.5));
    EXPECT_THAT(comparison.cells[0].reasons, ElementsAre("hausdorff 0.5 mm → 0.75 mm (+1 %)"));
    EXPECT_EQ(comparison.cells[0].metrics[0].share, 0.5);
    EXPECT_TRUE(comparison.tripped());
    EXPECT_EQ(comparison.verdict, Verdict::regressed);
}

TEST(Comparison, ARule_IsForMeasurementsThenOutputsThenSteps) {
    // genus is a property of the output and of the step: the output's counts.
    RunDetails before = run_of_one(1, 0.5), now = run_of_one(2, 0.5, {{"genus", "exact", {}}});
    step_of(now, now.cells[0], "surface").properties.set("genus", 2, Unit::count);
    EXPECT_EQ(compared(now, before).verdict, Verdict::passed);
    now.cells[0].outputs[0].properties.set("genus", 2, Unit::count);
    EXPECT_EQ(compared(now, before).verdict, Verdict::regressed);
    // The measurement's value of that name, if there is one, counts before both.
    step_of(now, now.cells[0], "measure-surface").metrics.set("genus", 1, Unit::count);
    step_of(before, before.cells[0], "measure-surface").metrics.set("genus", 1, Unit::count);
    EXPECT_EQ(compared(now, before).verdict, Verdict::passed);
    // A value of steps.
    now = run_of_one(2, 0.5, {{"flips", "exact", {}}});
    step_of(now, now.cells[0], "surface").metrics.set("flips", 13, Unit::count);
    EXPECT_EQ(compared(now, before).cells[0].metrics[0].source, "surface");
    EXPECT_EQ(compared(now, before).verdict, Verdict::regressed);
}

TEST(Comparison, ARuleWithAStep_IsForThatStep) {
    RunDetails before = run_of_one(1, 0.5), now = run_of_one(2, 0.5, {{"surface.genus", "exact", {}}});
    now.cells[0].outputs[0].properties.set("genus", 2, Unit::count);
    EXPECT_EQ(compared(now, before).verdict, Verdict::passed);
    step_of(now, now.cells[0], "surface").properties.set("genus", 2, Unit::count);
    EXPECT_EQ(compared(now, before).verdict, Verdict::regressed);
}

TEST(Comparison, LargerIsBetter_TripsDownwards) {
    RunDetails now = run_of_one(2, 0.5, {{"f-score", "-1 %", {}}, {"closed", "exact", {}}});
    Metrics& metrics = step_of(now, now.cells[0], "measure-surface").metrics;
    metrics.set("f-score", 0.895, Unit::ratio);
    EXPECT_EQ(compared(now, run_of_one(1, 0.5)).verdict, Verdict::passed);
    metrics.set("f-score", 0.85, Unit::ratio);
    EXPECT_EQ(compared(now, run_of_one(1, 0.5)).verdict, Verdict::regressed);
    metrics.set("f-score", 0.95, Unit::ratio);
    EXPECT_EQ(compared(now, run_of_one(1, 0.5)).verdict, Verdict::improved);
    metrics.set("closed", 0, Unit::boolean);
    const Comparison both = compared(now, run_of_one(1, 0.5));
    EXPECT_EQ(both.verdict, Verdict::regressed) << "better in one metric does not make up for another";
    EXPECT_THAT(both.cells[0].reasons, ElementsAre("closed yes → no (exact)"));
}

TEST(Comparison, WithoutARule_ChangesAreListedOnce) {
    RunDetails now = run_of_one(2, 0.6);
    now.cells[0].outputs[0].properties.set("triangles", 110, Unit::count);
    step_of(now, now.cells[0], "surface").properties.set("triangles", 110, Unit::count);
    const Comparison comparison = compared(now, run_of_one(1, 0.5));
    EXPECT_EQ(comparison.verdict, Verdict::passed);
    ASSERT_THAT(comparison.cells[0].metrics, SizeIs(2));
    EXPECT_EQ(comparison.cells[0].metrics[0].metric, "hausdorff") << "the larger change first";
    EXPECT_EQ(comparison.cells[0].metrics[1].source, "a.ply-default.ply");
}

TEST(Comparison, Units_AreConvertedOrRefused) {
    RunDetails before = run_of_one(1, 500), now = run_of_one(2, 0.5, {{"hausdorff", "+0.01 mm", {}}});
    step_of(now, now.cells[0], "measure-surface").metrics.unit = LengthUnit::metre;
    EXPECT_EQ(compared(now, before).verdict, Verdict::passed) << "500 mm are 0.5 m";
    step_of(now, now.cells[0], "measure-surface").metrics.set("hausdorff", 0.6, Unit::length);
    EXPECT_THAT(compared(now, before).cells[0].reasons, ElementsAre("hausdorff 0.5 m → 0.6 m (+0.01 mm)"));
    step_of(before, before.cells[0], "measure-surface").metrics.unit = LengthUnit::unknown;
    const Comparison lost = compared(now, before);
    EXPECT_EQ(lost.verdict, Verdict::failed);
    EXPECT_THAT(lost.cells[0].reasons,
                Contains("the rule hausdorff: +0.01 mm cannot be applied: the unit of lengths is m, and was u"));
}

TEST(Comparison, ARuleThatCannotBeApplied_FailsTheCell) {
    RunDetails now = run_of_one(1, 0.5, {{"hausdorff", "+0.01 mm", {}}});
    step_of(now, now.cells[0], "measure-surface").metrics.unit = LengthUnit::unknown;
    const Comparison first = compare(now, nullptr);
    EXPECT_EQ(first.cells[0].verdict, Verdict::failed) << "found in the first night, not in the second";
    EXPECT_THAT(first.cells[0].reasons,
                ElementsAre(HasSubstr("cannot be applied: 0.01 mm needs a scan of known unit")));
    EXPECT_FALSE(first.tripped());
}

TEST(Comparison, FailedCells_AreFailedWithTheirReason) {
    RunDetails now = run_of_one(2, 0.5, {{"hausdorff", "+1 %", {}}});
    now.cells[0].outcome = Outcome::failed;
    now.cells[0].failure = {Cause::time, 0, "time limit exceeded: stopped after 3 s\n  in step 'surface'"};
    now.cells[0].outputs[0].moved_to = "/anywhere/out/a-default.ply.previous";
    Comparison comparison = compared(now, run_of_one(1, 0.5));
    EXPECT_EQ(comparison.verdict, Verdict::failed);
    EXPECT_FALSE(comparison.tripped());
    EXPECT_THAT(comparison.cells[0].reasons, ElementsAre("time limit exceeded: stopped after 3 s"));
    EXPECT_THAT(comparison.cells[0].moved, ElementsAre("a-default.ply.previous"));
    RunDetails before = run_of_one(1, 0.5);
    before.cells[0].outcome = Outcome::failed;
    EXPECT_THAT(compared(now, before).cells[0].reasons, Contains("the cell failed in the accepted run, too"));
    const Comparison repaired = compared(run_of_one(2, 0.5), before);
    EXPECT_EQ(repaired.verdict, Verdict::improved);
    EXPECT_THAT(repaired.cells[0].reasons, ElementsAre("the cell failed in the accepted run"));
}

TEST(Comparison, DoubtfulCells_AreDoubtfulUnlessTheyRegress) {
    RunDetails now = run_of_one(2, 0.5, {{"hausdorff", "+1 %", {}}});
    now.cells[0].outcome = Outcome::doubtful;
    now.cells[0].doubts = {"alpha is 12 times the spacing"};
    EXPECT_EQ(compared(now, run_of_one(1, 0.5)).verdict, Verdict::doubtful);
    EXPECT_THAT(compare(now, nullptr).cells[0].reasons, ElementsAre("alpha is 12 times the spacing"));
    EXPECT_EQ(compared(now, run_of_one(1, 0.9)).verdict, Verdict::doubtful) << "improved, but doubtful";
    EXPECT_EQ(compared(now, run_of_one(1, 0.1)).verdict, Verdict::regressed);
}

TEST(Comparison, NewAndMissingCells_AreNeverDropped) {
    RunDetails before = made_run(1), now = made_run(2, {{"hausdorff", "+1 %", {}}});
    add_cell(before, "jobs/scans/a.ply");
    add_cell(before, "jobs/scans/old name.ply");
    add_cell(now, "jobs/scans/a.ply");
    add_cell(now, "jobs/scans/new name.ply");
    add_cell(now, "jobs/scans/a.ply", "another variant");
    const Comparison comparison = compared(now, before);
    ASSERT_THAT(comparison.cells, SizeIs(4));
    EXPECT_EQ(comparison.cells[0].verdict, Verdict::passed);
    EXPECT_EQ(comparison.cells[1].verdict, Verdict::is_new);
    EXPECT_EQ(comparison.cells[2].verdict, Verdict::is_new);
    EXPECT_EQ(comparison.cells[3].verdict, Verdict::missing);
    EXPECT_EQ(comparison.cells[3].scan, "scans/old name.ply");
    EXPECT_EQ(comparison.verdict, Verdict::missing);
    EXPECT_TRUE(comparison.tripped());
}

TEST(Comparison, CellsThatDidNotRun_AreMissing) {
    RunDetails now = run_of_one(2, 0.5);
    now.cells[0].outcome = Outcome::skipped;
    const Comparison comparison = compared(now, run_of_one(1, 0.5));
    EXPECT_EQ(comparison.cells[0].verdict, Verdict::missing);
    EXPECT_TRUE(comparison.tripped());
}

TEST(Comparison, TheWorkingFolder_DoesNotMatter) {
    const auto run = [](const std::string& file, const std::string& scan) {
        RunDetails made = made_run(1);
        made.start.file = file;
        add_cell(made, scan);
        return made;
    };
    const RunDetails here = run("nightly.yaml", "scans/a.ply");
    for (const RunDetails& other :
         {run("jobs/nightly.yaml", "jobs/scans/a.ply"),
          run("/home/ann/jobs/nightly.yaml", "/home/ann/jobs/scans/a.ply"), run("./nightly.yaml", "scans/a.ply"),
          run("../jobs/nightly.yaml", "../jobs/scans/a.ply")}) {
        EXPECT_EQ(compared(other, here).verdict, Verdict::passed) << other.start.file;
        EXPECT_EQ(compared(here, other).cells[0].scan, "scans/a.ply");
    }
    EXPECT_EQ(compared(run("jobs/nightly.yaml", "library/a.ply"), run("nightly.yaml", "../library/a.ply")).verdict,
              Verdict::passed);
    EXPECT_EQ(compared(run("/jobs/nightly.yaml", "/data/a.ply"), run("nightly.yaml", "/data/a.ply")).verdict,
              Verdict::passed);
    EXPECT_EQ(compared(run("a/nightly.yaml", "ab/a.ply"), run("a/nightly.yaml", "a/a.ply")).verdict, Verdict::missing);
    RunDetails list = run("jobs/nightly.yaml", "compare");
    EXPECT_EQ(compared(list, run("nightly.yaml", "compare")).verdict, Verdict::passed)
        << "a workflow over a list of scans";
}

TEST(Comparison, Cells_AreInTheOrderOfThePlan) {
    RunDetails run = made_run(1);
    for (const char* scan : {"jobs/b.ply", "jobs/a.ply"})
        for (const char* variant : {"fine", "coarse"}) add_cell(run, scan, variant);
    std::ranges::reverse(run.cells);  // as they may end
    std::vector<std::string> order;
    for (const CellComparison& cell : compare(run, nullptr).cells) order.push_back(cell.scan + " " + cell.variant);
    EXPECT_THAT(order, ElementsAre("b.ply fine", "b.ply coarse", "a.ply fine", "a.ply coarse"));
}

TEST(Comparison, EqualCells_AreMatchedInTheirOrder) {
    RunDetails before = made_run(1), now = made_run(2, {{"hausdorff", "exact", {}}});
    for (RunDetails* run : {&before, &now})
        for (const double hausdorff : {1.0, 2.0}) add_cell(*run, "jobs/a.ply", "default", hausdorff);
    EXPECT_EQ(compared(now, before).verdict, Verdict::passed);
    add_cell(before, "jobs/a.ply", "default", 3);
    EXPECT_EQ(compared(now, before).count(Verdict::missing), 1u);
}

TEST(Comparison, ChangedHashes_AreListedAndTripOnlyByTheirRule) {
    RunDetails now = run_of_one(2, 0.5);
    now.cells[0].outputs[0].sha256 = "bbbb";
    const Comparison listed = compared(now, run_of_one(1, 0.5));
    EXPECT_EQ(listed.verdict, Verdict::passed);
    ASSERT_THAT(listed.cells[0].outputs, SizeIs(1));
    EXPECT_EQ(listed.cells[0].outputs[0].file, "a.ply-default.ply");
    EXPECT_THAT(what_changed(listed), SizeIs(1));
    now.start.gate = {{"outputs", "exact"}};
    const Comparison tripped = compared(now, run_of_one(1, 0.5));
    EXPECT_EQ(tripped.verdict, Verdict::regressed);
    EXPECT_THAT(tripped.cells[0].reasons, ElementsAre("the output a.ply-default.ply changed"));
    now.cells[0].outputs.clear();
    EXPECT_THAT(compared(now, run_of_one(1, 0.5)).cells[0].reasons,
                ElementsAre("the output a.ply-default.ply is gone"));
    RunDetails more = run_of_one(2, 0.5, {{"outputs", "exact", {}}}), fewer = run_of_one(1, 0.5);
    fewer.cells[0].outputs.clear();
    EXPECT_EQ(compared(more, fewer).verdict, Verdict::passed) << "a further output is listed";
    RunDetails unhashed = run_of_one(1, 0.5);
    unhashed.cells[0].outputs[0].sha256.clear();
    EXPECT_EQ(compared(more, unhashed).verdict, Verdict::failed) << "records of an older version have no hashes";
}

std::vector<PastCosts> pool(std::size_t size, double seconds = 1) {
    std::vector<double> each;
    for (std::size_t i = 0; i < size; ++i) each.push_back(seconds * (1 + 0.001 * static_cast<double>(i)));
    return {{"compare", "jobs/scans/a.ply", "default", passes(each)}};
}

Comparison with_costs(const std::vector<double>& seconds, std::size_t pool_size, const std::string& cost = "seconds") {
    RunDetails now = run_of_one(5, 0.5, {{cost, "+20 %", {}}});
    now.cells[0].costs = passes(seconds);
    return compared(now, run_of_one(1, 0.5), pool(pool_size));
}

TEST(Comparison, Costs_TripAboveTheFloor) {
    EXPECT_EQ(with_costs({2, 2.1, 2.2}, 20).verdict, Verdict::regressed);
    EXPECT_EQ(with_costs({1.1, 1.1, 1.1}, 20).verdict, Verdict::passed);
    EXPECT_EQ(with_costs({0.5, 0.5, 0.6}, 20).verdict, Verdict::improved);
    EXPECT_EQ(with_costs({1, 9, 1}, 20).verdict, Verdict::passed) << "a blip in one pass";
    EXPECT_EQ(with_costs({1.3, 1.3, 1.3}, 3).verdict, Verdict::passed) << "a small pool doubles the floor";
    EXPECT_EQ(with_costs({1.5, 1.5, 1.5}, 3).verdict, Verdict::regressed);
    EXPECT_EQ(with_costs({2, 2, 2}, 0).verdict, Verdict::passed) << "nothing to compare with";
    EXPECT_EQ(with_costs({2, 2, 2}, 20, "cpu-seconds").verdict, Verdict::regressed);
    EXPECT_EQ(with_costs({2, 2, 2}, 20, "memory").verdict, Verdict::passed);
    const Comparison tripped = with_costs({2, 2.1, 2.2}, 20);
    ASSERT_THAT(tripped.cells[0].costs, SizeIs(3)) << "all costs are listed";
    EXPECT_EQ(tripped.cells[0].costs[0].probability, 1.0 / 1771);
    EXPECT_THAT(tripped.cells[0].reasons,
                ElementsAre(HasSubstr("seconds is 2.08 times the median of 20 earlier passes")));
}

TEST(Comparison, TimeSpentWaiting_NeedsMore) {
    RunDetails now = run_of_one(5, 0.5, {{"seconds", "+20 %", {}}});
    now.cells[0].costs = passes({1.5, 1.5, 1.5});
    EXPECT_EQ(compared(now, run_of_one(1, 0.5), pool(20)).verdict, Verdict::regressed);
    for (CostRecord& pass : now.cells[0].costs) pass.cpu_seconds = 1;
    EXPECT_EQ(compared(now, run_of_one(1, 0.5), pool(20)).verdict, Verdict::passed);
    for (CostRecord& pass : now.cells[0].costs) pass.seconds = 2;
    EXPECT_EQ(compared(now, run_of_one(1, 0.5), pool(20)).verdict, Verdict::regressed);
}

TEST(Comparison, CachedCells_HaveNoCosts) {
    RunDetails now = run_of_one(5, 0.5, {{"seconds", "+20 %", {}}});
    const Comparison comparison = compared(now, run_of_one(1, 0.5), pool(20));
    EXPECT_EQ(comparison.verdict, Verdict::passed);
    EXPECT_THAT(comparison.notes, Contains(HasSubstr("run without the cache")));
}

TEST(Comparison, UnknownMemory_IsNotCompared) {
    RunDetails now = run_of_one(5, 0.5, {{"memory", "+20 %", {}}});
    now.cells[0].costs = passes({1, 1, 1});
    for (CostRecord& pass : now.cells[0].costs) pass.peak_memory = 0;
    EXPECT_EQ(compared(now, run_of_one(1, 0.5), pool(20)).verdict, Verdict::passed);
}

TEST(Comparison, AnotherMachine_IsSaidAndComparesMetrics) {
    RunDetails now = run_of_one(2, 0.9, {{"hausdorff", "+1 %", {}}});
    now.start.machine = "another box";
    now.start.version = "0.2.0";
    const Comparison comparison = compared(now, run_of_one(1, 0.5));
    EXPECT_EQ(comparison.verdict, Verdict::regressed);
    EXPECT_THAT(comparison.notes,
                AllOf(Contains(HasSubstr("the machine changed")), Contains("Scanmill 0.1.0 → 0.2.0")));
    now.start.machine = "a box";
    now.start.jobs = 2;
    EXPECT_THAT(compared(now, run_of_one(1, 0.5)).notes, Contains(HasSubstr("jobs 1 → 2")));
}

TEST(Comparison, Causes_NameWhatDiffersBeforeTheResult) {
    RunDetails now = run_of_one(2, 0.9, {{"hausdorff", "+1 %", {}}});
    StepRecord& surface = step_of(now, now.cells[0], "surface");
    surface.authored = {{"bin-size", "2 %diag"}};
    surface.filter_version = 4;
    step_of(now, now.cells[0], "read").plan_key = "another file";
    const Comparison comparison = compared(now, run_of_one(1, 0.5));
    EXPECT_THAT(comparison.cells[0].causes,
                ElementsAre("read: the file changed", "sculpt 3 → 4", "surface: bin-size 1 %diag → 2 %diag"));
    EXPECT_THAT(comparison.filters, ElementsAre("sculpt 3 → 4"));
}

TEST(Comparison, StepsThatCameOrWent_AreCauses) {
    RunDetails now = run_of_one(2, 0.9, {{"hausdorff", "+1 %", {}}});
    step_of(now, now.cells[0], "surface").label = "solid";
    EXPECT_THAT(compared(now, run_of_one(1, 0.5)).cells[0].causes,
                ElementsAre("the step solid is new", "the step surface is gone"));
}

TEST(Comparison, Changes_AreSortedByEffectSizeAndConfidence) {
    RunDetails before = made_run(1), now = made_run(2, {{"hausdorff", "+1 %", {}}, {"seconds", "+20 %", {}}});
    add_cell(before, "jobs/a.ply", "default", 1);
    add_cell(before, "jobs/b.ply", "default", 1);
    add_cell(before, "jobs/c.ply", "default", 1);
    add_cell(now, "jobs/a.ply", "default", 1.5);
    add_cell(now, "jobs/b.ply", "default", 3);
    add_cell(now, "jobs/c.ply", "default", 0.2).costs = passes({2, 2, 2});
    now.cells[0].outputs[0].sha256 = "bbbb";
    const Comparison comparison =
        compared(now, before, {{"compare", "jobs/c.ply", "default", passes({1, 1, 1, 1, 1, 1, 1, 1, 1, 1})}});
    std::vector<std::string> order;
    for (const RankedChange& change : what_changed(comparison))
        order.push_back(change.cell->scan + " " +
                        (change.metric   ? change.metric->metric
                         : change.output ? "output"
                                         : change.cost->cost));
    EXPECT_THAT(order,
                ElementsAre("b.ply hausdorff", "c.ply seconds", "a.ply hausdorff", "c.ply hausdorff", "a.ply output"));
    EXPECT_EQ(comparison.cells[2].verdict, Verdict::regressed) << "better in a metric, but slower";
}

TEST(Comparison, NoGate_ListsAndTripsOnlyOnMissingCells) {
    EXPECT_EQ(compared(run_of_one(2, 99), run_of_one(1, 0.5)).verdict, Verdict::passed);
    EXPECT_TRUE(compared(made_run(2), run_of_one(1, 0.5)).tripped());
    EXPECT_EQ(compared(made_run(2), made_run(1)).verdict, Verdict::passed);
}

TEST(ChosenMetric, DefaultsToTheFirstRuleThenMeasurementThenSeconds) {
    const Comparison gated = compare(run_of_one(1, 0.5, {{"seconds", "+9 %", {}}, {"genus", "exact", {}}}), nullptr);
    EXPECT_EQ(default_metric(gated), "genus");
    EXPECT_EQ(default_metric(compare(run_of_one(1, 0.5), nullptr)), "hausdorff");
    EXPECT_EQ(default_metric(compare(made_run(1), nullptr)), "seconds");
    EXPECT_EQ(number_of(gated.cells[0], "genus")->metric.value, 1);
    EXPECT_EQ(number_of(gated.cells[0], "surface.flips")->metric.value, 12);
    EXPECT_EQ(number_of(gated.cells[0], "seconds")->metric.value, 1.5) << "the cell's, without passes";
    EXPECT_FALSE(number_of(gated.cells[0], "memory") || number_of(gated.cells[0], "nonsense"));
    EXPECT_THAT(metric_names(gated), AllOf(Contains("seconds"), Contains("hausdorff"), Contains("surface.flips")));
}

}  // namespace
}  // namespace scanmill::test
