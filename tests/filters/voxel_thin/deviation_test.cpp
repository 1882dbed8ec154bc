// SPDX-License-Identifier: GPL-3.0-or-later
/// The distance between the scan and a triangulation of the kept points stays within the tolerance.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "alpha_solid/alpha_solid.hpp"
#include "delaunay/delaunay.hpp"
#include "filters/voxel_thin/cases.hpp"
#include "region_grow/region_grow.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "sculpt/sculpt.hpp"
#include "support/shapes.hpp"
#include "voxel_thin/local_sizes.hpp"

namespace scanmill::test {
namespace {

using Rule = VoxelThinParams::Rule;

double largest_distance(std::span<const Vec3> points, std::span<const Vec3> corners,
                        std::span<const Triangle> triangles) {
    const TriangleTree tree(corners, triangles, 1);
    double largest = 0;
    for (const Vec3& p : points) largest = std::max(largest, tree.nearest(p).squared_distance);
    return std::sqrt(largest);
}

/// The solid that the points enclose. On a convex surface all points are its vertices.
TriangleMesh solid_of(const PointCloud& points) {
    Context context;
    const DelaunayResult cells = delaunay(points, {}, context);
    return sculpt(alpha_solid(cells.tets, {}, context).tets, {}, context).mesh;
}

double deviation_from_solid(const PointCloud& scan, const PointCloud& kept) {
    const TriangleMesh mesh = solid_of(kept);
    return largest_distance(scan.positions.span(), mesh.positions.span(), mesh.triangles.span());
}

PointCloud random_torus(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    Array<Vec3> points;
    while (points.size() < count) {
        const double around = random.uniform(0, 2 * std::numbers::pi), along = random.uniform(0, 2 * std::numbers::pi);
        const double from_axis = 1 + 0.4 * std::cos(along);
        if (random.uniform(0, 1.4) > from_axis) continue;  // area grows with the distance from the axis
        points.push_back({from_axis * std::cos(around), from_axis * std::sin(around), 0.4 * std::sin(along)});
    }
    return {{}, std::move(points), {}};
}

/// The side of a cylinder of radius 1.
PointCloud random_cylinder(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    Array<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        const double turn = random.uniform(-std::numbers::pi, std::numbers::pi);
        points.push_back({std::cos(turn), std::sin(turn), random.uniform(-1, 1)});
    }
    return {{}, std::move(points), {}};
}

/// Distance from the Delaunay triangulation of the unrolled cylinder, away from its boundary and seam.
double deviation_on_cylinder(const PointCloud& scan, const PointCloud& kept) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Vertex = CGAL::Triangulation_vertex_base_with_info_2<u32, Kernel>;
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex>> unrolled;
    const auto turn = [](const Vec3& p) { return std::atan2(p.y(), p.x()); };
    for (u32 i = 0; i < kept.size(); ++i) unrolled.insert({turn(kept.positions[i]), kept.positions[i].z()})->info() = i;
    Array<Triangle> triangles;
    for (const auto& face : unrolled.finite_face_handles())
        triangles.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    std::vector<Vec3> inner;
    for (const Vec3& p : scan.positions)
        if (std::abs(p.z()) < 0.7 && std::abs(turn(p)) < 2.7) inner.push_back(p);
    return largest_distance(inner, kept.positions.span(), triangles);
}

constexpr std::uint64_t seeds = 3;
/// Where the scan is dense, kept points lie near their voxels' centres, so the bound is never reached.
constexpr double usual_share = 0.5;

/// Distance from the mesh that region-grow makes of the kept points, away from the boundary of an open surface.
double deviation_from_growth(const PointCloud& scan, const PointCloud& kept, double highest) {
    Context context;
    const TriangleMesh mesh = region_grow(kept, {}, context).mesh;
    std::vector<Vec3> inner;
    std::ranges::copy_if(scan.positions, std::back_inserter(inner),
                         [&](const Vec3& p) { return std::abs(p.z()) < highest; });
    return largest_distance(inner, mesh.positions.span(), mesh.triangles.span());
}

using Deviation = double (*)(const PointCloud& scan, const PointCloud& kept);

/// `highest`: only points whose z is nearer 0 are compared with the mesh of region-grow.
void expect_kept(const PointCloud& scan, double tolerance, Deviation deviation, double highest) {
    SCOPED_TRACE(tolerance);
    const VoxelThinResult result = thin(scan, within(tolerance));
    ASSERT_GT(result.removed, scan.size() / 2);
    EXPECT_LE(deviation(scan, result.points), usual_share * tolerance);
    EXPECT_LE(deviation_from_growth(scan, result.points, highest), tolerance);
}

TEST(VoxelThinDeviation, OfASphere_StaysWithinTheTolerance) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed)
        for (const double tolerance : {0.01, 0.04})
            expect_kept(random_sphere(20'000, seed), tolerance, deviation_from_solid, 2);
}

TEST(VoxelThinDeviation, OfATorus_StaysWithinTheTolerance) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed)
        for (const double tolerance : {0.008, 0.02})
            expect_kept(random_torus(30'000, seed), tolerance, deviation_from_solid, 2);
}

TEST(VoxelThinDeviation, OfACylinder_StaysWithinTheTolerance) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed)
        for (const double tolerance : {0.005, 0.02})
            expect_kept(random_cylinder(20'000, seed), tolerance, deviation_on_cylinder, 0.7);
}

/// By hand: two voxels that share a corner, each with a point in the corner farthest from the other voxel.
TEST(VoxelThinDeviation, PointsInAdjacentVoxels_AreWithinTheAllowedEdgeOnlyWithTheGuaranteeForPoints) {
    const double edge = 1;
    for (const auto guarantee : {VoxelThinParams::Guarantee::points, VoxelThinParams::Guarantee::centres}) {
        const double size = voxel::size_for_edge(edge, guarantee);
        const VoxelThinResult result = thin(cloud_of({{0, 0, 0}, Vec3::Constant(1.99 * size)}), voxels_of(size));
        ASSERT_EQ(result.kept.size(), 2u);
        const double distance = (result.points.positions[0] - result.points.positions[1]).norm();
        EXPECT_EQ(distance <= edge, guarantee == VoxelThinParams::Guarantee::points) << distance;
    }
}

/// Leaves vary from tips of radius 1/4 to a waist eight times as flat.
TEST(VoxelThinDeviation, OfAnEllipsoidThinnedAdaptively_StaysWithinTheTolerance) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        Array<Vec3> points;
        for (const Vec3& p : random_sphere(20'000, seed).positions) points.push_back({4 * p.x(), p.y(), p.z()});
        const PointCloud scan{{}, std::move(points), {}};
        const VoxelThinResult adaptive = thin(scan, within(0.02, Rule::adaptive)), quantile = thin(scan, within(0.02));
        EXPECT_LT(static_cast<double>(adaptive.kept.size()), 0.7 * static_cast<double>(quantile.kept.size()));
        EXPECT_LE(deviation_from_solid(scan, adaptive.points), usual_share * 0.02) << seed;
        EXPECT_LE(deviation_from_solid(scan, quantile.points), usual_share * 0.02) << seed;
    }
}

}  // namespace
}  // namespace scanmill::test
