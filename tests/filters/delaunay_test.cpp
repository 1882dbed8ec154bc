// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/delaunay.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "scanmill/filter/error.hpp"
#include "scanmill/formats/files.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

DelaunayResult triangulated(const PointCloud& cloud, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return delaunay(cloud, {}, context);
}

Kernel::Point_3 exact(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

double six_volumes(const TetMesh& tets, u32 cell) {
    const auto& [a, b, c, d] = tets.cells[cell];
    const Vec3 u = tets.positions[b] - tets.positions[a], v = tets.positions[c] - tets.positions[a];
    return u.cross(v).dot(tets.positions[d] - tets.positions[a]);
}

double volume(const TetMesh& tets) {
    double sum = 0;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell) sum += six_volumes(tets, cell);
    return sum / 6;
}

/// Everything that tets.hpp promises, checked one by one.
void expect_canonical(const TetMesh& tets) {
    ASSERT_EQ(tets.neighbours.size(), tets.cells.size());
    EXPECT_TRUE(std::ranges::is_sorted(tets.cells));
    EXPECT_EQ(std::ranges::adjacent_find(tets.cells), tets.cells.end());
    std::map<std::array<u32, 3>, std::vector<u32>> cells_of_facet;
    for (u32 c = 0; c < tets.cells.size(); ++c) {
        const Tetrahedron& cell = tets.cells[c];
        ASSERT_EQ(*std::ranges::min_element(cell), cell[0]);
        ASSERT_LT(cell[1], std::min(cell[2], cell[3]));
        ASSERT_EQ(CGAL::orientation(exact(tets.positions[cell[0]]), exact(tets.positions[cell[1]]),
                                    exact(tets.positions[cell[2]]), exact(tets.positions[cell[3]])),
                  CGAL::POSITIVE);
        for (int i = 0; i < 4; ++i) {
            std::array<u32, 3> facet{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
            std::ranges::sort(facet);
            cells_of_facet[facet].push_back(c);
        }
    }
    for (u32 c = 0; c < tets.cells.size(); ++c)
        for (int i = 0; i < 4; ++i) {
            const Tetrahedron& cell = tets.cells[c];
            std::array<u32, 3> facet{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
            std::ranges::sort(facet);
            const std::vector<u32>& cells = cells_of_facet[facet];
            ASSERT_LE(cells.size(), 2u);
            const u32 expected = cells.size() == 1 ? TetMesh::outside_hull : cells[0] + cells[1] - c;
            ASSERT_EQ(tets.neighbours[c][i], expected);
        }
}

void expect_empty_spheres(const TetMesh& tets) {
    for (const auto& [a, b, c, d] : tets.cells)
        for (const Vec3& p : tets.positions)
            ASSERT_NE(CGAL::side_of_bounded_sphere(exact(tets.positions[a]), exact(tets.positions[b]),
                                                   exact(tets.positions[c]), exact(tets.positions[d]), exact(p)),
                      CGAL::ON_BOUNDED_SIDE);
}

void expect_equal_bytes(const TetMesh& a, const TetMesh& b) {
    ASSERT_EQ(a.cells.size(), b.cells.size());
    EXPECT_EQ(std::memcmp(a.cells.data(), b.cells.data(), a.cells.size() * sizeof(Tetrahedron)), 0);
    EXPECT_EQ(std::memcmp(a.neighbours.data(), b.neighbours.data(), a.cells.size() * 4 * sizeof(u32)), 0);
}

/// Cells as sets of places, whatever the vertices' numbers.
using Places = std::set<std::array<std::array<double, 3>, 4>>;
Places places(const TetMesh& tets) {
    Places result;
    for (const Tetrahedron& cell : tets.cells) {
        std::array<std::array<double, 3>, 4> corners;
        for (int i = 0; i < 4; ++i) std::copy_n(tets.positions[cell[i]].data(), 3, corners[i].begin());
        std::ranges::sort(corners);
        result.insert(corners);
    }
    return result;
}

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

TEST(Delaunay, AnyNumberOfThreads_GivesTheSameBytes) {
    for (const PointCloud& cloud : {random_cube(40000, 5), lattice_cube(24), fibonacci_sphere(30000, 1e-4)}) {
        const TetMesh one = triangulated(cloud, 1).tets;
        for (unsigned threads : {2u, 3u}) expect_equal_bytes(one, triangulated(cloud, threads).tets);
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

TEST(Delaunay, ManyDuplicates_AreTheSameForThreads) {
    const PointCloud base = random_cube(20000, 9);
    const PointCloud twice = shuffled(joined(base, base), 4);
    const DelaunayResult one = triangulated(twice, 1), two = triangulated(twice, 2);
    EXPECT_EQ(two.duplicates, 20000u);
    expect_equal_bytes(one.tets, two.tets);
    EXPECT_EQ(places(two.tets), places(triangulated(base).tets));
}

TEST(Delaunay, PlateUnderOnePoint_IsTheSameForThreads) {
    PointCloud cloud = joined(random_cube(12000, 3), cloud_of({{0.5, 0.5, 1}}));
    Array<Vec3> flat(cloud.positions.begin(), cloud.positions.end());
    for (std::size_t i = 0; i + 1 < flat.size(); ++i) flat[i].z() = 0;
    cloud.positions = std::move(flat);
    const TetMesh one = triangulated(cloud, 1).tets;
    expect_equal_bytes(one, triangulated(cloud, 2).tets);
    expect_canonical(one);
}

TEST(Delaunay, MinusZero_IsTheSamePlaceAsZero) {
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
    expect_equal_bytes(triangulated(cloud).tets, triangulated(moved(cloud, 0x1p-40)).tets);
    expect_equal_bytes(triangulated(cloud).tets, triangulated(moved(cloud, 0x1p40)).tets);
}

TEST(Delaunay, ThinSlab_IsAccepted_WhenItsThicknessIsMoreThanRounding) {
    const TetMesh tets = triangulated(rotated(flat_square(1e-9), 0.7)).tets;
    expect_canonical(tets);
    EXPECT_GT(volume(tets), 0);
    EXPECT_LT(volume(tets), 1e-9);
}

TEST(Delaunay, WhenCancelled_StopsWithCancelled) {
    int asked = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++asked > 3; };
    Context context(options);
    EXPECT_THROW(delaunay(random_cube(50000, 1), {}, context), Cancelled);
    EXPECT_LT(asked, 10);
}

TEST(Delaunay, WhenCancelledAmongThreads_StopsWithCancelled) {
    std::atomic<int> asked = 0;
    ContextOptions options;
    options.threads = 2;
    options.is_cancelled = [&] { return ++asked > 50; };
    Context context(options);
    EXPECT_THROW(delaunay(random_cube(50000, 1), {}, context), Cancelled);
    EXPECT_LT(asked, 60);
}

TEST(Delaunay, Progress_RisesToOne) {
    std::vector<double> fractions;
    ContextOptions options;
    options.on_progress = [&](double fraction) { fractions.push_back(fraction); };
    Context context(options);
    delaunay(random_cube(20000, 1), {}, context);
    ASSERT_GT(fractions.size(), 4u);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1);
}

TEST(Delaunay, Bunny_IsCanonicalAndFillsItsHull) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/bunny00.off");
    const auto cloud = read_points(path);
    ASSERT_EQ(cloud->size(), 37706u);
    const TetMesh tets = triangulated(*cloud, 2).tets;
    EXPECT_EQ(tets.positions.size(), 37706u);
    expect_canonical(tets);
    // The cells tile the hull, so their volumes sum to what the hull's outward facets enclose.
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
