// SPDX-License-Identifier: GPL-3.0-or-later
// Weighted points: the cells are those of the regular triangulation, for any order of the points.

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

#include "filters/alpha_solid/weighted_cases.hpp"
#include "filters/delaunay/regular_cells.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

double volume(const TetMesh& tets) {
    double sum = 0;
    for (const auto& [a, b, c, d] : tets.cells) {
        const Vec3 u = tets.positions[b] - tets.positions[a], v = tets.positions[c] - tets.positions[a];
        sum += u.cross(v).dot(tets.positions[d] - tets.positions[a]) / 6;
    }
    return sum;
}

PointCloud reordered(const PointCloud& cloud, std::uint64_t seed) {
    std::vector<u32> rows(cloud.size());
    std::iota(rows.begin(), rows.end(), 0);
    Random random(seed);
    for (std::size_t i = rows.size(); i > 1; --i) std::swap(rows[i - 1], rows[random.index(i)]);
    return gather(cloud, rows);
}

/// Weights that are few whole numbers on a lattice: everything is a tie.
PointCloud lattice_with_ties(u32 n, std::uint64_t seed) {
    const PointCloud cloud = lattice_cube(n);
    Random random(seed);
    Array<double> weights(cloud.size());
    for (double& weight : weights) weight = static_cast<double>(random.index(3));
    return with_weights(cloud, std::move(weights));
}

TEST(DelaunayWeights, APointInTheMiddle_IsHiddenByHeavyCorners_AndNotByLightOnes) {
    // A regular tetrahedron with corners at squared distance 3 from the middle: hidden when their weight is above
    // the middle's by more than 3.
    const PointCloud cloud = cloud_of({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0, 0, 0}});
    const DelaunayResult seen = weighted(with_weights(cloud, {3.5, 3.5, 3.5, 3.5, 0.75}), weighted_by("w"));
    EXPECT_EQ(seen.hidden, 0u);
    EXPECT_EQ(seen.tets.cells.size(), 4u);

    Context context;
    const DelaunayResult hides = delaunay(with_weights(cloud, {3.5, 3.5, 3.5, 3.5, 0.25}), weighted_by("w"), context);
    EXPECT_EQ(hides.hidden, 1u);
    EXPECT_EQ(hides.tets.cells.size(), 1u);
    ASSERT_EQ(hides.tets.positions.size(), 5u) << "hidden points are kept";
    EXPECT_THAT(hides.tets.vertex_columns.find("hidden")->values<u8>(), ElementsAre(0, 0, 0, 0, 1));
    EXPECT_THAT(hides.tets.weights.span(), ElementsAre(3.5, 3.5, 3.5, 3.5, 0.25));
    EXPECT_EQ(context.metrics().find("hidden")->value, 1);
    ASSERT_EQ(context.warnings().size(), 1u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("1 of 5 points is hidden"));
    // The factor counts: 0.5 · (3.5 - 0.25) is below 3.
    EXPECT_EQ(weighted(with_weights(cloud, {3.5, 3.5, 3.5, 3.5, 0.25}), weighted_by("w", 0.5)).hidden, 0u);
}

TEST(DelaunayWeights, OfTwoDiagonals_TheHeavyOneIsAnEdge) {
    // Without weights, the position of the last corner decides; here a tiny weight does.
    const PointCloud square = cloud_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 9}});
    const auto has_edge = [](const TetMesh& tets, u32 a, u32 b) {
        return std::ranges::any_of(tets.cells, [&](const Tetrahedron& cell) {
            return std::ranges::find(cell, a) != cell.end() && std::ranges::find(cell, b) != cell.end();
        });
    };
    const TetMesh one = weighted(with_weights(square, {1e-9, 0, 1e-9, 0, 0}), weighted_by("w")).tets;
    EXPECT_TRUE(has_edge(one, 0, 2));
    EXPECT_FALSE(has_edge(one, 1, 3));
    const TetMesh other = weighted(with_weights(square, {0, 1e-9, 0, 1e-9, 0}), weighted_by("w")).tets;
    EXPECT_TRUE(has_edge(other, 1, 3));
}

TEST(DelaunayWeights, RandomWeights_GiveTheRegularTriangulation) {
    for (std::uint64_t seed : {1, 2, 3}) {
        const PointCloud cloud = with_random_weights(random_cube(250, seed), 0.02, seed);
        const DelaunayResult result = weighted(cloud, weighted_by("w"));
        EXPECT_GT(result.hidden, 0u);
        expect_regular(result.tets);
        EXPECT_NEAR(volume(result.tets), volume(weighted(cloud, weighted_by("w", 0)).tets), 1e-12);
    }
}

TEST(DelaunayWeights, Ties_GiveTheSameCellsInAnyOrder) {
    for (std::uint64_t seed : {1, 2, 3}) {
        const PointCloud cloud = lattice_with_ties(4, seed);
        const DelaunayResult first = weighted(cloud, weighted_by("w"));
        expect_regular(first.tets);
        EXPECT_NEAR(volume(first.tets), 64, 1e-11);
        EXPECT_GT(first.hidden, 0u);
        for (std::uint64_t order : {11, 12, 13, 14, 15, 16}) {
            const DelaunayResult other = weighted(reordered(cloud, order), weighted_by("w"));
            EXPECT_EQ(other.hidden, first.hidden);
            EXPECT_EQ(cell_places(other.tets), cell_places(first.tets));
        }
    }
}

TEST(DelaunayWeights, EqualWeights_GiveTheBytesOfNone) {
    for (const PointCloud& cloud : {random_cube(500, 1), lattice_cube(5), lattice_cube(6, 0.1, true),
                                    fibonacci_sphere(400), rotated(lattice_cube(3), 0.4)}) {
        const TetMesh none = weighted(cloud, {}).tets;
        EXPECT_TRUE(none.weights.empty());
        for (double weight : {0.0, 0.25, 1e9}) {
            const DelaunayResult equal =
                weighted(with_weights(cloud, Array<double>(cloud.size(), weight)), weighted_by("w"));
            EXPECT_EQ(equal.hidden, 0u);
            expect_same_cells(equal.tets, none);
        }
    }
}

TEST(DelaunayWeights, Duplicates_AreMergedIntoTheFirst_WithTheLargestWeight) {
    PointCloud cloud = with_weights(
        cloud_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {4, 0, 0}, {0, 4, 0}, {0, 4, 0}}), {1, 2, 3, 4, 5, 0, 3});
    cloud.columns.add(Column("row", 1, Buffer<u32>{0, 1, 2, 3, 4, 5, 6}));
    Context context;
    const DelaunayResult result = delaunay(cloud, weighted_by("w"), context);
    EXPECT_EQ(result.duplicates, 3u);
    EXPECT_THAT(result.tets.vertex_columns.find("row")->values<u32>(), ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(result.tets.vertex_columns.find("w")->values<double>(), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(result.tets.weights.span(), ElementsAre(1, 5, 3, 4));
    ASSERT_EQ(context.warnings().size(), 1u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("at 2 positions points with different weights were merged"));
    // Repeating a scan changes no spacing.
    const PointCloud base = random_cube(200, 4);
    expect_same_cells(weighted(joined(base, base)).tets, weighted(base).tets);
}

TEST(DelaunayWeights, AColumnCalledHidden_IsRenamedWhenPointsAreHidden) {
    PointCloud cloud = cloud_of({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0, 0, 0}});
    cloud.columns.add(Column("hidden", 1, Buffer<float>(Array<float>(5, 7.0f))));
    cloud.columns.add(Column("hidden-of-points", 1, Buffer<u8>(Array<u8>(5, u8(9)))));
    Context context;
    const ColumnTable columns =
        delaunay(with_weights(cloud, {3.5, 3.5, 3.5, 3.5, 0.25}), weighted_by("w"), context).tets.vertex_columns;
    EXPECT_EQ(columns.find("hidden")->type(), ScalarType::uint8);
    EXPECT_EQ(columns.find("hidden-of-points")->number(0), 9);
    EXPECT_EQ(columns.find("hidden-of-points-of-points")->number(0), 7);
    EXPECT_THAT(context.warnings()[0], HasSubstr("it was renamed 'hidden-of-points-of-points'"));

    const DelaunayResult seen = weighted(with_weights(cloud, {3.5, 3.5, 3.5, 3.5, 0.75}), weighted_by("w"));
    EXPECT_EQ(seen.tets.vertex_columns.find("hidden")->number(0), 7) << "unchanged when no point is hidden";
}

TEST(DelaunayWeights, AFactorWithoutWeights_IsReported) {
    Context context;
    delaunay(random_cube(20, 1), {std::nullopt, 2}, context);
    ASSERT_EQ(context.warnings().size(), 1u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("factor has no effect while `weights` is none"));
}

}  // namespace
}  // namespace scanmill
