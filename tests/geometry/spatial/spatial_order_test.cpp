// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/spatial_order.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

#include "support/shapes.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;

std::vector<u32> order_of(std::initializer_list<Vec3> positions) {
    const auto rows = spatial_order(test::cloud_of(positions).positions.span());
    return {rows.begin(), rows.end()};
}

TEST(SpatialOrder, CornersOfACube_FollowTheMortonCurve) {
    // x counts least, z most.
    EXPECT_THAT(order_of({{1, 1, 1}, {0, 1, 1}, {1, 0, 1}, {0, 0, 1}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}}),
                ElementsAre(7, 6, 5, 4, 3, 2, 1, 0));
}

TEST(SpatialOrder, EqualPositions_KeepTheirOrder) {
    EXPECT_THAT(order_of({{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}}), ElementsAre(1, 3, 0, 2));
    EXPECT_THAT(order_of({{2, 2, 2}, {2, 2, 2}}), ElementsAre(0, 1));
}

TEST(SpatialOrder, NoPositions_HaveNoOrder) { EXPECT_THAT(order_of({}), ElementsAre()); }

TEST(SpatialOrder, ManyPoints_AreEachNamedOnceAndNearTheirNeighbours) {
    // 30,000 and 10,000 points: sorted by digits, and by comparison.
    for (std::size_t count : {30'000, 10'000}) {
        const PointCloud cloud = test::random_cube(count, 1);
        Array<u32> rows = spatial_order(cloud.positions.span());
        double length = 0;
        for (std::size_t i = 1; i < rows.size(); ++i)
            length += (cloud.positions[rows[i]] - cloud.positions[rows[i - 1]]).norm();
        // A random order steps 0.66 on average, this about the spacing of 1 / ∛count.
        EXPECT_LT(length / static_cast<double>(count), 0.1);
        std::ranges::sort(rows);
        Array<u32> all(count);
        std::iota(all.begin(), all.end(), 0);
        EXPECT_EQ(rows, all);
    }
}

}  // namespace
}  // namespace scanmill
