// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>

#include "filters/delaunay/checks.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/files.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
TEST(Delaunay, FourPoints_GiveTheirTetrahedron) {
    const TetMesh tets = triangulated(cloud_of({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}})).tets;
    ASSERT_EQ(tets.cells.size(), 1u);
    // (0, 1, 2, 3) would be negative: y × x points down, away from the fourth point.
    EXPECT_EQ(tets.cells[0], (Tetrahedron{0, 1, 3, 2}));
    for (u32 neighbour : tets.neighbours[0]) EXPECT_EQ(neighbour, TetMesh::outside_hull);
}

TEST(Delaunay, TwoPointsAcrossATriangle_GiveTwoCellsThatShareIt) {
    const TetMesh tets =
        triangulated(cloud_of({{1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}, {0, 0, 2}, {0, 0, -2}})).tets;
    ASSERT_EQ(tets.cells.size(), 2u);
    EXPECT_EQ(tets.cells[0], (Tetrahedron{0, 1, 2, 3}));
    EXPECT_EQ(tets.cells[1], (Tetrahedron{0, 1, 4, 2}));
    EXPECT_EQ(tets.neighbours[0],
              (std::array<u32, 4>{TetMesh::outside_hull, TetMesh::outside_hull, TetMesh::outside_hull, 1}));
    EXPECT_EQ(tets.neighbours[1][2], 0u);
}

TEST(Delaunay, RandomPoints_AreCanonicalEmptyAndFillTheirHull) {
    for (std::uint64_t seed : {1, 2, 3}) {
        const TetMesh tets = triangulated(random_cube(300, seed)).tets;
        expect_canonical(tets);
        expect_empty_spheres(tets);
        std::set<u32> used;
        for (const Tetrahedron& cell : tets.cells) used.insert(cell.begin(), cell.end());
        EXPECT_EQ(used.size(), 300u);
    }
}

TEST(Delaunay, LatticePoints_AreCanonicalEmptyAndFillTheCube) {
    const TetMesh tets = triangulated(lattice_cube(4)).tets;
    expect_canonical(tets);
    expect_empty_spheres(tets);
    EXPECT_DOUBLE_EQ(volume(tets), 64);
}

TEST(Delaunay, CosphericalPoints_GiveTheSameCellsInAnyOrder) {
    for (const PointCloud& cloud : {lattice_cube(4), lattice_cube(6, 0.1, true), fibonacci_sphere(400)}) {
        const Places expected = places(triangulated(cloud).tets);
        for (std::uint64_t seed : {1, 2, 3, 4}) EXPECT_EQ(places(triangulated(shuffled(cloud, seed)).tets), expected);
    }
}

TEST(Delaunay, Duplicates_AreMergedIntoTheFirstAndCounted) {
    const PointCloud base = random_cube(50, 7);
    PointCloud cloud = joined(joined(base, base), base);
    cloud.positions = gather(cloud.positions, std::vector<u32>{3, 53, 0, 103, 1, 2, 50, 4, 4, 5, 6});
    cloud.columns.add(Column("row", 1, Buffer<u32>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
    cloud.frame = {LengthUnit::millimetre, Vec3(100, 0, 0), "part"};
    const DelaunayResult result = triangulated(cloud);
    EXPECT_EQ(result.duplicates, 4u);
    EXPECT_EQ(result.hidden, 0u);
    const Column* rows = result.tets.vertex_columns.find("row");
    ASSERT_NE(rows, nullptr);
    EXPECT_THAT(rows->values<u32>(), testing::ElementsAre(0, 2, 4, 5, 7, 9, 10));
    EXPECT_EQ(result.tets.positions[1], base.positions[0]);
    EXPECT_EQ(result.tets.frame, cloud.frame);
    expect_canonical(result.tets);
}

TEST(Delaunay, ManyDuplicates_LeaveTheTriangulationOfTheDistinctPoints) {
    const PointCloud base = random_cube(2000, 9);
    Context context;
    const DelaunayResult result = delaunay(joined(base, shuffled(base, 3)), {}, context);
    EXPECT_EQ(result.duplicates, 2000u);
    expect_equal_bytes(result.tets, triangulated(base).tets);
    EXPECT_EQ(context.metrics().find("duplicates")->value, 2000);
    EXPECT_EQ(context.metrics().find("cells")->value, static_cast<double>(result.tets.cells.size()));
    EXPECT_EQ(context.metrics().find("hidden")->value, 0);
}

TEST(Delaunay, MinusZero_IsTheSamePositionAsZero) {
    const DelaunayResult result = triangulated(cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-0.0, 0, -0.0}}));
    EXPECT_EQ(result.duplicates, 1u);
}

TEST(Delaunay, FarFromTheOrigin_GivesTheSameCellsWhenNoBitIsLost) {
    const PointCloud cloud = lattice_cube(5, 0.25);
    const TetMesh here = triangulated(cloud).tets;
    const TetMesh there = triangulated(moved(cloud, 1, Vec3(1 << 20, -(1 << 21), 1 << 19))).tets;
    expect_equal_bytes(here, there);
}

TEST(Delaunay, ScaledByAPowerOfTwo_GivesTheSameCells) {
    const PointCloud cloud = random_cube(500, 3);
    expect_equal_bytes(triangulated(cloud).tets, triangulated(moved(cloud, 0x1p-29)).tets);
    expect_equal_bytes(triangulated(cloud).tets, triangulated(moved(cloud, 0x1p29)).tets);
}

TEST(Delaunay, ThinSlab_IsAccepted_WhenItsThicknessIsMoreThanRounding) {
    const TetMesh tets = triangulated(rotated(flat_square(1e-9), 0.7)).tets;
    expect_canonical(tets);
    EXPECT_GT(volume(tets), 0);
    EXPECT_LT(volume(tets), 1e-9);
}

TEST(Delaunay, Bunny_IsCanonicalAndFillsItsHull) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/bunny00.off");
    const auto cloud = read_points(path);
    ASSERT_EQ(cloud->size(), 37706u);
    const TetMesh tets = triangulated(*cloud, 2).tets;
    EXPECT_EQ(tets.positions.size(), 37706u);
    expect_canonical(tets);
    // The cells tile the hull, so their volumes sum to the volume that the outward facets of the hull enclose.
    double six_enclosed = 0;
    for (u32 c = 0; c < tets.cells.size(); ++c)
        for (int i = 0; i < 4; ++i) {
            if (tets.neighbours[c][i] != TetMesh::outside_hull) continue;
            const auto& [j, k, l] = outward_facet[i];
            six_enclosed += tets.positions[tets.cells[c][j]]
                                .cross(tets.positions[tets.cells[c][k]])
                                .dot(tets.positions[tets.cells[c][l]]);
        }
    EXPECT_NEAR(volume(tets), six_enclosed / 6, 1e-12);
}

}  // namespace
}  // namespace scanmill
