// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/fit/covariance.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

TEST(Scatter, OfABoxsCorners_IsThatOfItsEdges) {
    // Variances along the axes are the squares of half the edges: 1, 4 and 9.
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) corners.push_back(Vec3(i & 1 ? 3 : -3, i & 2 ? 1 : -1, i & 4 ? 2 : -2) + Vec3(5, 6, 7));
    const Scatter scatter = scatter_of(corners);
    EXPECT_LT((scatter.centroid - Vec3(5, 6, 7)).norm(), 1e-14);
    EXPECT_LT((scatter.normal - Vec3(0, 1, 0)).norm(), 1e-12);
    EXPECT_NEAR(scatter.surface_variation, 1.0 / 14, 1e-14);
    EXPECT_NEAR(scatter.flatness, 36.0 / (13 * 13), 1e-14);
}

TEST(Scatter, OfAFlatSquare_HasNoRoughness) {
    const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    EXPECT_EQ(scatter_of(square).surface_variation, 0);
    EXPECT_NEAR(scatter_of(square).flatness, 0.25, 1e-15);
}

TEST(Scatter, OfPointsOnALine_HasANormalAcrossTheLine) {
    // The moments of points on a line have rounding errors only where the least two variances are.
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 along(random.normal(), random.normal(), random.normal());
        const Vec3 normal = scatter_of(std::vector<Vec3>{Vec3::Zero(), along, 0.31 * along}).normal;
        EXPECT_NEAR(normal.norm(), 1, 1e-12);
        EXPECT_NEAR(normal.dot(along.normalized()), 0, 1e-6);
    }
}

TEST(Scatter, OfOnePlace_IsNothing) {
    const Scatter scatter = scatter_of(std::vector<Vec3>(3, Vec3(1, 2, 3)));
    EXPECT_EQ(scatter.surface_variation, 0);
    EXPECT_EQ(scatter.normal, Vec3(0, 0, 1));
}

}  // namespace
}  // namespace scanmill
