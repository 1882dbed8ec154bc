// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as text: parse_number and number_text.

#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <limits>
#include <locale>

#include "scanmill/base/random.hpp"
#include "scanmill/data/quantity.hpp"
#include "support/numbers.hpp"

namespace scanmill::test {
namespace {

/// The number, by its bits; fails when the text is none.
std::uint64_t bits_of(std::string_view text) {
    double value = -1;
    EXPECT_TRUE(parse_number(text, value)) << text;
    return std::bit_cast<std::uint64_t>(value);
}
std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

/// Any finite double, every exponent equally likely.
double any_double(Random& random) {
    for (;;)
        if (const double value = std::bit_cast<double>(random.next()); std::isfinite(value)) return value;
}

TEST(ParseNumber, RandomDoublesOfAllSizes_ComeBackBitForBit) {
    Random random(1);
    for (int i = 0; i < 20'000; ++i) {
        const double value = any_double(random);
        ASSERT_EQ(bits_of(number_text(value)), bits(value)) << number_text(value);
    }
    for (const double value :
         {0.0, -0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max()})
        EXPECT_EQ(bits_of(number_text(value)), bits(value));
}

TEST(ParseNumber, Forms_AreRead) {
    EXPECT_EQ(bits_of("12"), bits(12));
    EXPECT_EQ(bits_of("-12.5"), bits(-12.5));
    EXPECT_EQ(bits_of("+12.5"), bits(12.5));
    EXPECT_EQ(bits_of(".5"), bits(0.5));
    EXPECT_EQ(bits_of("5."), bits(5));
    EXPECT_EQ(bits_of("1e3"), bits(1000));
    EXPECT_EQ(bits_of("1E+3"), bits(1000));
    EXPECT_EQ(bits_of("25e-2"), bits(0.25));
    EXPECT_EQ(bits_of("-0"), bits(-0.0));
    EXPECT_EQ(bits_of("007"), bits(7));
}

TEST(ParseNumber, NanAndInfinity_AreReadInAnyCase) {
    for (const char* text : {"inf", "INF", "Inf", "+inf", "infinity"}) EXPECT_EQ(bits_of(text), bits(infinity)) << text;
    EXPECT_EQ(bits_of("-inf"), bits(-infinity));
    for (const char* text : {"nan", "NaN", "NAN", "-nan"}) {
        double value = 0;
        EXPECT_TRUE(parse_number(text, value)) << text;
        EXPECT_TRUE(std::isnan(value)) << text;
    }
}

TEST(ParseNumber, WhatIsNotWhollyANumber_IsNone) {
    for (const char* text :
         {"",    "+",   "-",   ".",   "e5",   "abc",   "1x",    "1 ",   " 1",      "1,5", "1.2.3", "1e", "1e+",
          "--1", "++1", "+-1", "-+1", "0x10", "1_000", "1e5.5", "inf2", "nan nan", "1\n", "e",     "mm"}) {
        double value = 0;
        EXPECT_FALSE(parse_number(text, value)) << "'" << text << "'";
    }
    double value = 0;
    EXPECT_FALSE(parse_number(std::string_view("1\0", 2), value)) << "a zero byte is not an end";
    EXPECT_FALSE(parse_number({}, value));
}

TEST(ParseNumber, BeyondTheLargestDouble_IsInfinity) {
    EXPECT_EQ(bits_of("1e309"), bits(infinity));
    EXPECT_EQ(bits_of("-1e309"), bits(-infinity));
    EXPECT_EQ(bits_of("+1e309"), bits(infinity));
    EXPECT_EQ(bits_of("1e99999999999999999999"), bits(infinity));
    EXPECT_EQ(bits_of("1" + std::string(400, '0')), bits(infinity));
    EXPECT_EQ(bits_of("1" + std::string(400, '0') + ".5"), bits(infinity));
    EXPECT_EQ(bits_of("0.00001e400"), bits(infinity));
}

TEST(ParseNumber, BelowTheSmallestDouble_IsZeroWithItsSign) {
    EXPECT_EQ(bits_of("1e-400"), bits(0.0));
    EXPECT_EQ(bits_of("-1e-400"), bits(-0.0));
    EXPECT_EQ(bits_of("1e-99999999999999999999"), bits(0.0));
    EXPECT_EQ(bits_of("0." + std::string(400, '0') + "1"), bits(0.0));
    EXPECT_EQ(bits_of("-0." + std::string(400, '0') + "1"), bits(-0.0));
    EXPECT_EQ(bits_of("00." + std::string(400, '0') + "1"), bits(0.0));
    EXPECT_EQ(bits_of("-." + std::string(400, '0') + "1"), bits(-0.0));
    EXPECT_EQ(bits_of("12345e-400"), bits(0.0));
}

TEST(ParseNumber, ExponentAgainstDigits_TheProductDecides) {
    EXPECT_EQ(bits_of("0." + std::string(400, '0') + "1e50"), bits(0.0));
    EXPECT_EQ(bits_of("0." + std::string(400, '0') + "1e401"), bits(1));
    EXPECT_EQ(bits_of("0." + std::string(400, '0') + "1e800"), bits(infinity));
    EXPECT_EQ(bits_of("1" + std::string(400, '0') + "e-50"), bits(infinity));
    EXPECT_EQ(bits_of("1" + std::string(400, '0') + "e-400"), bits(1));
    EXPECT_EQ(bits_of("1" + std::string(400, '0') + "e-800"), bits(0.0));
}

TEST(ParseNumber, ZeroTimesAnything_IsZero) {
    EXPECT_EQ(bits_of("0e999999"), bits(0.0));
    EXPECT_EQ(bits_of("0e99999999999999999999"), bits(0.0));
    EXPECT_EQ(bits_of("-0.000e400"), bits(-0.0));
}

TEST(NumberText, Shortest_AsPeopleWriteIt) {
    EXPECT_EQ(number_text(0.1), "0.1");
    EXPECT_EQ(number_text(1), "1");
    EXPECT_EQ(number_text(-2.5), "-2.5");
    EXPECT_EQ(number_text(1e300), "1e+300");
    EXPECT_EQ(number_text(0.1 + 0.2), "0.30000000000000004");
}

struct DecimalComma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

TEST(NumberText, LocaleWithDecimalCommas_ChangesNothing) {
    const std::string c_locale = std::setlocale(LC_ALL, nullptr);
    const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
    std::setlocale(LC_ALL, "de_DE.UTF-8");  // the C library's, where it is installed
    EXPECT_EQ(number_text(1234567.5), "1234567.5");
    EXPECT_EQ(bits_of("1234567.5"), bits(1234567.5));
    EXPECT_EQ(Length::parse("0.5 mm").text(), "0.5 mm");
    std::locale::global(before);
    std::setlocale(LC_ALL, c_locale.c_str());
}

}  // namespace
}  // namespace scanmill::test
