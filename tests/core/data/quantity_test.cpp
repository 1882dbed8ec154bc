// SPDX-License-Identifier: GPL-3.0-or-later
// Reading and writing lengths, angles and ratios. Resolution of lengths on a scan:
// length_resolution_test.cpp.

#include "scanmill/data/quantity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scanmill/base/random.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using In = Length::In;

std::string length_refusal(std::string_view text) {
    return sentence_of([&] { Length::parse(text); });
}
std::string angle_refusal(std::string_view text) {
    return sentence_of([&] { Angle::parse(text); });
}
std::string ratio_refusal(std::string_view text) {
    return sentence_of([&] { Ratio::parse(text); });
}

/// A double of any everyday size, of either sign.
double some_number(Random& random) { return random.uniform(-1, 1) * std::pow(10, random.uniform(-12, 12)); }

TEST(Length, EveryUnit_IsRead) {
    EXPECT_EQ(Length::parse("0.5 u"), Length(0.5));
    EXPECT_EQ(Length::parse("0.1 %diag"), Length::percent_of_diagonal(0.1));
    EXPECT_EQ(Length::parse("3 spacing"), Length::spacings(3));
    EXPECT_EQ(Length::parse("3 spacings"), Length::spacings(3));
    EXPECT_EQ(Length::parse("1 um"), Length(1, In::micrometre));
    EXPECT_EQ(Length::parse("2 mm"), Length(2, In::millimetre));
    EXPECT_EQ(Length::parse("3 cm"), Length(3, In::centimetre));
    EXPECT_EQ(Length::parse("4 m"), Length(4, In::metre));
    EXPECT_EQ(Length::parse("5 in"), Length(5, In::inch));
    EXPECT_EQ(Length::parse("6 ft"), Length(6, In::foot));
}

TEST(Length, FormsOfTheNumberAndTheBlank_AreFree) {
    for (const char* text : {"2mm", "2 mm", "2   mm", "+2 mm", "2.0mm", "20e-1 mm"})
        EXPECT_EQ(Length::parse(text), Length(2, In::millimetre)) << text;
    EXPECT_EQ(Length::parse("-2 mm"), Length(-2, In::millimetre)) << "signs are the range's business";
}

TEST(Length, WhatIsNoNumber_IsRefusedWithExamples) {
    const std::string expected = " is not a length; expected 0.2 mm, 0.1 %diag, 3 spacing or 0.5 u";
    for (const std::string text :
         {"", "mm", "abc", "inf mm", "nan mm", "-inf u", "1e999 mm", "+-2 mm", "++2 mm", " 2 mm", "+"})
        EXPECT_EQ(length_refusal(text), "'" + text + "'" + expected);
}

TEST(Length, NumberAlone_IsRefusedForItsMissingUnit) {
    EXPECT_EQ(length_refusal("0.2"), "'0.2' has no unit; expected 0.2 mm, 0.1 %diag, 3 spacing or 0.5 u");
    EXPECT_EQ(length_refusal("2 "), "'2 ' has no unit; expected 0.2 mm, 0.1 %diag, 3 spacing or 0.5 u");
}

TEST(Length, BarePercent_IsAskedOfWhat) {
    EXPECT_EQ(length_refusal("5 %"),
              "'5 %' has no reference; expected 5 %diag, a share of the bounding box's diagonal");
}

TEST(Length, UnknownUnit_IsRefusedWithTheKnownOnes) {
    const std::string expected = " is not a unit of length; expected u, %diag, spacing, um, mm, cm, m, in, ft";
    EXPECT_EQ(length_refusal("5 km"), "'km'" + expected);
    EXPECT_EQ(length_refusal("5 MM"), "'MM'" + expected);
    EXPECT_EQ(length_refusal("5 mm "), "'mm '" + expected);
    EXPECT_EQ(length_refusal("5 mm mm"), "'mm mm'" + expected);
    EXPECT_EQ(length_refusal("0x10 mm"), "'x10 mm'" + expected);
    EXPECT_EQ(length_refusal("5 deg"), "'deg'" + expected);
}

TEST(Length, TextOfRandomLengthsInEveryUnit_ReadsBackEqual) {
    Random random(11);
    for (int i = 0; i < 5000; ++i) {
        const Length length(some_number(random), static_cast<In>(random.index(9)));
        ASSERT_EQ(Length::parse(length.text()), length) << length.text();
    }
}

TEST(Length, Text_IsAsItWasWritten) {
    EXPECT_EQ(Length::parse("+0.10%diag").text(), "0.1 %diag");
    EXPECT_EQ(Length(0.2, In::millimetre).text(), "0.2 mm");
    EXPECT_EQ(Length(3).text(), "3 u");
}

TEST(Length, Value_IsForResolvedLengthsOnly) {
    EXPECT_EQ(Length(0.25).value(), 0.25);
    const Error error = error_of([] { Length(2, In::spacing).value(); });
    EXPECT_EQ(error.sentence(), "the length 2 spacing was not resolved into the scan's unit");
    EXPECT_NE(error.hint(), "");
    EXPECT_THROW(Length(2, In::metre).value(), Error);
}

TEST(Angle, DegreesAndRadians_AreRead) {
    EXPECT_EQ(Angle::parse("40 deg"), Angle::degrees(40));
    EXPECT_EQ(Angle::parse("0.7rad"), Angle::radians(0.7));
    EXPECT_EQ(Angle::parse("-1e1 deg"), Angle::degrees(-10));
}

TEST(Angle, RightAngle_IsHalfPi) {
    EXPECT_EQ(Angle::degrees(90).in_radians(), std::numbers::pi / 2);
    EXPECT_EQ(Angle::radians(std::numbers::pi).in_degrees(), 180);
    EXPECT_EQ(Angle::degrees(33).in_degrees(), 33);
    EXPECT_EQ(Angle::radians(0.1).in_radians(), 0.1);
}

TEST(Angle, TextOfRandomAngles_ReadsBackEqual) {
    Random random(12);
    for (int i = 0; i < 2000; ++i) {
        const double amount = some_number(random);
        ASSERT_EQ(Angle::parse(Angle::degrees(amount).text()), Angle::degrees(amount));
        ASSERT_EQ(Angle::parse(Angle::radians(amount).text()), Angle::radians(amount));
    }
    EXPECT_EQ(Angle::degrees(40).text(), "40 deg");
    EXPECT_EQ(Angle::radians(0.5).text(), "0.5 rad");
}

TEST(Angle, EveryRefusal_SaysWhatWasExpected) {
    EXPECT_EQ(angle_refusal("wide"), "'wide' is not an angle; expected 40 deg or 0.7 rad");
    EXPECT_EQ(angle_refusal("inf deg"), "'inf deg' is not an angle; expected 40 deg or 0.7 rad");
    EXPECT_EQ(angle_refusal("40"), "'40' has no unit; expected 40 deg or 0.7 rad");
    EXPECT_EQ(angle_refusal("40 mm"), "'mm' is not a unit of angle; expected deg or rad");
    EXPECT_EQ(angle_refusal("40 °"), "'°' is not a unit of angle; expected deg or rad");
}

TEST(Ratio, PercentAndFraction_AreTheSameRatioWrittenDifferently) {
    EXPECT_EQ(Ratio::parse("5 %").value(), 0.05);
    EXPECT_EQ(Ratio::parse("0.05").value(), 0.05);
    EXPECT_EQ(Ratio::parse("5%"), Ratio::percent(5));
    EXPECT_EQ(Ratio::parse("0.05"), Ratio::fraction(0.05));
    EXPECT_EQ(Ratio::percent(150).value(), 1.5);
}

TEST(Ratio, TextOfRandomRatios_ReadsBackEqual) {
    Random random(13);
    for (int i = 0; i < 2000; ++i) {
        const double amount = some_number(random);
        ASSERT_EQ(Ratio::parse(Ratio::percent(amount).text()), Ratio::percent(amount));
        ASSERT_EQ(Ratio::parse(Ratio::fraction(amount).text()), Ratio::fraction(amount));
    }
    EXPECT_EQ(Ratio::percent(5).text(), "5 %");
    EXPECT_EQ(Ratio::fraction(0.05).text(), "0.05");
}

TEST(Ratio, EveryRefusal_SaysWhatWasExpected) {
    for (const std::string text : {"", "half", "5 %diag", "5 %%", "nan", "inf %", "5 pct", "1/2"})
        EXPECT_EQ(ratio_refusal(text), "'" + text + "' is not a ratio; expected 5 % or 0.05");
}

}  // namespace
}  // namespace scanmill::test
