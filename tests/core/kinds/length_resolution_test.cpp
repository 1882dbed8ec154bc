// SPDX-License-Identifier: GPL-3.0-or-later
// Resolution of lengths on a scan.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "scanmill/base/random.hpp"
#include "scanmill/data/quantity.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

LengthScale scan_in(LengthUnit unit, double diagonal = 50, double spacing = 0.25) {
    return {unit, [=] { return diagonal; }, [=] { return spacing; }};
}

double on(const LengthScale& scale, const char* text) { return Length::parse(text).resolved(scale).value(); }

TEST(LengthResolution, AbsoluteLengths_AreConvertedIntoTheScansUnit) {
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::metre), "5 mm"), 0.005);
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::millimetre), "5 m"), 5000);
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::inch), "25.4 mm"), 1);
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::foot), "12 in"), 1);
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::micrometre), "1 ft"), 304800);
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::centimetre), "7 um"), 0.0007);
}

TEST(LengthResolution, SameUnit_KeepsTheNumberBitForBit) {
    using enum LengthUnit;
    Random random(31);
    for (const LengthUnit unit : {micrometre, millimetre, centimetre, metre, inch, foot})
        for (int i = 0; i < 200; ++i) {
            const std::string amount = number_text(random.uniform(0, 100));
            const std::string written = amount + " " + std::string(symbol(unit));
            EXPECT_EQ(on(scan_in(unit), written.c_str()), on(scan_in(unit), (amount + " u").c_str())) << written;
        }
}

TEST(LengthResolution, RelativeLengths_AreMeasuredOnTheScan) {
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::unknown), "2 %diag"), 1);
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::millimetre), "100 %diag"), 50);
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::unknown), "3 spacing"), 0.75);
}

TEST(LengthResolution, ShorterThanAnyNumber_IsRefused) {
    EXPECT_EQ(sentence_of([&] { on(scan_in(LengthUnit::unknown, 1e-320), "1e-10 %diag"); }),
              "1e-10 %diag is outside the range of a length: it is 0 u");
    EXPECT_EQ(on(scan_in(LengthUnit::unknown), "0 %diag"), 0);
}

TEST(LengthResolution, LongerThanAnyNumber_IsRefused) {
    const auto refusal = [](const LengthScale& scale, const char* text) {
        return sentence_of([&] { on(scale, text); });
    };
    EXPECT_EQ(refusal(scan_in(LengthUnit::unknown, 1e200), "1e200 %diag"),
              "1e+200 %diag is outside the range of a length: it is inf u");
    EXPECT_EQ(on(scan_in(LengthUnit::unknown), "1.6e308 spacing"), 4e307);
    EXPECT_THAT(refusal(scan_in(LengthUnit::unknown, 1, 2), "1e308 spacing"), HasSubstr("1e+308 spacing is outside"));
    EXPECT_THAT(refusal(scan_in(LengthUnit::micrometre), "1e308 m"), HasSubstr("1e+308 m is outside"));
    EXPECT_DOUBLE_EQ(on(scan_in(LengthUnit::unknown, 1e300), "1 %diag"), 1e298);
}

TEST(LengthResolution, ScanUnits_NeedNothingOfTheScan) {
    EXPECT_EQ(Length::parse("0.5 u").resolved(LengthScale{}), Length(0.5));
    EXPECT_EQ(on(scan_in(LengthUnit::metre), "0.5 u"), 0.5);
}

TEST(LengthResolution, OnlyWhatIsNeeded_IsMeasured) {
    int diagonals = 0, spacings = 0;
    const LengthScale scale{LengthUnit::metre, [&] { return ++diagonals, 1.0; }, [&] { return ++spacings, 1.0; }};
    on(scale, "1 mm");
    on(scale, "1 u");
    EXPECT_EQ(diagonals + spacings, 0);
    on(scale, "1 spacing");
    EXPECT_EQ(diagonals, 0);
    EXPECT_EQ(spacings, 1);
}

TEST(LengthResolution, ResolvedLength_StaysAsItIs) {
    const LengthScale scale = scan_in(LengthUnit::metre);
    const Length once = Length::parse("3 %diag").resolved(scale);
    EXPECT_EQ(once.resolved(scale), once);
}

TEST(LengthResolution, AbsoluteOnAScanOfUnknownUnit_IsRefusedAndSaysHowToDeclareIt) {
    const Error error = error_of([] { on(scan_in(LengthUnit::unknown), "5 mm"); });
    EXPECT_EQ(error.sentence(), "5 mm needs a scan of known unit; this scan's unit is not declared");
    EXPECT_EQ(error.remedy(), Remedy::declare_unit);
    EXPECT_THAT(error.hint(), HasSubstr("unit: mm}"));
}

TEST(LengthResolution, ScanWithoutExtent_RefusesRelativeLengths) {
    const Error error = error_of([] { on(scan_in(LengthUnit::metre, 0), "2 %diag"); });
    EXPECT_EQ(error.sentence(), "2 %diag cannot be resolved: the scan's bounding-box diagonal is 0");
    EXPECT_THAT(error.hint(), HasSubstr("0.5 u"));
    EXPECT_EQ(sentence_of([] { on(scan_in(LengthUnit::metre, 1, 0), "2 spacing"); }),
              "2 spacing cannot be resolved: the scan's point spacing is 0");
}

TEST(LengthResolution, ScaleThatIsNoNumber_IsRefused) {
    for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), -1.0})
        EXPECT_THROW(on(scan_in(LengthUnit::metre, bad), "2 %diag"), Error) << bad;
    EXPECT_THROW(on(LengthScale{}, "2 %diag"), Error) << "nothing to measure on";
}

}  // namespace
}  // namespace scanmill::test
