// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/frame.hpp"

#include <gtest/gtest.h>

namespace scanmill::test {
namespace {

TEST(LengthUnit, EverySymbol_NamesItsUnitAndBack) {
    using enum LengthUnit;
    for (const LengthUnit unit : {micrometre, millimetre, centimetre, metre, inch, foot}) {
        EXPECT_EQ(length_unit(symbol(unit)), unit) << symbol(unit);
        EXPECT_NE(length_unit_symbols().find(symbol(unit)), std::string_view::npos) << symbol(unit);
    }
    EXPECT_EQ(symbol(micrometre), "um");
    EXPECT_EQ(symbol(millimetre), "mm");
    EXPECT_EQ(symbol(centimetre), "cm");
    EXPECT_EQ(symbol(metre), "m");
    EXPECT_EQ(symbol(inch), "in");
    EXPECT_EQ(symbol(foot), "ft");
}

TEST(LengthUnit, Metres_AreTheDefinitions) {
    EXPECT_EQ(metres(LengthUnit::metre), 1);
    EXPECT_EQ(metres(LengthUnit::centimetre) * 100, 1);
    EXPECT_EQ(metres(LengthUnit::millimetre) * 1000, 1);
    EXPECT_EQ(metres(LengthUnit::micrometre) * 1e6, 1);
    EXPECT_EQ(metres(LengthUnit::inch), 0.0254);
    EXPECT_DOUBLE_EQ(metres(LengthUnit::foot), 12 * metres(LengthUnit::inch));
}

TEST(LengthUnit, WhatIsNoUnitOfTheWorld_NamesNone) {
    for (const char* text : {"", "u", "MM", "mm ", "metre", "km", "%diag", "spacing"})
        EXPECT_FALSE(length_unit(text)) << text;
    EXPECT_EQ(symbol(LengthUnit::unknown), "u");
}

TEST(Frame, Equality_KnowsUnitOriginAndName) {
    const Frame frame{LengthUnit::millimetre, Vec3(1, 2, 3), "part"};
    EXPECT_EQ(frame, (Frame{LengthUnit::millimetre, Vec3(1, 2, 3), "part"}));
    EXPECT_NE(frame, (Frame{LengthUnit::metre, Vec3(1, 2, 3), "part"}));
    EXPECT_NE(frame, (Frame{LengthUnit::millimetre, Vec3(1, 2, 4), "part"}));
    EXPECT_NE(frame, (Frame{LengthUnit::millimetre, Vec3(1, 2, 3), "machine"}));
}

TEST(Frame, Default_IsTheOriginInAnUnknownUnit) { EXPECT_EQ(Frame{}, (Frame{LengthUnit::unknown, Vec3(0, 0, 0), ""})); }

}  // namespace
}  // namespace scanmill::test
