// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/direction.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

Vec3 direction(std::vector<double> numbers) { return direction_of(numbers, "`up`"); }

TEST(DirectionOf, HasLengthOne_ForNumbersOfEverySize) {
    EXPECT_EQ(direction({0, 0, 2}), Vec3(0, 0, 1));
    EXPECT_NEAR((direction({3, 0, -4}) - Vec3(0.6, 0, -0.8)).norm(), 0, 1e-15);
    EXPECT_NEAR((direction({3e-200, 0, -4e-200}) - Vec3(0.6, 0, -0.8)).norm(), 0, 1e-15);
    EXPECT_NEAR((direction({3e200, 0, -4e200}) - Vec3(0.6, 0, -0.8)).norm(), 0, 1e-15);
}

TEST(DirectionOf, WithoutThreeNumbersOrALength_IsRefused) {
    const auto refusal = [](std::vector<double> numbers) {
        const Error error = error_of([&] { direction(numbers); });
        EXPECT_FALSE(error.hint().empty());
        return error.sentence();
    };
    EXPECT_EQ(refusal({}), "`up` has 0 numbers; it needs 3");
    EXPECT_EQ(refusal({1}), "`up` has 1 number; it needs 3");
    EXPECT_EQ(refusal({0, 0, 1, 0}), "`up` has 4 numbers; it needs 3");
    EXPECT_EQ(refusal({0, 0, 0}), "`up` is (0, 0, 0); it must be finite and not zero");
    EXPECT_EQ(refusal({0, std::numeric_limits<double>::quiet_NaN(), 1}),
              "`up` is (0, nan, 1); it must be finite and not zero");
    EXPECT_EQ(refusal({0, 0, std::numeric_limits<double>::infinity()}),
              "`up` is (0, 0, inf); it must be finite and not zero");
}

TEST(PositionOf, WithoutThreeFiniteLengths_IsRefused) {
    EXPECT_EQ(position_of(std::vector<Length>{1, -2, 0}, "`centre`"), Vec3(1, -2, 0));
    const auto refusal = [](std::vector<Length> lengths) {
        const Error error = error_of([&] { position_of(lengths, "`centre`"); });
        EXPECT_FALSE(error.hint().empty());
        return error.sentence();
    };
    EXPECT_EQ(refusal({1}), "`centre` has 1 length; it needs 3");
    EXPECT_EQ(refusal({0, std::numeric_limits<double>::quiet_NaN(), 0}),
              "a length of `centre` is nan u; it must be finite");
}

}  // namespace
}  // namespace scanmill::test
