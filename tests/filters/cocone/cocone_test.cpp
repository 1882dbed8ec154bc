// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of known shape: closed, open, with holes.

#include <algorithm>
#include <set>

#include "filters/cocone/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;

MeshTopology topology_of(const CoconeResult& result) { return topology(result.mesh); }

TEST(Cocone, Sphere_IsClosedThroughAllPointsWithoutBoundary) {
    const CoconeResult result = surface_through(fibonacci_sphere(2000, 1e-6));
    const MeshTopology found = topology_of(result);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.triangles, 2 * 2000u - 4);
    EXPECT_EQ(result.boundary_points, 0u);
    EXPECT_EQ(result.loops, 0u);
    EXPECT_EQ(result.unused, 0u);
    EXPECT_GT(signed_volume(result.mesh.positions.span(), result.mesh.triangles.span()), 0);
    // The direction from the centre is the normal.
    const std::span<const double> normals = result.mesh.vertex_columns.find("pole-normal")->values<double>();
    for (std::size_t v = 0; v < result.mesh.positions.size(); ++v) {
        const Vec3 normal(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]);
        EXPECT_GT(normal.dot(result.mesh.positions[v].normalized()), std::cos(3 * std::numbers::pi / 180));
    }
}

TEST(Cocone, Torus_IsClosedWithOneHandle) {
    const PointCloud cloud = poisson_torus(0.06);
    const MeshTopology found = topology_of(surface_through(cloud));
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.euler, 0);
    EXPECT_EQ(found.triangles, 2 * cloud.positions.size());
}

TEST(Cocone, TwoSpheres_AreTwoComponentsThatFaceOutwards) {
    const PointCloud one = fibonacci_sphere(800, 1e-6);
    const CoconeResult result = surface_through(joined(one, moved(one, 1, Vec3(3, 0.2, 0.1))));
    const MeshTopology found = topology_of(result);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.components, 2u);
    EXPECT_EQ(found.triangles, 2 * (2 * 800u - 4));
    EXPECT_NEAR(signed_volume(result.mesh.positions.span(), result.mesh.triangles.span()), 8 * std::numbers::pi / 3,
                0.1);
}

TEST(Cocone, SphereInASphere_FacesTheCavity) {
    const PointCloud outer = moved(fibonacci_sphere(3000, 1e-6), 2), inner = fibonacci_sphere(800, 1e-6);
    const CoconeResult result = surface_through(joined(outer, inner));
    EXPECT_EQ(topology_of(result).components, 2u);
    EXPECT_NEAR(signed_volume(result.mesh.positions.span(), result.mesh.triangles.span()),
                (8 - 1) * 4 * std::numbers::pi / 3, 0.3);
}

TEST(Cocone, CurvedPatch_HasOneLoopThroughItsRim) {
    const CoconeResult result = surface_through(curved_patch());
    const MeshTopology found = topology_of(result);
    EXPECT_EQ(found.euler, 1);
    EXPECT_EQ(result.loops, 1u);
    EXPECT_EQ(found.nonmanifold_vertices, 0u);
    EXPECT_LE(result.unused, 4u);  // the corners have no flat neighbour
    EXPECT_EQ(result.boundary_points, 80u);
    // The loop passes through points of the rim only. It may pass over those that lie farther in.
    for (const u32 v : result.features.vertices) {
        const Vec3& p = result.features.positions[v];
        EXPECT_GT(std::max(std::abs(p.x()), std::abs(p.y())), 9.9);
    }
}

TEST(Cocone, PatchWithAHole_HasTwoLoops) {
    const PointCloud cloud = points_where(curved_patch(), [](const Vec3& p) { return std::hypot(p.x(), p.y()) > 3.4; });
    const CoconeResult result = surface_through(cloud);
    EXPECT_EQ(topology_of(result).euler, 0);
    EXPECT_EQ(result.loops, 2u);
    EXPECT_EQ(result.features.polylines.size(), 2u);
}

TEST(Cocone, Hemisphere_EndsAtItsRim) {
    const PointCloud cloud = points_where(fibonacci_sphere(1000, 1e-6), [](const Vec3& p) { return p.z() >= 0; });
    const double spacing = std::sqrt(4 * std::numbers::pi / 1000);
    const CoconeResult result = surface_through(cloud);
    EXPECT_EQ(topology_of(result).euler, 1);
    EXPECT_EQ(result.loops, 1u);
    EXPECT_EQ(result.unused, 0u);
    const std::span<const u8> boundary = result.mesh.vertex_columns.find("boundary")->values<u8>();
    for (std::size_t v = 0; v < boundary.size(); ++v)
        EXPECT_LT(boundary[v] == 1 ? result.mesh.positions[v].z() : 0, 1.2 * spacing);
    for (const u32 v : result.features.vertices) EXPECT_LT(result.features.positions[v].z(), 1.2 * spacing);
}

TEST(Cocone, SphereWithoutACap_HasOneHole) {
    const double limit = std::cos(20 * std::numbers::pi / 180);
    const CoconeResult result =
        surface_through(points_where(fibonacci_sphere(2000, 1e-6), [&](const Vec3& p) { return p.z() < limit; }));
    EXPECT_EQ(topology_of(result).euler, 1);
    EXPECT_EQ(result.loops, 1u);
}

TEST(Cocone, Result_DependsNeitherOnTheOrderNorOnThreadsNorOnRotation) {
    const PointCloud cloud = points_where(fibonacci_sphere(1500, 1e-3), [](const Vec3& p) { return p.z() > -0.5; });
    const auto triangles = [](const CoconeResult& result) {
        std::set<std::array<std::array<double, 3>, 3>> all;
        for (const Triangle& t : result.mesh.triangles) {
            std::array<std::array<double, 3>, 3> corners;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& p = result.mesh.positions[t[k]];
                corners[k] = {p.x(), p.y(), p.z()};
            }
            std::ranges::rotate(corners, std::ranges::min_element(corners));
            all.insert(corners);
        }
        return all;
    };
    const CoconeResult first = surface_through(cloud), parallel = surface_through(cloud, {}, 2);
    EXPECT_EQ(triangles(first), triangles(surface_through(shuffled(cloud, 7))));
    EXPECT_TRUE(std::ranges::equal(first.mesh.triangles, parallel.mesh.triangles));
    EXPECT_TRUE(first.mesh.vertex_columns == parallel.mesh.vertex_columns);
    const CoconeResult turned = surface_through(rotated(cloud, 1));
    EXPECT_EQ(turned.mesh.triangles.size(), first.mesh.triangles.size());
    EXPECT_EQ(turned.boundary_points, first.boundary_points);
    const CoconeResult scaled = surface_through(moved(cloud, 1024));
    EXPECT_TRUE(std::ranges::equal(first.mesh.triangles, scaled.mesh.triangles));
}

}  // namespace
}  // namespace scanmill
