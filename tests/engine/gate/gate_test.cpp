// SPDX-License-Identifier: GPL-3.0-or-later
// The rules of a gate: what every form allows, what is refused, and their form in the records.

#include "scanmill/gate/gate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

const double unknown = std::numeric_limits<double>::quiet_NaN();

Tolerance of_length(std::string_view text, LengthUnit unit = LengthUnit::millimetre, double diagonal = 200) {
    return parse_tolerance(text, Unit::length, unit, diagonal);
}

TEST(GateTolerance, Sign_LeavesTheOtherDirectionFree) {
    const Tolerance rise = of_length("+1 %"), fall = of_length("-1 %"), both = of_length("1 %");
    EXPECT_TRUE(rise.may_fall && !rise.may_rise);
    EXPECT_TRUE(fall.may_rise && !fall.may_fall);
    EXPECT_FALSE(both.may_rise || both.may_fall);
    for (const Tolerance& each : {rise, fall, both}) {
        EXPECT_TRUE(each.is_relative);
        EXPECT_EQ(each.amount, 0.01);
    }
}

TEST(GateTolerance, Exact_AllowsNothing) {
    for (const Unit unit : {Unit::count, Unit::length, Unit::area, Unit::volume, Unit::angle, Unit::ratio,
                            Unit::seconds, Unit::number, Unit::boolean}) {
        const Tolerance exact = parse_tolerance("exact", unit, LengthUnit::unknown, unknown);
        EXPECT_FALSE(exact.may_rise || exact.may_fall || exact.is_relative);
        EXPECT_EQ(exact.amount, 0);
    }
}

TEST(GateTolerance, AbsoluteAmounts_AreInTheMetricsUnit) {
    EXPECT_EQ(of_length("+0.01 mm").amount, 0.01);
    EXPECT_EQ(of_length("+0.5 mm", LengthUnit::metre).amount, 0.0005);
    EXPECT_EQ(of_length("0.5 u", LengthUnit::unknown).amount, 0.5);
    EXPECT_EQ(of_length("1 %diag").amount, 2);
    EXPECT_FALSE(of_length("1 %diag").is_relative);
    EXPECT_EQ(of_length("+0 mm", LengthUnit::unknown).amount, 0) << "nothing needs no conversion";
    EXPECT_DOUBLE_EQ(parse_tolerance("+12 mm2", Unit::area, LengthUnit::centimetre, unknown).amount, 0.12);
    EXPECT_EQ(parse_tolerance("2 u3", Unit::volume, LengthUnit::unknown, unknown).amount, 2);
    EXPECT_EQ(parse_tolerance("180 deg", Unit::angle, LengthUnit::unknown, unknown).amount, std::numbers::pi);
    EXPECT_EQ(parse_tolerance("-2", Unit::count, LengthUnit::unknown, unknown).amount, 2);
    EXPECT_EQ(parse_tolerance("-0.01", Unit::ratio, LengthUnit::unknown, unknown).amount, 0.01);
    EXPECT_EQ(parse_tolerance("+0.25", Unit::number, LengthUnit::unknown, unknown).amount, 0.25);
    EXPECT_EQ(parse_tolerance("+2 min", Unit::seconds, LengthUnit::unknown, unknown).amount, 120);
}

TEST(GateTolerance, PercentOfARatio_IsAShareOfTheAcceptedValue) {
    const Tolerance tolerance = parse_tolerance("-1 %", Unit::ratio, LengthUnit::unknown, unknown);
    EXPECT_TRUE(tolerance.is_relative);
    EXPECT_EQ(tolerance.amount, 0.01);
}

TEST(GateTolerance, Blanks_AroundTheAmountAreFree) {
    EXPECT_EQ(of_length("+1%").amount, 0.01);
    EXPECT_EQ(of_length("+ 1 %").amount, 0.01);
    EXPECT_EQ(of_length("+0.01mm").amount, 0.01);
}

TEST(GateTolerance, WithoutUnit_IsRefused) {
    EXPECT_EQ(sentence_of([] { of_length("+1"); }), "'1' has no unit; expected +1 %, +0.01 mm, +0.1 %diag or exact");
    EXPECT_THAT(sentence_of([] { parse_tolerance("+1", Unit::area, LengthUnit::unknown, unknown); }),
                AllOf(HasSubstr("has no unit"), HasSubstr("mm2")));
    EXPECT_THAT(sentence_of([] { parse_tolerance("+1", Unit::volume, LengthUnit::unknown, unknown); }),
                AllOf(HasSubstr("has no unit"), HasSubstr("mm3")));
    EXPECT_THAT(sentence_of([] { parse_tolerance("1", Unit::angle, LengthUnit::unknown, unknown); }),
                AllOf(HasSubstr("has no unit"), HasSubstr("3 deg")));
    EXPECT_THAT(sentence_of([] { parse_tolerance("+1", Unit::seconds, LengthUnit::unknown, unknown); }),
                AllOf(HasSubstr("has no unit"), HasSubstr("+5 s")));
}

TEST(GateTolerance, AnotherDimension_IsRefused) {
    const auto refusal = [](std::string_view text, Unit unit) {
        return sentence_of([&] { parse_tolerance(text, unit, LengthUnit::millimetre, 1); });
    };
    EXPECT_EQ(refusal("+3 deg", Unit::length),
              "'deg' is not a unit of length; expected +1 %, +0.01 mm, +0.1 %diag or exact");
    EXPECT_THAT(refusal("+1 mm", Unit::area), HasSubstr("'1 mm' is not an area"));
    EXPECT_THAT(refusal("+1 mm2", Unit::volume), HasSubstr("is not a volume"));
    EXPECT_THAT(refusal("+1 mm", Unit::angle), HasSubstr("'mm' is not a unit of angle"));
    EXPECT_THAT(refusal("+1 mm", Unit::count), HasSubstr("'1 mm' is not a number; expected +1 %, +2 or exact"));
    EXPECT_THAT(refusal("+1 mm", Unit::ratio), HasSubstr("is not a number"));
    EXPECT_THAT(refusal("+1 mm", Unit::seconds), HasSubstr("is not a time"));
    EXPECT_EQ(refusal("1", Unit::boolean), "'1' cannot limit a metric that is true or false; expected exact");
    EXPECT_THAT(refusal("+1 %", Unit::boolean), EndsWith("expected exact"));
}

TEST(GateTolerance, NegativeAmountsAndNonsense_AreRefused) {
    for (const std::string text : {"+-1 %", "--1 mm", "++1 %", "-+2 %", "+ -1 %"})
        EXPECT_THAT(sentence_of([&] { of_length(text); }), AllOf(HasSubstr("has two signs"), HasSubstr("expected")))
            << text;
    for (const std::string text : {"", "+", "-", "- "})
        EXPECT_THAT(sentence_of([&] { of_length(text); }), HasSubstr("has no amount; expected")) << text;
    for (const std::string text : {"Exact", "exactly", "+exact", "%", "+ %", "nan %", "+inf %", "1e999 %", "+1 %%",
                                   "1 % 2", "1,5 %", "+1 % mm", "0x1 %", "some", "+nan mm", "+inf u", "+1 mm2", "\n"})
        EXPECT_THAT(sentence_of([&] { of_length(text); }), HasSubstr("; expected +1 %, +0.01 mm")) << text;
    for (const std::string text : {"nan", "+inf", "1e999", "two"})
        EXPECT_THAT(sentence_of([&] { parse_tolerance(text, Unit::count, LengthUnit::unknown, unknown); }),
                    HasSubstr("is not a number; expected +1 %, +2 or exact"))
            << text;
}

TEST(GateTolerance, LengthsThatCannotBeConverted_AreRefused) {
    const Error no_unit = error_of([] { of_length("+0.01 mm", LengthUnit::unknown); });
    EXPECT_THAT(no_unit.sentence(),
                AllOf(StartsWith("0.01 mm needs a scan of known unit"), testing::Not(HasSubstr("expected"))));
    EXPECT_THAT(no_unit.hint(), HasSubstr("declare it"));
    EXPECT_THAT(sentence_of([] { parse_tolerance("+1 mm2", Unit::area, LengthUnit::unknown, unknown); }),
                StartsWith("1 mm2 needs a scan of known unit"));
    EXPECT_THAT(sentence_of([] { of_length("0.1 %diag", LengthUnit::millimetre, unknown); }),
                HasSubstr("diagonal is nan"));
    EXPECT_THAT(sentence_of([] { of_length("3 spacing"); }),
                HasSubstr("the point spacing of the accepted run is not recorded"));
    EXPECT_THAT(sentence_of([] { parse_tolerance("3 spacing2", Unit::area, LengthUnit::metre, 1); }),
                HasSubstr("the point spacing of the accepted run is not recorded"));
}

TEST(GateRuleCheck, Direction_MustBeThatOfRegressions) {
    require_rule_fits("+1 %", Unit::length, Better::smaller);
    require_rule_fits("+0.01 mm", Unit::length, Better::smaller);
    require_rule_fits("+1 %diag", Unit::length, Better::smaller);
    require_rule_fits("-1 %", Unit::ratio, Better::larger);
    require_rule_fits("1 %", Unit::count, Better::neither);
    require_rule_fits("exact", Unit::boolean, Better::larger);
    require_rule_fits("= truth", Unit::count, Better::neither);
    require_rule_fits("= truth", Unit::length, Better::smaller);
    EXPECT_EQ(sentence_of([] { require_rule_fits("+1 %", Unit::ratio, Better::larger); }),
              "'+1 %' limits the wrong direction: larger is better; expected -1 % or exact");
    EXPECT_EQ(sentence_of([] { require_rule_fits("- 0.01 mm", Unit::length, Better::smaller); }),
              "'- 0.01 mm' limits the wrong direction: smaller is better; expected +0.01 mm or exact");
    EXPECT_EQ(sentence_of([] { require_rule_fits("1 %", Unit::length, Better::smaller); }),
              "'1 %' also limits improvements: smaller is better; expected +1 % or exact");
    EXPECT_THAT(sentence_of([] { require_rule_fits("+1", Unit::length, Better::smaller); }), HasSubstr("has no unit"));
}

TEST(GateRuleCheck, Costs_TakeAShareThatLeavesRoom) {
    EXPECT_TRUE(is_cost("seconds") && is_cost("cpu-seconds") && is_cost("memory"));
    EXPECT_FALSE(is_cost("outputs") || is_cost("hausdorff"));
    EXPECT_EQ(parse_cost_tolerance("+20 %").amount, 0.2);
    for (const char* text : {"20 %", "-20 %", "+5 s", "exact", "", "+1 GiB", "+20"})
        EXPECT_THAT(sentence_of([&] { parse_cost_tolerance(text); }),
                    HasSubstr("is not a limit of a cost; expected a share of the accepted costs, as +20 %"))
            << text;
    EXPECT_THAT(sentence_of([] { parse_cost_tolerance("+0 %"); }), HasSubstr("does not allow for noise"));
    EXPECT_THAT(sentence_of([] { parse_cost_tolerance("+x %"); }), HasSubstr("is not a ratio"));
}

}  // namespace
}  // namespace scanmill::test
