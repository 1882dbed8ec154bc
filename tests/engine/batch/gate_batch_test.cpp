// SPDX-License-Identifier: GPL-3.0-or-later
// `gate` of a batch: its rules, and those that nothing could meet or break.

#include "engine/batch/measuring_batches.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class GateOfABatch : public test::MeasuringBatches {
protected:
    /// In line 6.
    std::vector<std::string> gate(const std::string& rules) { return check(batch("measure:\ngate: " + rules + "\n")); }
};

TEST_F(GateOfABatch, RulesOfEveryForm_AreRead) {
    EXPECT_THAT(
        gate("{distance: +1 %, score: -1 %, score@2: -0.01, handles: exact, triangles: 3 %, alpha: +0.1 mm, "
             "measure-surface.distance: +0.5 %diag, outputs: exact, seconds: +20 %, memory: +50 %, repeats: 3}"),
        IsEmpty());
    ASSERT_TRUE(checked_.batch.gate);
    EXPECT_EQ(checked_.batch.gate->repeats, 3u);
    const std::vector<GateRule>& rules = checked_.batch.gate->rules;
    ASSERT_EQ(rules.size(), 10u);
    EXPECT_EQ(rules[0], (GateRule{"distance", "+1 %", {}}));
    EXPECT_EQ(rules[0].position, (Position{6, 8}));
    EXPECT_THAT(check(batch("measure:\n")), IsEmpty());
    EXPECT_FALSE(checked_.batch.gate);
}

TEST_F(GateOfABatch, MetricThatNothingHas_IsRefusedWithTheClosest) {
    EXPECT_THAT(gate("{distnace: +1 %}"), ElementsAre(AllOf(StartsWith("b:6:8: no step, measurement or output"),
                                                            HasSubstr("did you mean 'distance'?"))));
    EXPECT_THAT(gate("{surface.alpah: exact}"), ElementsAre(AllOf(HasSubstr("the step 'surface' has no metric 'alpah'"),
                                                                  HasSubstr("did you mean 'alpha'?"))));
    EXPECT_THAT(gate("{surfcae.alpha: exact}"), ElementsAre(AllOf(HasSubstr("no workflow has a step 'surfcae'"),
                                                                  HasSubstr("did you mean 'surface'?"))));
    EXPECT_THAT(gate("{surface: exact}"),
                ElementsAre(HasSubstr("'surface' is a step; expected one of its metrics, as surface.NAME")));
    EXPECT_THAT(gate("{second: +20 %}"), ElementsAre(HasSubstr("did you mean 'seconds'?")));
}

TEST_F(GateOfABatch, MeasuredMetricWhereNothingIsMeasured_IsRefused) {
    EXPECT_THAT(check(head + "gate: {distance: +1 %}\n"),
                ElementsAre("b:5:8: 'distance' is measured by 'compare', but the batch has no `measure:`"));
    EXPECT_THAT(check(head + "measure:\ngate: {distance: +1 %}\n"),
                ElementsAre(HasSubstr("no scan has a truth"),
                            AllOf(StartsWith("b:6:8: "), HasSubstr("no scan with a truth has a value to measure"))));
}

TEST_F(GateOfABatch, TextThatDoesNotFitTheMetric_IsRefused) {
    EXPECT_THAT(gate("{distance: +1}"), ElementsAre(AllOf(StartsWith("b:6:8: distance: "), HasSubstr("unit"))));
    EXPECT_THAT(gate("{distance: small}"), ElementsAre(StartsWith("b:6:8: distance: ")));
    EXPECT_THAT(gate("{distance: 1 %}"),
                ElementsAre(AllOf(HasSubstr("smaller is better"), HasSubstr("expected +1 %"))));
    EXPECT_THAT(gate("{score: +1 %}"), ElementsAre(AllOf(HasSubstr("larger is better"), HasSubstr("expected -1 %"))));
    EXPECT_THAT(gate("{outputs: +1 %}"), ElementsAre(HasSubstr("expected exact")));
    EXPECT_THAT(gate("{seconds: -1 %}"), ElementsAre(HasSubstr("+20 %")));
    EXPECT_THAT(gate("{seconds: +1 s}"), ElementsAre(HasSubstr("+20 %")));
    EXPECT_THAT(gate("{distance: [1 %]}"), ElementsAre(HasSubstr("expected a tolerance, as +1 %")));
}

TEST_F(GateOfABatch, RuleOfTheTruth_IsRefusedForMetricsThatATruthDoesNotHave) {
    EXPECT_THAT(gate("{handles: '= truth'}"),
                ElementsAre(AllOf(StartsWith("b:6:8: handles: "), HasSubstr("'truth-handles'"), HasSubstr("exact"))));
    EXPECT_THAT(gate("{measure-surface.handles: '= truth'}"), ElementsAre(HasSubstr("'truth-handles'")));
    EXPECT_THAT(gate("{seconds: '= truth'}"), ElementsAre(HasSubstr("+20 %")));
    EXPECT_THAT(gate("{outputs: '= truth'}"), ElementsAre(HasSubstr("expected exact")));
}

TEST_F(GateOfABatch, Repeats_AreOneToTwenty) {
    const auto repeats = [&](const std::string& text) { return gate("{seconds: +20 %, repeats: " + text + "}"); };
    EXPECT_THAT(repeats("20"), IsEmpty());
    EXPECT_THAT(repeats("0"),
                ElementsAre(AllOf(StartsWith("b:6:33: repeats: 0 is out of range"), HasSubstr("at least 1"))));
    EXPECT_THAT(repeats("21"), ElementsAre(HasSubstr("repeats: 21 is out of range")));
    EXPECT_THAT(repeats("x"), ElementsAre(HasSubstr("'x' is not a whole number")));
    EXPECT_THAT(gate("{handles: exact, repeats: 3}"), ElementsAre(HasSubstr("warning: `repeats` has no effect")));
}

TEST_F(GateOfABatch, WithoutRules_IsRefused) {
    EXPECT_THAT(gate("{}"), ElementsAre(AllOf(StartsWith("b:6:1: the gate has no rules"))));
    EXPECT_THAT(gate("{repeats: 3}"), ElementsAre(HasSubstr("the gate has no rules")));
    EXPECT_THAT(gate("strict"), ElementsAre(HasSubstr("expected a map from metrics to tolerances")));
    EXPECT_THAT(gate(""), ElementsAre(HasSubstr("expected a map from metrics to tolerances")));
}

/// The steps that would have the metric are unknown then.
TEST_F(GateOfABatch, BesideAWorkflowWithErrors_IsNotBlamed) {
    folder_.write("w.yaml", "scanmill: 1\ninputs: {scan: points}\nsteps: [{sollid: }]\n");
    EXPECT_THAT(gate("{distance: +1 %}"), ElementsAre(HasSubstr("there is no filter 'sollid'")));
}

}  // namespace
}  // namespace scanmill
