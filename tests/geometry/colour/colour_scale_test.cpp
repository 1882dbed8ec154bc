// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/colour/colour_scale.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace scanmill {
namespace {

/// Brightness in a grey picture (ITU-R BT.601).
double grey(const Colour& colour) { return 0.299 * colour[0] + 0.587 * colour[1] + 0.114 * colour[2]; }

const ColourScale uneven{.low = -1, .high = 4};

TEST(ColourScale, Zero_IsNeutralWhereverItLiesInTheRange) {
    const Colour neutral = colour_of({-1, 1}, 0);
    EXPECT_EQ(colour_of(uneven, 0), neutral);
    EXPECT_EQ(colour_of({0, 3}, 0), neutral);
    EXPECT_EQ(colour_of({-3, 0}, 0), neutral);
    EXPECT_GT(grey(neutral), 235);
}

TEST(ColourScale, Halves_AreScaledSeparately) {
    EXPECT_EQ(colour_of(uneven, -0.5), colour_of({-1, 1}, -0.5));
    EXPECT_EQ(colour_of(uneven, 2), colour_of({-1, 1}, 0.5));
}

TEST(ColourScale, Sign_IsBlueBelowAndRedAbove) {
    for (double share = 0.1; share <= 1; share += 0.05) {
        const Colour below = colour_of(uneven, -share), above = colour_of(uneven, 4 * share);
        EXPECT_GT(below[2], below[0]) << share;
        EXPECT_GT(above[0], above[2]) << share;
    }
}

TEST(ColourScale, Magnitude_IsDarkerInGrey) {
    for (const double sign : {-1.0, 1.0})
        for (double share = 0.02; share <= 1; share += 0.02)
            EXPECT_LT(grey(colour_of({-1, 1}, sign * share)), grey(colour_of({-1, 1}, sign * (share - 0.02))));
}

TEST(ColourScale, Values_HaveNoJumps) {
    for (const ColourScale& scale : {ColourScale{-1, 1}, uneven, ColourScale{-1, 4, -0.3, 2.5}})
        for (double value = -1.1; value < 4.1; value += 1e-3) {
            const Colour one = colour_of(scale, value), next = colour_of(scale, value + 1e-3);
            for (std::size_t channel = 0; channel < 3; ++channel)
                EXPECT_LE(std::abs(one[channel] - next[channel]), 2) << value;
        }
}

TEST(ColourScale, ValuesOutside_HaveTheColoursOfTheEnds) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(colour_of(uneven, -7), colour_of(uneven, -1));
    EXPECT_EQ(colour_of(uneven, -infinity), colour_of(uneven, -1));
    EXPECT_EQ(colour_of(uneven, 5), colour_of(uneven, 4));
    EXPECT_EQ(colour_of(uneven, infinity), colour_of(uneven, 4));
}

TEST(ColourScale, NaN_HasAColourThatNoValueHas) {
    EXPECT_EQ(colour_of(uneven, std::nan("")), no_data);
    for (double value = -1; value <= 4; value += 0.01) {
        const Colour colour = colour_of(uneven, value);
        EXPECT_GT(std::abs(colour[0] - no_data[0]) + std::abs(colour[2] - no_data[2]), 20) << value;
    }
}

TEST(ColourScale, RangeOnOneSide_BeginsNeutral) {
    EXPECT_EQ(colour_of({2, 5}, 2), colour_of({-1, 1}, 0));
    EXPECT_EQ(colour_of({2, 5}, 5), colour_of({-1, 1}, 1));
    EXPECT_EQ(colour_of({-5, -2}, -2), colour_of({-1, 1}, 0));
    EXPECT_EQ(colour_of({-5, -2}, -5), colour_of({-1, 1}, -1));
}

TEST(ColourScale, RangeOfOneValue_IsNeutralThere) { EXPECT_EQ(colour_of({3, 3}, 3), colour_of({-1, 1}, 0)); }

TEST(ColourScale, Tolerance_IsLighterInside) {
    const ColourScale plain{-1, 1}, banded{-1, 1, -0.5, 0.6};
    for (double value = 0.05; value < 0.6; value += 0.05) {
        EXPECT_GT(grey(colour_of(banded, value)), grey(colour_of(plain, value)));
        EXPECT_GT(grey(colour_of(banded, -value)), grey(colour_of(plain, -value)));
    }
    EXPECT_EQ(colour_of(banded, 0.6), colour_of(plain, 0.2));
    EXPECT_EQ(colour_of(banded, -0.5), colour_of(plain, -0.2));
    EXPECT_EQ(colour_of(banded, 1), colour_of(plain, 1));
}

TEST(ColourScale, ToleranceOnOneSideOf0_LeavesNoValueOutsideLight) {
    const auto lightness = [](const Colour& colour) { return colour[0] + colour[1] + colour[2]; };
    for (const auto& [low, high] : {std::pair(0.0, 0.1), {0.1, 0.3}, {-0.3, -0.1}, {-0.1, 0.0}}) {
        const ColourScale scale = scale_of_tolerance(low, high);
        int darkest_in = 3 * 255, lightest_out = 0;
        for (int i = -1000; i <= 1000; ++i) {
            const double value = i * 0.001;
            const int light = lightness(colour_of(scale, value));
            if (value >= low && value <= high)
                darkest_in = std::min(darkest_in, light);
            else
                lightest_out = std::max(lightest_out, light);
        }
        EXPECT_GE(darkest_in, lightest_out - 12) << low << " to " << high;  // blue and red differ a little
    }
}

TEST(ColourScale, ToleranceBeyondTheRange_HasNoEffect) {
    for (double value = -1; value <= 1; value += 0.1)
        EXPECT_EQ(colour_of({-1, 1, -2, 1}, value), colour_of({-1, 1}, value));
}

}  // namespace
}  // namespace scanmill
