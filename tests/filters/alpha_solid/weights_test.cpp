// SPDX-License-Identifier: GPL-3.0-or-later
// The alpha-solid of weighted points: its laws, the purpose of weights, and what is refused.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "filters/alpha_solid/weighted_cases.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"
#include "support/real_data.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(AlphaSolidWeights, EqualWeights_GiveTheResultOfNone) {
    for (const PointCloud& cloud : {fibonacci_sphere(300, 1e-3), lattice_cube(4, 0.1, true)}) {
        const AlphaSolidResult none = solid_of(cloud);
        const AlphaSolidResult equal =
            solid_of(weighted(with_weights(cloud, Array<double>(cloud.size(), 0.7)), weighted_by("w")).tets);
        EXPECT_EQ(equal.alpha, none.alpha);
        EXPECT_EQ(equal.alpha_cover, none.alpha_cover);
        EXPECT_TRUE(std::ranges::equal(equal.tets.inside, none.tets.inside));
        EXPECT_TRUE(std::ranges::equal(equal.mesh.triangles, none.mesh.triangles));
    }
}

TEST(AlphaSolidWeights, TheSameAmountAddedToAllWeights_ChangesRoundingAlone) {
    const PointCloud cloud = with_random_weights(fibonacci_sphere(200, 1e-3), 0x1p-10, 3);
    Array<double> heavier;
    for (double weight : cloud.columns.find("w")->values<double>()) heavier.push_back(weight + 0.5);
    const AlphaSolidResult one = solid_of(weighted(cloud, weighted_by("w")).tets);
    const AlphaSolidResult other =
        solid_of(weighted(with_weights(fibonacci_sphere(200, 1e-3), heavier), weighted_by("w")).tets);
    EXPECT_NEAR(other.alpha / one.alpha, 1, 1e-9);
    EXPECT_EQ(places(other.mesh), places(one.mesh));
}

TEST(AlphaSolidWeights, ScaleAndMotion_MoveTheSolidWithThePoints) {
    const PointCloud cloud = plate_with_a_hole();
    const AlphaSolidResult here = solid_of(weighted(cloud).tets);
    const AlphaSolidResult twice = solid_of(weighted(moved(cloud, 1024)).tets);
    EXPECT_EQ(twice.alpha, 1024 * here.alpha);
    EXPECT_TRUE(std::ranges::equal(twice.mesh.triangles, here.mesh.triangles));
    const AlphaSolidResult turned = solid_of(weighted(rotated(cloud, 0.6)).tets);
    EXPECT_NEAR(turned.alpha / here.alpha, 1, 1e-9);
    expect_closed(turned, cloud.size(), 0);
}

TEST(AlphaSolidWeights, AnyOrderAndThreads_GiveTheSameSolid) {
    const PointCloud cloud = plate_with_a_hole();
    const AlphaSolidResult one = solid_of(weighted(cloud).tets);
    const AlphaSolidResult three = solid_of(weighted(cloud, weighted_by("spacing"), 3).tets, {}, 3);
    EXPECT_EQ(three.alpha, one.alpha);
    EXPECT_TRUE(std::ranges::equal(three.mesh.triangles, one.mesh.triangles));
    for (std::uint64_t seed : {1, 2}) {
        const AlphaSolidResult other = solid_of(weighted(shuffled(cloud, seed)).tets);
        EXPECT_EQ(other.alpha, one.alpha);
        EXPECT_EQ(places(other.mesh), places(one.mesh));
    }
}

TEST(AlphaSolidWeights, OfManyCells_ThreadsGiveTheSameSolid) {
    // Walls between cells that different threads have computed.
    const PointCloud cloud = with_random_weights(fibonacci_sphere(8000, 1e-2), 1e-4, 5);
    const TetMesh tets = weighted(cloud, weighted_by("w")).tets;
    ASSERT_GT(tets.cells.size(), 3 * 8192u);
    const AlphaSolidResult one = solid_of(tets), three = solid_of(tets, {}, 3);
    EXPECT_EQ(three.alpha, one.alpha);
    EXPECT_TRUE(std::ranges::equal(three.tets.inside, one.tets.inside));
    EXPECT_TRUE(std::ranges::equal(three.mesh.triangles, one.mesh.triangles));
}

TEST(AlphaSolidWeights, AHiddenPoint_IsNeitherInteriorNorUncovered) {
    // The point in the middle of the regular tetrahedron is hidden, its corners are not.
    const PointCloud cloud =
        with_weights(cloud_of({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0, 0, 0}}), {4, 4, 4, 4, 0});
    const TetMesh tets = weighted(cloud, weighted_by("w")).tets;
    const AlphaSolidResult result = solid_of(tets);
    EXPECT_THAT(result.hidden_points.span(), testing::ElementsAre(4));
    EXPECT_EQ(result.interior_points.size(), 0u);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    EXPECT_EQ(result.tets.positions.size(), 5u);
    expect_closed(result, 4, 2);
    EXPECT_DOUBLE_EQ(result.alpha, std::sqrt(8.0 / 3)) << "the corners have the largest weight: their plain radius";
}

TEST(AlphaSolidWeights, EveryPoint_IsCountedOnce) {
    const PointCloud cloud = with_random_weights(random_cube(400, 1), 0.03, 1);
    Context context;
    const AlphaSolidResult result =
        alpha_solid(weighted(cloud, weighted_by("w")).tets, covering(60, AlphaComponents::many), context);
    EXPECT_GT(result.hidden_points.size(), 0u);
    EXPECT_GT(result.uncovered_points.size(), 0u);
    EXPECT_EQ(result.mesh.positions.size() + result.interior_points.size() + result.uncovered_points.size() +
                  result.hidden_points.size(),
              cloud.size());
    EXPECT_EQ(context.metrics().find("hidden-points")->value, static_cast<double>(result.hidden_points.size()));
}

TEST(AlphaSolidWeights, WeightsForSomePointsOnly_AreRefused) {
    TetMesh tets = weighted(random_cube(20, 1)).tets;
    tets.weights = {1, 2, 3};
    EXPECT_THAT(refusal(tets, {}), HasSubstr("needs a weight for each of 20 vertices, or no weights; there are 3"));
}

TEST(AlphaSolidWeights, NegativeAndNotFiniteWeights_AreRefusedWithTheirRange) {
    TetMesh tets = weighted(random_cube(20, 1)).tets;
    for (const double wrong : {-1.0, HUGE_VAL}) {
        Array<double> weights(20, 1.0);
        weights[3] = wrong;
        tets.weights = std::move(weights);
        EXPECT_THAT(refusal(tets, {}), testing::AllOf(HasSubstr("needs finite weights of 0 or more; these go from "),
                                                      HasSubstr("hint: ")));
    }
    tets.weights = Array<double>(20, std::nan(""));
    EXPECT_THAT(refusal(tets, {}), HasSubstr("needs finite weights of 0 or more"));
}

TEST(AlphaSolidWeights, AHoleNarrowerThanTheCoarseSpacing_StaysOpenWhereTheSamplingIsFine) {
    const PointCloud cloud = plate_with_a_hole();
    // One radius for all must be 0.7 to cover the plate, and a ball of that size does not enter a hole of 0.8.
    const AlphaSolidResult plain = solid_of(cloud);
    EXPECT_GE(plain.alpha, std::sqrt(0.5) * (1 - 1e-12));
    EXPECT_EQ(topology(plain.mesh).genus, 0u);
    EXPECT_GT(plain.interior_points.size(), 50u);
    EXPECT_NEAR(cell_volumes(plain), 200, 0.01);
    // With weights the ball is as small in the hole as its sampling allows.
    const AlphaSolidResult result = solid_of(weighted(cloud).tets);
    expect_closed(result, cloud.size(), 0);
    EXPECT_EQ(topology(result.mesh).genus, 1u);
    EXPECT_NEAR(cell_volumes(result), 200 - 0.8 * 0.8 * 2, 0.01);
    EXPECT_EQ(result.choice, AlphaChoice::scan);
}

TEST(AlphaSolidWeights, ARealScan_HidesNoPoint_AndHasFewerPointsInside) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/bunny00.off");
    const auto cloud = read_points(path);
    const TetMesh tets = weighted(*cloud).tets;
    EXPECT_EQ(hidden_vertices(tets).size(), 0u);
    const AlphaSolidResult plain = solid_of(*cloud), result = solid_of(tets, {}, 2);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    EXPECT_LT(result.interior_points.size(), plain.interior_points.size());
}

}  // namespace
}  // namespace scanmill
