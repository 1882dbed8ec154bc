// SPDX-License-Identifier: GPL-3.0-or-later
// Weights from the local spacing: closed forms, limits by neighbours, any order and scale.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "filters/alpha_solid/weighted_cases.hpp"
#include "filters/delaunay/regular_cells.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(DelaunaySpacing, Weights_IsTheMeanOfSixNeighbours) {
    // In the middle of a lattice all six are at distance 1.
    const TetMesh tets = weighted(lattice_cube(4)).tets;
    for (u32 vertex = 0; vertex < tets.positions.size(); ++vertex) {
        const Vec3& p = tets.positions[vertex];
        const bool inner = p.minCoeff() > 0 && p.maxCoeff() < 4;
        if (inner) {
            EXPECT_EQ(tets.weights[vertex], 1);
        }
        // A corner has three neighbours along the edges and three across the faces.
        if (p == Vec3::Zero()) {
            EXPECT_DOUBLE_EQ(tets.weights[vertex], std::pow((1 + std::sqrt(2)) / 2, 2));
        }
    }
    // With five points, each has only four others.
    const TetMesh few = weighted(cloud_of({{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {0, 0, 10}})).tets;
    EXPECT_DOUBLE_EQ(few.weights[0], std::pow((3 + 3 + 3 + 10) / 4.0, 2));
}

TEST(DelaunaySpacing, Weights_IsLoweredToWhatNeighboursAllow_SoThatNoPointIsHidden) {
    for (double factor : {0.5, 1.0, 4.0}) {
        const PointCloud blob = joined(random_cube(300, 1), moved(random_cube(300, 2), 0.05, Vec3(0.4, 0.4, 0.4)));
        const DelaunayResult result = weighted(blob, weighted_by("spacing", factor));
        EXPECT_EQ(result.hidden, 0u);
        std::size_t at_their_limit = 0;
        for (u32 i = 0; i < blob.size(); ++i) {
            double allowed = HUGE_VAL;
            for (u32 j = 0; j < blob.size(); ++j)
                if (j != i)
                    allowed = std::min(
                        allowed, result.tets.weights[j] + 0.9 * (blob.positions[j] - blob.positions[i]).squaredNorm());
            ASSERT_LE(result.tets.weights[i], allowed * (1 + 1e-14));
            at_their_limit += result.tets.weights[i] >= allowed * (1 - 1e-14);
        }
        EXPECT_GT(at_their_limit, 10u) << "it is the largest solution: every lowered weight is at a limit";
        expect_regular(result.tets);
    }
}

TEST(DelaunaySpacing, TwoVeryNearPoints_HaveNearlyTheSameWeight) {
    PointCloud cloud = joined(lattice_cube(3), cloud_of({{1.0 + 0x1p-10, 1, 1}}));
    const DelaunayResult result = weighted(cloud);
    EXPECT_EQ(result.hidden, 0u);
    EXPECT_NEAR(result.tets.weights[1 + 4 + 16], result.tets.weights[64], 0.9 * 0x1p-20 + 1e-15);
}

TEST(DelaunaySpacing, AnyOrderAndAnyThreads_GiveTheSameWeights) {
    const PointCloud cloud = joined(random_cube(3000, 1), moved(random_cube(3000, 2), 0.1));
    const TetMesh one = weighted(cloud).tets;
    const TetMesh three = weighted(cloud, weighted_by("spacing"), 3).tets;
    expect_same_cells(one, three);
    EXPECT_TRUE(same_bytes(one.weights, three.weights));
    std::vector<u32> backwards(cloud.size());
    std::iota(backwards.rbegin(), backwards.rend(), 0);
    const TetMesh turned = weighted(gather(cloud, backwards)).tets;
    EXPECT_TRUE(same_bytes(gather(turned.weights, backwards), one.weights));
    EXPECT_EQ(cell_places(turned), cell_places(one));
}

TEST(DelaunaySpacing, ScaledByAPowerOfTwo_WeightsScaleByItsSquare) {
    const PointCloud cloud = random_cube(400, 3);
    const TetMesh here = weighted(cloud).tets;
    for (int exponent : {-20, 20}) {
        const TetMesh there = weighted(moved(cloud, std::ldexp(1, exponent))).tets;
        expect_same_cells(here, there);
        for (u32 i = 0; i < cloud.size(); ++i) ASSERT_EQ(there.weights[i], std::ldexp(here.weights[i], 2 * exponent));
    }
}

TEST(DelaunaySpacing, AColumnOfThatName_IsNotReadWithAWarning) {
    PointCloud cloud = random_cube(20, 1);
    cloud.columns.add(Column("spacing", 1, Buffer<float>(Array<float>(20, 7.0f))));
    Context context;
    const TetMesh tets = delaunay(cloud, weighted_by("spacing"), context).tets;
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("the points' column 'spacing' is not read")));
    EXPECT_TRUE(same_bytes(tets.weights, weighted(random_cube(20, 1)).tets.weights));
}

}  // namespace
}  // namespace scanmill
