// SPDX-License-Identifier: GPL-3.0-or-later
// Weighted points: the cells are those of the regular triangulation, whatever the order of the points.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <set>

#include "filters/weighted_cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Weighted_point_3 exact(const TetMesh& tets, u32 vertex) {
    const Vec3& p = tets.positions[vertex];
    return {Kernel::Point_3(p.x(), p.y(), p.z()), tets.weights[vertex]};
}

/// The definition, exactly: no vertex, hidden or not, has a negative power to the sphere orthogonal to a cell.
void expect_regular(const TetMesh& tets) {
    ASSERT_EQ(tets.weights.size(), tets.positions.size());
    const auto side = Kernel().power_side_of_oriented_power_sphere_3_object();
    for (const auto& [a, b, c, d] : tets.cells)
        for (u32 p = 0; p < tets.positions.size(); ++p)
            ASSERT_NE(side(exact(tets, a), exact(tets, b), exact(tets, c), exact(tets, d), exact(tets, p)),
                      CGAL::ON_POSITIVE_SIDE);
}

double volume(const TetMesh& tets) {
    double sum = 0;
    for (const auto& [a, b, c, d] : tets.cells) {
        const Vec3 u = tets.positions[b] - tets.positions[a], v = tets.positions[c] - tets.positions[a];
        sum += u.cross(v).dot(tets.positions[d] - tets.positions[a]) / 6;
    }
    return sum;
}

template <class T>
bool same_bytes(const Buffer<T>& a, const Buffer<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}
void expect_same_cells(const TetMesh& a, const TetMesh& b) {
    EXPECT_TRUE(same_bytes(a.cells, b.cells));
    EXPECT_TRUE(same_bytes(a.neighbours, b.neighbours));
}

/// Cells as sets of places, whatever the vertices' numbers.
std::set<std::array<Point, 4>> cell_places(const TetMesh& tets) {
    std::set<std::array<Point, 4>> result;
    for (const Tetrahedron& cell : tets.cells) {
        std::array<Point, 4> corners;
        for (int i = 0; i < 4; ++i) corners[i] = point(tets.positions[cell[i]]);
        std::ranges::sort(corners);
        result.insert(corners);
    }
    return result;
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
    EXPECT_THAT(context.warnings()[0], HasSubstr("1 of 5 points are hidden"));
    // The factor counts: 0.5 · (3.5 - 0.25) is below 3.
    EXPECT_EQ(weighted(with_weights(cloud, {3.5, 3.5, 3.5, 3.5, 0.25}), weighted_by("w", 0.5)).hidden, 0u);
}

TEST(DelaunayWeights, OfTwoDiagonals_TheHeavyOneIsAnEdge) {
    // Without weights, the place of the last corner decides; here a hair of weight does.
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

TEST(DelaunayWeights, Spacing_IsTheMeanOfSixNeighbours) {
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
    // Of five points each has only four others.
    const TetMesh few = weighted(cloud_of({{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {0, 0, 10}})).tets;
    EXPECT_DOUBLE_EQ(few.weights[0], std::pow((3 + 3 + 3 + 10) / 4.0, 2));
}

TEST(DelaunayWeights, Spacing_IsLoweredToWhatNeighboursAllow_SoThatNothingIsHidden) {
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
        EXPECT_GT(at_their_limit, 10u) << "the closure is the largest: something holds every lowered weight";
        expect_regular(result.tets);
    }
}

TEST(DelaunayWeights, TwoVeryNearPoints_HaveNearlyTheSameWeight) {
    PointCloud cloud = joined(lattice_cube(3), cloud_of({{1.0 + 0x1p-10, 1, 1}}));
    const DelaunayResult result = weighted(cloud);
    EXPECT_EQ(result.hidden, 0u);
    EXPECT_NEAR(result.tets.weights[1 + 4 + 16], result.tets.weights[64], 0.9 * 0x1p-20 + 1e-15);
}

TEST(DelaunayWeights, AnyOrderAndAnyThreads_GiveTheSameWeights) {
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

TEST(DelaunayWeights, ScaledByAPowerOfTwo_WeightsScaleByItsSquare) {
    const PointCloud cloud = random_cube(400, 3);
    const TetMesh here = weighted(cloud).tets;
    for (int exponent : {-20, 20}) {
        const TetMesh there = weighted(moved(cloud, std::ldexp(1, exponent))).tets;
        expect_same_cells(here, there);
        for (u32 i = 0; i < cloud.size(); ++i) ASSERT_EQ(there.weights[i], std::ldexp(here.weights[i], 2 * exponent));
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
    EXPECT_THAT(context.warnings()[0], HasSubstr("at 2 places points with different weights were merged"));
    // Repeating a scan changes no spacing.
    const PointCloud base = random_cube(200, 4);
    expect_same_cells(weighted(joined(base, base)).tets, weighted(base).tets);
}

TEST(DelaunayWeights, AColumnHidden_IsKeptUnderAnotherNameWhenOneIsNeeded) {
    PointCloud cloud = cloud_of({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0, 0, 0}});
    cloud.columns.add(Column("hidden", 1, Buffer<float>(Array<float>(5, 7.0f))));
    cloud.columns.add(Column("hidden-of-points", 1, Buffer<u8>(Array<u8>(5, u8(9)))));
    Context context;
    const ColumnTable columns =
        delaunay(with_weights(cloud, {3.5, 3.5, 3.5, 3.5, 0.25}), weighted_by("w"), context).tets.vertex_columns;
    EXPECT_EQ(columns.find("hidden")->type(), ScalarType::uint8);
    EXPECT_EQ(columns.find("hidden-of-points")->number(0), 9);
    EXPECT_EQ(columns.find("hidden-of-points-of-points")->number(0), 7);
    EXPECT_THAT(context.warnings()[0], HasSubstr("it is called 'hidden-of-points-of-points' now"));

    const DelaunayResult seen = weighted(with_weights(cloud, {3.5, 3.5, 3.5, 3.5, 0.75}), weighted_by("w"));
    EXPECT_EQ(seen.tets.vertex_columns.find("hidden")->number(0), 7) << "untouched when nothing is hidden";
}

TEST(DelaunayWeights, AFactorWithoutWeights_IsTold) {
    Context context;
    delaunay(random_cube(20, 1), {std::nullopt, 2}, context);
    ASSERT_EQ(context.warnings().size(), 1u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("factor changes nothing while `weights` is none"));
}

}  // namespace
}  // namespace scanmill
