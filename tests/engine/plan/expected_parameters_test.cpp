// SPDX-License-Identifier: GPL-3.0-or-later
// Workflow parameters as ends of the conditions under `expect`.

#include "engine/plan/workflow_findings.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class ExpectedParameters : public test::WorkflowFindings {
protected:
    /// A workflow whose step `thin` has this condition on `kept`; the condition begins at w:6:20.
    std::vector<std::string> kept(const std::string& parameters, const std::string& condition,
                                  const Settings& settings = {}) {
        return findings("scanmill: 1\ninputs: {scan: points}\nparameters: {" + parameters +
                            "}\nsteps:\n  - thin:\n    expect: {kept: " + condition + "}\n",
                        settings);
    }
    const PlannedExpectation& planned() const { return plan_.steps.back().expectations.front(); }
    static ParameterValue number(double value) { return ParameterScalar(value); }
    static Settings setting(const std::string& name, const std::string& value) {
        Diagnostics diagnostics("s");
        return {{name, parse_value_expression(value, diagnostics)}};
    }
};

TEST_F(ExpectedParameters, EveryForm_TakesTheParametersValue) {
    EXPECT_THAT(kept("least: 5", "$least"), IsEmpty());
    EXPECT_EQ(planned().relation, Expectation::Relation::equal);
    EXPECT_EQ(planned().low, number(5));
    EXPECT_THAT(kept("least: 5", "'> $least'"), IsEmpty());
    EXPECT_EQ(planned().relation, Expectation::Relation::above);
    EXPECT_EQ(planned().low, number(5));
    EXPECT_THAT(kept("least: 5", "<$least"), IsEmpty());
    EXPECT_EQ(planned().relation, Expectation::Relation::below);
    EXPECT_THAT(kept("least: 5, most: 9", "[$least, $most]"), IsEmpty());
    EXPECT_EQ(planned().low, number(5));
    EXPECT_EQ(planned().high, number(9));
    EXPECT_THAT(kept("most: 9", "[1, $most]"), IsEmpty());
    EXPECT_EQ(planned().low, number(1));
    EXPECT_EQ(planned().high, number(9));
}

TEST_F(ExpectedParameters, Text_ShowsTheValue) {
    kept("least: 5, most: 9", "[$least, $most]");
    EXPECT_EQ(planned().text, "kept in [5, 9]");
    kept("least: 5", "'> $least'");
    EXPECT_EQ(planned().text, "kept > 5");
}

TEST_F(ExpectedParameters, Settings_Apply) {
    EXPECT_THAT(kept("least: 5", "'> $least'", setting("least", "7")), IsEmpty());
    EXPECT_EQ(planned().low, number(7));
}

TEST_F(ExpectedParameters, ValueOfTheWrongForm_IsReportedAtTheCondition) {
    EXPECT_THAT(kept("least: many", "'> $least'"),
                ElementsAre(AllOf(StartsWith("w:6:14: "), HasSubstr("expect kept: 'many' is not"))));
    EXPECT_THAT(kept("least: 5, most: 4", "[$least, $most]"), ElementsAre(HasSubstr("the range [5, 4] is empty")));
}

TEST_F(ExpectedParameters, UndeclaredName_ProposesTheClosest) {
    EXPECT_THAT(
        kept("least: 5, n: 1", "[$n, $leest]"),
        ElementsAre(HasSubstr("no step uses the parameter 'least'"),
                    AllOf(StartsWith("w:6:"), HasSubstr("no parameter 'leest'"), HasSubstr("did you mean 'least'?"))));
}

TEST_F(ExpectedParameters, SweptParameter_IsAnError) {
    for (const char* condition : {"$least", "'< $least'", "[$least, 9]"}) {
        EXPECT_THAT(kept("least: {sweep: [4, 5]}", condition),
                    ElementsAre(AllOf(StartsWith("w:6:"), HasSubstr("expect kept: $least is swept"))))
            << condition;
        EXPECT_THAT(kept("least: 5", condition, setting("least", "{sweep: [4, 5]}")),
                    ElementsAre(HasSubstr("$least is swept")))
            << condition;
    }
}

TEST_F(ExpectedParameters, List_IsAnError) {
    EXPECT_THAT(kept("least: [4, 5]", "$least"),
                ElementsAre(AllOf(StartsWith("w:6:"), HasSubstr("expect kept: $least is a list"))));
}

TEST_F(ExpectedParameters, Dollars_AreAsInParameters) {
    EXPECT_THAT(kept("", "$$5"), ElementsAre(HasSubstr("'$5' is not")));
    EXPECT_THAT(kept("", "$"), ElementsAre(HasSubstr("'$' is not the name of a parameter")));
    EXPECT_THAT(kept("", "[1, $]"), ElementsAre(HasSubstr("'$' is not the name of a parameter")));
}

TEST_F(ExpectedParameters, VariantsThatShareTheStep_HaveOneCondition) {
    EXPECT_THAT(findings("scanmill: 1\ninputs: {scan: points}\nparameters: {least: 5}\nsteps:\n  - id: a\n    thin:\n"
                         "    expect: {kept: '> $least'}\n  - id: b\n    thin: {count: {sweep: [1, 2]}}\n"),
                IsEmpty());
    ASSERT_EQ(plan_.variants.size(), 2u);
    EXPECT_EQ(plan_.steps.front().expectations.size(), 1u);
}

}  // namespace
}  // namespace scanmill
