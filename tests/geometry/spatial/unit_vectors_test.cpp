// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/unit_vectors.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(UnitOrZero, HasLengthOne_OrIsZero) {
    EXPECT_EQ(unit_or_zero({0, 3, -4}), Vec3(0, 0.6, -0.8));
    EXPECT_EQ(unit_or_zero({0, 0, 0}), Vec3(0, 0, 0));
    EXPECT_EQ(unit_or_zero({1, std::numeric_limits<double>::quiet_NaN(), 0}), Vec3(0, 0, 0));
    EXPECT_EQ(unit_or_zero({std::numeric_limits<double>::infinity(), 0, 0}), Vec3(0, 0, 0));
}

TEST(UnitVectors, AreTheRowsOfAColumnOfThreeNumbers) {
    ColumnTable columns;
    columns.add(Column("normal", 3, Buffer<float>(Array<float>{0, 0, 2, 0, 0, 0})));
    columns.add(Column("pair", 2, Buffer<float>(Array<float>{0, 1, 1, 0})));
    EXPECT_THAT(unit_vectors(columns, "normal"), ElementsAre(Vec3(0, 0, 1), Vec3(0, 0, 0)));
    EXPECT_THAT(unit_vectors(columns, "pair"), IsEmpty());
    EXPECT_THAT(unit_vectors(columns, "approach"), IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
