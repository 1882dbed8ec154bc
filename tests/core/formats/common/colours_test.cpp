// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/colours.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <charconv>

namespace scanmill::test {
namespace {

std::optional<u8> byte_of(std::string_view spelling) {
    double value = 0;
    std::from_chars(spelling.data(), spelling.data() + spelling.size(), value);
    return byte_of_fraction(spelling, value);
}

TEST(ColourFractions_EveryByte, ComesBack_RoundedOrCut_InBothPrecisions) {
    const auto table = colour_fractions();
    for (int byte = 0; byte < 256; ++byte) {
        const std::string& spelling = table[static_cast<std::size_t>(byte)];
        EXPECT_EQ(byte_of(spelling), byte) << spelling;
        double value = 0;
        std::from_chars(spelling.data(), spelling.data() + spelling.size(), value);
        EXPECT_EQ(static_cast<int>(value * 255), byte) << spelling;
        EXPECT_EQ(static_cast<int>(static_cast<float>(value) * 255.0f), byte) << spelling;
    }
    EXPECT_EQ(table[0], "0");
    EXPECT_EQ(table[51], "0.2");
    // 7 / 255 = 0.02745…: 0.027 · 255 = 6.885 truncates to 6. 85 / 255 = 1/3, and every shorter decimal is below it.
    EXPECT_EQ(table[7], "0.0275");
    EXPECT_EQ(table[85], "0.3333334");
    EXPECT_EQ(table[128], "0.502");
    EXPECT_EQ(table[255], "1");
}

TEST(ColourFractions_EveryByte, IsRecognisedAsOthersWriteIt) {
    for (int byte = 0; byte < 256; ++byte) {
        for (int digits = 3; digits <= 17; ++digits)
            EXPECT_EQ(byte_of(fmt::format("{:.{}f}", byte / 255.0, digits)), byte) << digits;
        EXPECT_EQ(byte_of(fmt::format("{:.12f}", static_cast<float>(byte) / 255.0f)), byte);
        EXPECT_EQ(byte_of(fmt::format("{:.9g}", static_cast<float>(byte) * (1.0f / 255.0f))), byte);
    }
}

TEST(ColourFractions_OtherDecimals, AreNoBytes) {
    // With one or two digits only the multiples of 51 / 255 = 0.2 are bytes: 255 · n / 100 is whole for no other n.
    for (int hundredths = 0; hundredths <= 100; ++hundredths)
        EXPECT_EQ(byte_of(fmt::format("{:.2f}", hundredths / 100.0)).has_value(), hundredths % 20 == 0) << hundredths;
    // 128 / 255 = 0.50196…
    EXPECT_EQ(byte_of("0.5020"), 128);
    EXPECT_EQ(byte_of("0.5021"), std::nullopt);
    EXPECT_EQ(byte_of("0.5365"), std::nullopt);
    EXPECT_EQ(byte_of("-0.2"), std::nullopt);
    EXPECT_EQ(byte_of("1.2"), std::nullopt);
    EXPECT_EQ(byte_of("nan"), std::nullopt);
    EXPECT_EQ(byte_of("5.02e-1"), std::nullopt);
}

}  // namespace
}  // namespace scanmill::test
