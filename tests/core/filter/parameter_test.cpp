// SPDX-License-Identifier: GPL-3.0-or-later
// How a written parameter becomes a value: every type, every refusal. Ranges, words and lists: parameter_form_test.cpp.

#include "scanmill/filter/parameter.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

ParameterSpec plain_spec(ParameterType type) {
    ParameterSpec spec;
    spec.name = "x";
    spec.type = type;
    if (type == ParameterType::choice) spec.choices = {{"minimum", ""}, {"quantile", ""}, {"adaptive", ""}};
    return spec;
}

ParameterValue read(ParameterType type, const std::string& text) { return parse(plain_spec(type), {{text}, false}); }
std::string refusal(ParameterType type, const std::string& text) {
    return sentence_of([&] { read(type, text); });
}
ParameterValue one(ParameterScalar value) { return value; }

TEST(ParameterType, EveryType_HasANameThatNamesIt) {
    using enum ParameterType;
    const std::vector<std::pair<ParameterType, std::string_view>> names{
        {boolean, "boolean"}, {integer, "integer"}, {number, "number"}, {choice, "choice"}, {text, "text"},
        {path, "path"},       {length, "length"},   {angle, "angle"},   {ratio, "ratio"}};
    for (const auto& [type, name] : names) {
        EXPECT_EQ(name_of(type), name);
        EXPECT_EQ(value_named<ParameterType>(name), type);
    }
    EXPECT_FALSE(value_named<ParameterType>("Length"));
    EXPECT_FALSE(value_named<ParameterType>(""));
}

TEST(ParameterParse, Boolean_IsTrueOrFalse) {
    EXPECT_EQ(read(ParameterType::boolean, "true"), one(true));
    EXPECT_EQ(read(ParameterType::boolean, "false"), one(false));
    for (const std::string text : {"yes", "True", "1", ""})
        EXPECT_EQ(refusal(ParameterType::boolean, text),
                  "'" + text + "' is neither true nor false; expected true or false");
}

TEST(ParameterParse, Integer_IsAWholeNumber) {
    EXPECT_EQ(read(ParameterType::integer, "-12"), one(std::int64_t(-12)));
    EXPECT_EQ(read(ParameterType::integer, "9223372036854775807"), one(std::numeric_limits<std::int64_t>::max()));
    for (const std::string text : {"1.5", "1e3", "", "twelve", "9223372036854775808", "5 ", "0x10"})
        EXPECT_EQ(refusal(ParameterType::integer, text),
                  "'" + text + "' is not a whole number; expected a whole number");
}

TEST(ParameterParse, Number_IsFinite) {
    EXPECT_EQ(read(ParameterType::number, "-1.5e3"), one(-1500.0));
    EXPECT_EQ(read(ParameterType::number, "7"), one(7.0));
    for (const std::string text : {"", "seven", "nan", "inf", "1e999", "7 mm"})
        EXPECT_EQ(refusal(ParameterType::number, text), "'" + text + "' is not a number; expected a number");
}

TEST(ParameterParse, Choice_IsOneOfItsNames) {
    EXPECT_EQ(read(ParameterType::choice, "quantile"), one(std::string("quantile")));
    EXPECT_EQ(refusal(ParameterType::choice, "mean"), "'mean' is not one of minimum, quantile and adaptive");
    EXPECT_EQ(refusal(ParameterType::choice, "quantil"),
              "'quantil' is not one of minimum, quantile and adaptive; did you mean 'quantile'?");
    EXPECT_EQ(refusal(ParameterType::choice, "Minimum"),
              "'Minimum' is not one of minimum, quantile and adaptive; did you mean 'minimum'?");
}

TEST(ParameterParse, TextAndPath_AreTakenAsTheyStand) {
    for (const ParameterType type : {ParameterType::text, ParameterType::path})
        for (const std::string text : {"", "a, b", "true", "scans/plate 1.ply", "é"})
            EXPECT_EQ(read(type, text), one(text));
}

TEST(ParameterParse, Quantities_AreReadWithTheirUnits) {
    EXPECT_EQ(read(ParameterType::length, "0.1 %diag"), one(Length::percent_of_diagonal(0.1)));
    EXPECT_EQ(read(ParameterType::angle, "40 deg"), one(Angle::degrees(40)));
    EXPECT_EQ(read(ParameterType::ratio, "5 %"), one(Ratio::percent(5)));
}

TEST(ParameterParse, QuantityWithoutItsUnit_IsToldTheRangeToo) {
    EXPECT_EQ(refusal(ParameterType::angle, "40"), "'40' has no unit; expected 40 deg or 0.7 rad");
    EXPECT_EQ(refusal(ParameterType::length, "x"),
              "'x' is not a length; expected 0.2 mm, 0.1 %diag, 3 spacing or 0.5 u");
    EXPECT_EQ(refusal(ParameterType::ratio, "x"), "'x' is not a ratio; expected 5 % or 0.05");
}

TEST(ParameterParse, ValueThatHoldsOurOwnWords_IsStillToldWhatWasExpected) {
    EXPECT_EQ(refusal(ParameterType::number, "expected"), "'expected' is not a number; expected a number");
}

TEST(ParameterText, Values_AreWrittenAsPeopleDo) {
    EXPECT_EQ(text(ParameterValue()), "");
    EXPECT_EQ(text(one(true)), "true");
    EXPECT_EQ(text(one(std::int64_t(-3))), "-3");
    EXPECT_EQ(text(one(0.1)), "0.1");
    EXPECT_EQ(text(one(Word{"auto"})), "auto");
    EXPECT_EQ(text(one(Length::percent_of_diagonal(0.1))), "0.1 %diag");
    EXPECT_EQ(text(one(Angle::degrees(40))), "40 deg");
    EXPECT_EQ(text(one(Ratio::percent(5))), "5 %");
    EXPECT_EQ(text(std::vector<ParameterScalar>{0.0, 0.1}), "[0, 0.1]");
    EXPECT_EQ(text(std::vector<ParameterScalar>{}), "[]");
}

TEST(CanonicalText, SameMeaning_HasTheSameText) {
    EXPECT_EQ(canonical_text(read(ParameterType::angle, "40 deg")),
              canonical_text(read(ParameterType::angle, "0.6981317007977318 rad")));
    EXPECT_EQ(canonical_text(read(ParameterType::ratio, "5 %")), canonical_text(read(ParameterType::ratio, "0.05")));
    EXPECT_EQ(canonical_text(read(ParameterType::number, "1e1")), canonical_text(read(ParameterType::number, "10.0")));
    EXPECT_EQ(canonical_text(read(ParameterType::integer, "007")), canonical_text(read(ParameterType::integer, "7")));
    EXPECT_EQ(canonical_text(read(ParameterType::length, "1.0mm")),
              canonical_text(read(ParameterType::length, "1 mm")));
}

TEST(CanonicalText, OtherMeaning_HasAnotherText) {
    const auto canonical = [](ParameterType type, const char* text) { return canonical_text(read(type, text)); };
    EXPECT_NE(canonical(ParameterType::angle, "40 deg"), canonical(ParameterType::angle, "40 rad"));
    EXPECT_NE(canonical(ParameterType::ratio, "5 %"), canonical(ParameterType::ratio, "5"));
    EXPECT_NE(canonical(ParameterType::length, "1 mm"), canonical(ParameterType::length, "1 u"));
    EXPECT_NE(canonical(ParameterType::length, "1 %diag"), canonical(ParameterType::length, "1 spacing"));
    EXPECT_NE(canonical(ParameterType::number, "0.1"), canonical(ParameterType::number, "0.10000000000000002"));
}

TEST(CanonicalText, TextWithACommaInAList_IsNotTwoTexts) {
    using Items = std::vector<ParameterScalar>;
    EXPECT_NE(canonical_text(Items{std::string("a, b")}), canonical_text(Items{std::string("a"), std::string("b")}));
    EXPECT_NE(canonical_text(Items{std::string("")}), canonical_text(Items{}));
    EXPECT_NE(canonical_text(Items{std::string("a, 1:b")}), canonical_text(Items{std::string("a"), std::string("b")}));
}

}  // namespace
}  // namespace scanmill::test
