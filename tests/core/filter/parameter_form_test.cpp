// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges, words, lists, and the round trip through the written form.

#include <gtest/gtest.h>

#include "scanmill/filter/parameter.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using Type = ParameterType;
using Texts = std::vector<std::string>;

ParameterSpec spec_of(ParameterType type, std::optional<Bound> low = {}, std::optional<Bound> high = {}) {
    ParameterSpec spec;
    spec.name = "x";
    spec.type = type;
    spec.low = low;
    spec.high = high;
    return spec;
}
ParameterSpec list_of(ParameterType type, std::optional<std::size_t> size = {}) {
    ParameterSpec spec = spec_of(type);
    spec.list = true;
    spec.size = size;
    return spec;
}

ParameterValue read(const ParameterSpec& spec, const std::string& text) { return parse(spec, {{text}, false}); }
ParameterValue read_list(const ParameterSpec& spec, Texts items) { return parse(spec, {std::move(items), true}); }
std::string refusal(const ParameterSpec& spec, const std::string& text) {
    return sentence_of([&] { read(spec, text); });
}

constexpr Bound including(double value) { return {value, true}; }
constexpr Bound excluding(double value) { return {value, false}; }

TEST(ParameterRange, InclusiveBounds_BelongToTheRange) {
    const ParameterSpec spec = spec_of(Type::integer, including(1), including(9));
    EXPECT_NO_THROW(read(spec, "1"));
    EXPECT_NO_THROW(read(spec, "9"));
    EXPECT_EQ(refusal(spec, "0"), "0 is out of range; expected a whole number of at least 1 and at most 9");
    EXPECT_EQ(refusal(spec, "10"), "10 is out of range; expected a whole number of at least 1 and at most 9");
}

TEST(ParameterRange, ExclusiveBounds_DoNot) {
    const ParameterSpec spec = spec_of(Type::number, excluding(0), excluding(1));
    EXPECT_NO_THROW(read(spec, "1e-300"));
    EXPECT_NO_THROW(read(spec, "0.9999999999999999"));
    EXPECT_EQ(refusal(spec, "0"), "0 is out of range; expected a number above 0 and below 1");
    EXPECT_EQ(refusal(spec, "-0"), "-0 is out of range; expected a number above 0 and below 1");
    EXPECT_EQ(refusal(spec, "1"), "1 is out of range; expected a number above 0 and below 1");
}

TEST(ParameterRange, OneBound_LeavesTheOtherSideOpen) {
    EXPECT_NO_THROW(read(spec_of(Type::number, including(-2)), "1e300"));
    EXPECT_EQ(refusal(spec_of(Type::number, including(-2)), "-2.5"),
              "-2.5 is out of range; expected a number of at least -2");
    EXPECT_NO_THROW(read(spec_of(Type::number, {}, excluding(5)), "-1e300"));
    EXPECT_EQ(refusal(spec_of(Type::number, {}, excluding(5)), "5"), "5 is out of range; expected a number below 5");
    EXPECT_EQ(refusal(spec_of(Type::number, {}, including(5)), "6"),
              "6 is out of range; expected a number of at most 5");
}

TEST(ParameterRange, Lengths_AreComparedAsWritten) {
    const ParameterSpec spec = spec_of(Type::length, excluding(0));
    EXPECT_NO_THROW(read(spec, "0.001 um"));
    EXPECT_EQ(refusal(spec, "0 mm"),
              "0 mm is out of range; expected a length above 0, as 0.2 mm, 0.1 %diag, 3 spacing or 0.5 u");
    EXPECT_EQ(refusal(spec, "-1 %diag").substr(0, 23), "-1 %diag is out of rang");
}

TEST(ParameterRange, Angles_AreComparedInDegrees) {
    const ParameterSpec spec = spec_of(Type::angle, including(0), including(180));
    EXPECT_NO_THROW(read(spec, "180 deg"));
    EXPECT_NO_THROW(read(spec, "3.14 rad"));
    EXPECT_EQ(refusal(spec, "4 rad"),
              "4 rad is out of range; expected an angle of at least 0 deg and at most 180 deg, as 40 deg or 0.7 rad");
}

TEST(ParameterRange, Ratios_AreComparedAsFractions) {
    const ParameterSpec spec = spec_of(Type::ratio, excluding(0), including(1));
    EXPECT_NO_THROW(read(spec, "100 %"));
    EXPECT_NO_THROW(read(spec, "1"));
    EXPECT_EQ(refusal(spec, "101 %"), "101 % is out of range; expected a ratio above 0 and at most 1, as 5 % or 0.05");
    EXPECT_EQ(refusal(spec, "5"), "5 is out of range; expected a ratio above 0 and at most 1, as 5 % or 0.05");
}

TEST(ParameterRange, EveryItemOfAList_IsCompared) {
    ParameterSpec spec = list_of(Type::number);
    spec.low = including(0);
    EXPECT_NO_THROW(read_list(spec, {"0", "3"}));
    EXPECT_EQ(sentence_of([&] {
                  read_list(spec, {"0", "-3", "-4"});
              }),
              "-3 is out of range; expected a list of values, each a number of at least 0");
}

TEST(RequireInRange, Values_AreCheckedAsParsedOnesAre) {
    const ParameterSpec spec = spec_of(Type::number, including(0));
    EXPECT_NO_THROW(require_in_range(spec, ParameterScalar(0.0)));
    EXPECT_THROW(require_in_range(spec, ParameterScalar(-1.0)), Error);
    EXPECT_THROW(require_in_range(spec, std::vector<ParameterScalar>{1.0, -1.0}), Error);
    EXPECT_NO_THROW(require_in_range(spec, ParameterValue())) << "nothing is in every range";
    EXPECT_NO_THROW(require_in_range(spec, ParameterScalar(Word{"auto"}))) << "a word has no size";
}

TEST(ParameterWord, InPlaceOfAValue_IsTheWord) {
    ParameterSpec spec = spec_of(Type::length, excluding(0));
    spec.word = "auto";
    EXPECT_EQ(read(spec, "auto"), ParameterValue(ParameterScalar(Word{"auto"})));
    EXPECT_EQ(read(spec, "1 mm"), ParameterValue(ParameterScalar(Length(1, Length::In::millimetre))));
    EXPECT_EQ(expectation(spec), "a length above 0, as 0.2 mm, 0.1 %diag, 3 spacing or 0.5 u; or `auto`");
}

TEST(ParameterWord, Misspelt_IsSuggested) {
    ParameterSpec spec = spec_of(Type::number);
    spec.word = "auto";
    EXPECT_EQ(refusal(spec, "atuo"), "'atuo' is not a number; expected a number; or `auto`; did you mean 'auto'?");
    EXPECT_EQ(refusal(spec, "none"), "'none' is not a number; expected a number; or `auto`");
}

TEST(ParameterWord, WithoutOne_AutoIsNoValue) { EXPECT_THROW(read(spec_of(Type::number), "auto"), Error); }

TEST(ParameterWord, ForAList_StandsAloneAndNotInIt) {
    ParameterSpec spec = list_of(Type::number);
    spec.word = "auto";
    EXPECT_EQ(read(spec, "auto"), ParameterValue(ParameterScalar(Word{"auto"})));
    EXPECT_THROW(read_list(spec, {"auto"}), Error);
}

TEST(ParameterList, Items_AreParsedOneByOne) {
    EXPECT_EQ(read_list(list_of(Type::integer), {"3", "1"}),
              ParameterValue(std::vector<ParameterScalar>{std::int64_t(3), std::int64_t(1)}));
    EXPECT_EQ(read_list(list_of(Type::text), {}), ParameterValue(std::vector<ParameterScalar>{}));
    EXPECT_EQ(sentence_of([] {
                  read_list(list_of(Type::integer), {"3", "x"});
              }),
              "'x' is not a whole number; expected a list of values, each a whole number");
}

TEST(ParameterList, SingleValue_IsTheListOfIt) {
    EXPECT_EQ(read(list_of(Type::integer), "3"), read_list(list_of(Type::integer), {"3"}));
}

TEST(ParameterList, OfGivenSize_HasThatSize) {
    EXPECT_NO_THROW(read_list(list_of(Type::number, 3), {"0", "0", "1"}));
    EXPECT_EQ(sentence_of([] {
                  read_list(list_of(Type::number, 3), {"0", "1"});
              }),
              "has 2 values; expected a list of 3 values, each a number");
    EXPECT_EQ(sentence_of([] {
                  read_list(list_of(Type::number, 3), {"0", "0", "0", "1"});
              }),
              "has 4 values; expected a list of 3 values, each a number");
    EXPECT_EQ(refusal(list_of(Type::number, 3), "1"), "has 1 value; expected a list of 3 values, each a number");
}

TEST(ParameterList, InPlaceOfAValue_IsRefused) {
    EXPECT_EQ(sentence_of([] { read_list(spec_of(Type::number), {"1"}); }), "is a list; expected a number");
    EXPECT_EQ(sentence_of([] { read_list(spec_of(Type::text), {}); }), "is a list; expected a text");
}

TEST(Expectation, EveryType_IsDescribed) {
    ParameterSpec spec = spec_of(Type::choice);
    spec.choices = {{"minimum", ""}, {"quantile", ""}};
    EXPECT_EQ(expectation(spec), "one of minimum and quantile");
    EXPECT_EQ(expectation(spec_of(Type::boolean)), "true or false");
    EXPECT_EQ(expectation(spec_of(Type::text)), "a text");
    EXPECT_EQ(expectation(spec_of(Type::path)), "a path");
    EXPECT_EQ(expectation(spec_of(Type::ratio)), "a ratio, as 5 % or 0.05");
}

TEST(Written, EveryValue_ReadsBackEqual) {
    ParameterSpec chosen = spec_of(Type::choice);
    chosen.choices = {{"minimum", ""}, {"quantile", ""}};
    ParameterSpec automatic = spec_of(Type::length);
    automatic.word = "auto";
    const std::vector<std::pair<ParameterSpec, ParameterValue>> values{
        {spec_of(Type::boolean), ParameterScalar(true)},
        {spec_of(Type::integer), ParameterScalar(std::int64_t(-7))},
        {spec_of(Type::number), ParameterScalar(0.1 + 0.2)},
        {chosen, ParameterScalar(std::string("quantile"))},
        {spec_of(Type::text), ParameterScalar(std::string("a, [b]"))},
        {spec_of(Type::path), ParameterScalar(std::string("/tmp/x"))},
        {spec_of(Type::length), ParameterScalar(Length::spacings(3))},
        {automatic, ParameterScalar(Word{"auto"})},
        {spec_of(Type::angle), ParameterScalar(Angle::radians(0.7))},
        {spec_of(Type::ratio), ParameterScalar(Ratio::percent(12.5))},
        {list_of(Type::length), std::vector<ParameterScalar>{Length(1), Length(2, Length::In::inch)}},
        {list_of(Type::text), std::vector<ParameterScalar>{std::string("a, b"), std::string("")}},
        {list_of(Type::number), std::vector<ParameterScalar>{}}};
    for (const auto& [spec, value] : values) EXPECT_EQ(parse(spec, written(value)), value) << text(value);
}

TEST(Resolved, EveryLengthOfAValue_IsInTheScansUnit) {
    const LengthScale scale{LengthUnit::millimetre, [] { return 200.0; }, [] { return 0.5; }};
    EXPECT_EQ(resolved(ParameterScalar(Length::percent_of_diagonal(1)), scale),
              ParameterValue(ParameterScalar(Length(2))));
    EXPECT_EQ(resolved(std::vector<ParameterScalar>{Length::spacings(2), Length(1, Length::In::centimetre)}, scale),
              ParameterValue(std::vector<ParameterScalar>{Length(1), Length(10)}));
}

TEST(Resolved, WhatIsNoLength_StaysAsItIs) {
    const LengthScale nothing;
    for (const ParameterValue& value : {ParameterValue(), ParameterValue(ParameterScalar(Word{"auto"})),
                                        ParameterValue(ParameterScalar(Angle::degrees(4))),
                                        ParameterValue(std::vector<ParameterScalar>{1.0, std::string("a")})})
        EXPECT_EQ(resolved(value, nothing), value);
}

TEST(ParameterSet, Find_KnowsTheWholeName) {
    const ParameterSet set{{{"a", ParameterScalar(1.0)}, {"b", ParameterValue()}}};
    ASSERT_TRUE(set.find("a"));
    EXPECT_EQ(*set.find("a"), ParameterValue(ParameterScalar(1.0)));
    EXPECT_TRUE(set.find("b")) << "nothing is a value too";
    EXPECT_EQ(set.find("c"), nullptr);
    EXPECT_EQ(set.find(""), nullptr);
}

}  // namespace
}  // namespace scanmill::test
