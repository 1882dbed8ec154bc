// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/frame.hpp"

#include <gtest/gtest.h>

#include "support/thrown.hpp"

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

TEST(LengthUnit, Conversions_AreTheDefinitionsToTheLastBit) {
    using enum LengthUnit;
    EXPECT_EQ(in_unit(1, metre, micrometre), 1e6);
    EXPECT_EQ(in_unit(1, micrometre, metre), 1e-6);
    EXPECT_EQ(in_unit(0.1, millimetre, micrometre), 100);
    EXPECT_EQ(in_unit(3, millimetre, metre), 0.003);
    EXPECT_EQ(in_unit(7, centimetre, millimetre), 70);
    EXPECT_EQ(in_unit(1, inch, millimetre), 25.4);
    EXPECT_EQ(in_unit(1, foot, inch), 12);
    EXPECT_EQ(in_unit(6, inch, foot), 0.5);
    EXPECT_EQ(in_unit(1.25, foot, foot), 1.25);
}

TEST(Frame, OtherUnitsAndNames_AreRefused) {
    const auto refusal = [](const Frame& plan, const Frame& mesh) {
        return error_of([&] { require_same_frame(plan, "the plan is", mesh, "the mesh"); });
    };
    const Frame unnamed{LengthUnit::millimetre, Vec3::Zero(), ""},
        machine{LengthUnit::millimetre, Vec3::Ones(), "machine"},
        scanner{LengthUnit::millimetre, Vec3::Zero(), "scanner"};
    EXPECT_NO_THROW(require_same_frame(machine, "a is", unnamed, "b"));
    EXPECT_NO_THROW(require_same_frame(machine, "a is", {LengthUnit::millimetre, Vec3::Zero(), "machine"}, "b"));
    EXPECT_EQ(refusal(machine, scanner).sentence(),
              "the plan is in the frame 'machine', the mesh in 'scanner'; both need one frame");
    EXPECT_EQ(refusal(unnamed, Frame()).sentence(), "the plan is in mm, the mesh in u; both need one unit");
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
