// SPDX-License-Identifier: GPL-3.0-or-later
// one-of and sweep span variants, and variants share what they have in common.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scanmill/plan/plan.hpp"
#include "support/declared_filters.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class Variants : public testing::Test {
protected:
    Plan plan(const std::string& steps, const Settings& settings = {},
              const std::string& head = "inputs: {scan: points}\n") {
        Diagnostics diagnostics("w");
        Plan result = make_plan(parse_workflow("scanmill: 1\n" + head + "steps:\n" + steps, diagnostics), library_,
                                settings, diagnostics);
        findings_.clear();
        for (const Diagnostic& diagnostic : diagnostics.sorted()) findings_ += text(diagnostic, "w") + "\n";
        return result;
    }
    static std::vector<std::string> names(const Plan& plan) {
        std::vector<std::string> result;
        for (const PlannedVariant& variant : plan.variants) result.push_back(variant.name);
        return result;
    }
    static std::vector<std::string> labels(const Plan& plan, std::size_t variant) {
        std::vector<std::string> result;
        for (const std::size_t step : plan.variants[variant].steps) result.push_back(plan.steps[step].label);
        return result;
    }

    test::DeclaredFilters filters_;
    FilterLibrary library_ = filters_.library();
    std::string findings_;
};

TEST_F(Variants, WithoutForks_ThereIsOneCalledDefault) {
    EXPECT_THAT(names(plan("  - thin:\n")), ElementsAre("default"));
}

TEST_F(Variants, OneOf_GivesOnePerAlternativeNamedByFilterOrId) {
    const Plan found =
        plan("  - one-of:\n      - thin:\n      - id: two\n        thin: {count: 2}\n  - tetrahedralise:\n");
    EXPECT_EQ(findings_, "");
    EXPECT_THAT(names(found), ElementsAre("thin", "two"));
    EXPECT_THAT(labels(found, 0), ElementsAre("thin", "tetrahedralise"));
    EXPECT_THAT(labels(found, 1), ElementsAre("two", "tetrahedralise"));
    EXPECT_EQ(found.steps.size(), 4u);
}

TEST_F(Variants, AlternativeOfSeveralSteps_HasItsName) {
    const Plan found = plan(
        "  - one-of:\n      - thin:\n      - name: twice\n        steps:\n          - thin: {count: 2}\n"
        "          - id: second\n            thin: {count: 3}\n  - tetrahedralise:\n");
    EXPECT_EQ(findings_, "");
    EXPECT_THAT(names(found), ElementsAre("thin", "twice"));
    EXPECT_THAT(labels(found, 1), ElementsAre("thin", "second", "tetrahedralise"));
    plan("  - one-of:\n      - [{thin: }, {pair: }]\n");
    EXPECT_THAT(findings_, HasSubstr("an alternative of several steps needs a name"));
}

TEST_F(Variants, OneOfInsideAnAlternative_Multiplies) {
    const Plan found = plan(
        "  - one-of:\n      - make:\n      - name: fork\n        steps:\n          - one-of: [{thin: }, {id: b, thin: "
        "{count: 2}}]\n");
    EXPECT_EQ(findings_, "");
    EXPECT_THAT(names(found), ElementsAre("make", "fork+thin", "fork+b"));
}

TEST_F(Variants, Sweep_IsNamedByParameterAndValueSafeInFileNames) {
    const Plan found = plan("  - thin: {size: {sweep: [0.1 %diag, 5 u]}}\n");
    EXPECT_EQ(findings_, "");
    EXPECT_THAT(names(found), ElementsAre("size=0.1pctdiag", "size=5u"));
}

TEST_F(Variants, AlternativesAndSweeps_AreJoinedFirstForkSlowest) {
    const Plan found = plan(
        "  - one-of: [{thin: }, {id: b, thin: {count: 2}}]\n  - tetrahedralise:\n  - solid: {coverage: {sweep: [99 %, "
        "100 %]}}\n");
    EXPECT_THAT(names(found),
                ElementsAre("thin+coverage=99pct", "thin+coverage=100pct", "b+coverage=99pct", "b+coverage=100pct"));
    // thin, b, a tetrahedralise below each, two solids below each of those
    EXPECT_EQ(found.steps.size(), 8u);
}

TEST_F(Variants, StepsAfterASweepThatDoNotDependOnIt_AreShared) {
    const Plan found = plan("  - thin: {count: {sweep: [1, 2]}}\n  - pair:\n    in: {points: scan}\n");
    EXPECT_THAT(names(found), ElementsAre("count=1", "count=2"));
    EXPECT_EQ(found.steps.size(), 3u);
}

TEST_F(Variants, SweptWorkflowParameter_IsChosenOncePerVariant) {
    const Plan found = plan("  - thin: {count: $n}\n  - id: again\n    thin: {count: $n}\n", {},
                            "inputs: {scan: points}\nparameters: {n: {sweep: [1, 2, 3]}}\n");
    EXPECT_EQ(findings_, "");
    EXPECT_THAT(names(found), ElementsAre("n=1", "n=2", "n=3"));
    for (const PlannedVariant& variant : found.variants)
        EXPECT_EQ(canonical_text(*found.steps[variant.steps[0]].parameters.find("count")),
                  canonical_text(*found.steps[variant.steps[1]].parameters.find("count")));
}

TEST_F(Variants, SettingsReplaceDefaultsAndMaySweep) {
    Diagnostics none("--set");
    const Settings settings{{"n", parse_value_expression("{sweep: [4, 5]}", none)}};
    EXPECT_THAT(names(plan("  - thin: {count: $n}\n", settings, "inputs: {scan: points}\nparameters: {n: 1}\n")),
                ElementsAre("n=4", "n=5"));
    plan("  - thin: {count: 1}\n", settings);
    EXPECT_THAT(findings_, HasSubstr("no parameter 'n'"));
}

TEST_F(Variants, TwoSweepsOfOneParameterName_TellWhoseTheyAre) {
    const Plan found = plan("  - thin: {count: {sweep: [1, 2]}}\n  - id: b\n    thin: {count: {sweep: [3, 4]}}\n");
    EXPECT_THAT(names(found),
                ElementsAre("count=1+b.count=3", "count=1+b.count=4", "count=2+b.count=3", "count=2+b.count=4"));
}

TEST_F(Variants, EqualNames_AreAnError) {
    plan("  - one-of: [{thin: {count: 1}}, {thin: {count: 2}}]\n");
    EXPECT_THAT(findings_, AllOf(HasSubstr("two variants are called 'thin'"), HasSubstr("add `id:`")));
    const Plan found = plan("  - one-of: [{thin: {count: 1}}, {id: thin-2, thin: {count: 2}}]\n");
    EXPECT_EQ(findings_, "") << "the way out leads out";
    EXPECT_THAT(names(found), ElementsAre("thin", "thin-2"));
    plan("  - one-of: [{name: a, steps: [{thin: {count: 1}}]}, {name: a, steps: [{thin: {count: 2}}]}]\n");
    EXPECT_THAT(findings_, AllOf(HasSubstr("two variants are called 'a'"), HasSubstr("`name:`")));
    plan("  - thin: {count: {sweep: [1, 2, 1]}}\n");
    EXPECT_THAT(findings_, AllOf(HasSubstr("two variants are called 'count=1'"), HasSubstr("sweep")));
}

TEST_F(Variants, IdOfAOneOf_StandsForWhicheverAlternativeRan) {
    const Plan found = plan(
        "  - id: x\n    one-of: [{thin: }, {name: two, steps: [{id: p, thin: {count: 2}}, {id: q, thin: {count: "
        "3}}]}]\n"
        "  - pair:\n  - tetrahedralise:\n    in: {points: x}\n");
    EXPECT_EQ(findings_, "");
    ASSERT_EQ(found.variants.size(), 2u);
    EXPECT_EQ(found.steps[found.variants[0].steps_by_name.at("x")].label, "thin");
    EXPECT_EQ(found.steps[found.variants[1].steps_by_name.at("x")].label, "q");
}

TEST_F(Variants, AMillionOfThem_IsRefused) {
    std::string steps;
    for (int i = 0; i < 6; ++i)
        steps += "  - id: s" + std::to_string(i) + "\n    thin: {count: {sweep: [1, 2, 3, 4, 5, 6, 7, 8, 9]}}\n";
    plan(steps);
    EXPECT_THAT(findings_, HasSubstr("more than 10000 variants"));
}

TEST_F(Variants, DollarDollar_IsATextThatBeginsWithADollar) {
    Diagnostics none("v");
    const ValueExpression value = parse_value_expression("$$x", none);
    ASSERT_EQ(value.values.size(), 1u);
    EXPECT_EQ(value.values[0].literal.items[0], "$x");
    EXPECT_TRUE(value.values[0].uses.empty());
}

TEST_F(Variants, Wiring_TakesTheNearestEarlierValueOfTheKind) {
    const Plan found =
        plan("  - id: first\n    thin:\n  - tetrahedralise:\n  - id: second\n    thin: {count: 2}\n  - make:\n");
    EXPECT_EQ(findings_, "");
    EXPECT_EQ(describe(found, found.steps[1].inputs[0].sources[0]), "first");
    EXPECT_EQ(describe(found, found.steps[2].inputs[0].sources[0]), "first")
        << "points pass over a step that gives tets";
    EXPECT_TRUE(found.steps[3].inputs.empty()) << "an optional port without a candidate stays open";
}

TEST_F(Variants, StructureKey_IgnoresNamesOrderAndSpelling) {
    const Plan a =
        plan("  - thin: {count: 2, size: 1 u}\n  - tetrahedralise:\n  - solid: {angle: 180 deg, coverage: 50 %}\n");
    const Plan b = plan(
        "  - id: x\n    thin:\n      size: 1.0 u\n      count: 2\n  - tetrahedralise: {}\n  - solid: {coverage: "
        "0.5}\n");
    ASSERT_EQ(a.steps.size(), 3u);
    ASSERT_EQ(b.steps.size(), 3u);
    EXPECT_EQ(a.steps[0].structure_key, b.steps[0].structure_key);
    EXPECT_EQ(a.steps[1].structure_key, b.steps[1].structure_key);
    EXPECT_NE(a.steps[2].structure_key, b.steps[2].structure_key) << "180 deg is not the default of 40 deg";
}

}  // namespace
}  // namespace scanmill
