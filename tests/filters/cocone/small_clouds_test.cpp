// SPDX-License-Identifier: GPL-3.0-or-later
/// Clouds of a few points, with numbers by hand, and clouds that are not samples of a surface.

#include <gmock/gmock.h>

#include "filters/cocone/cases.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;

/// What holds for every result.
void expect_promised(const CoconeResult& result, std::size_t points) {
    const MeshTopology found = topology(result.mesh);
    EXPECT_GT(found.triangles, 0u);
    EXPECT_EQ(found.nonmanifold_edges, 0u);
    EXPECT_EQ(found.misoriented_edges, 0u);
    EXPECT_EQ(found.degenerate_triangles, 0u);
    EXPECT_EQ(found.unused_vertices, 0u);
    EXPECT_EQ(result.mesh.positions.size() + result.unused, points);
    EXPECT_EQ(result.loops == 0, found.boundary_edges == 0);
    EXPECT_LE(result.pole_flat, points);
    // A point that is not flat by the test with poles is a boundary point.
    EXPECT_GE(result.boundary_points, points - result.pole_flat);
}

TEST(Cocone, Octahedron_HasNoFlatPointButIsClosed) {
    // Every pole is the middle, 1 away. The edges of the Voronoi cell of (1, 0, 0) leave the middle in the directions
    // (1, ±1, ±1) and reach the tangent plane x = 1 at (1, ±1, ±1), √2 away. That is more than 1 / ratio for all
    // ratios, so no point is flat. All these rays cross the tangent plane, so all 8 triangles are candidates. Their
    // edges are √2 long, less than 2.5 local spacings.
    Context context;
    const CoconeResult result =
        cocone(tets_of(cloud_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})), {}, context);
    expect_promised(result, 6);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.mesh.triangles.size(), 8u);
    EXPECT_EQ(result.pole_flat, 0u);
    EXPECT_EQ(result.boundary_points, 6u);
    EXPECT_EQ(result.loops, 0u);
    EXPECT_NEAR(signed_volume(result.mesh), 4.0 / 3, 1e-12);
    const std::span<const double> normals = result.mesh.vertex_columns.find("pole-normal")->values<double>();
    for (std::size_t v = 0; v < 6; ++v)
        EXPECT_NEAR((Vec3(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]) - result.mesh.positions[v]).norm(), 0,
                    1e-15);
    for (const auto& [name, value] : {std::pair("triangles", 8.0),
                                      {"boundary-points", 6.0},
                                      {"loops", 0.0},
                                      {"unused-points", 0.0},
                                      {"pole-flat", 0.0}})
        EXPECT_EQ(context.metrics().find(name)->value, value) << name;
}

TEST(Cocone, Icosahedron_IsFlatWithinItsRatioAndNormalAngle) {
    // Every pole is the middle, 1 away. The Voronoi cell reaches the tangent plane at tan 37.377° = 0.7639, which is
    // 1 / 1.3090, and the poles of neighbours differ by 63.43°.
    const PointCloud cloud = vertices_of(icosahedron());
    const auto with = [&](double normal_angle, double ratio) {
        CoconeParams params;
        params.normal_angle = Angle::degrees(normal_angle);
        params.ratio = ratio;
        const CoconeResult result = surface_through(cloud, params);
        expect_promised(result, 12);
        EXPECT_TRUE(topology(result.mesh).closed);
        EXPECT_EQ(result.mesh.triangles.size(), 20u);
        return result;
    };
    EXPECT_EQ(with(63.4, 1.2).pole_flat, 0u);
    EXPECT_EQ(with(63.5, 1.2).pole_flat, 12u);
    EXPECT_EQ(with(63.5, 1.308).pole_flat, 12u);
    EXPECT_EQ(with(63.5, 1.310).pole_flat, 0u);
    EXPECT_EQ(with(63.5, 1.2).boundary_points, 0u);
}

TEST(Cocone, ATetrahedron_IsItsHull) {
    const CoconeResult result = surface_through(vertices_of(regular_tetrahedron()));
    expect_promised(result, 4);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.mesh.triangles.size(), 4u);
}

TEST(Cocone, APointInsideAFewOthers_IsUnused) {
    Context context;
    const CoconeResult result =
        cocone(tets_of(cloud_of({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {0.01, 0.02, 0.03}})), {}, context);
    expect_promised(result, 5);
    EXPECT_EQ(result.unused, 1u);
    ASSERT_EQ(context.doubts().size(), 1u);  // more than a fiftieth of the points
    EXPECT_THAT(context.doubts()[0].text, testing::HasSubstr("1 of 5 points is in no triangle"));
}

TEST(Cocone, TenPointsOfASphere_AreTheirHull) {
    for (u64 seed = 1; seed < 6; ++seed) {
        const CoconeResult result = surface_through(random_sphere(10, seed));
        expect_promised(result, 10);
        const MeshTopology found = topology(result.mesh);
        if (found.closed && result.unused == 0) {
            EXPECT_EQ(found.triangles, 2 * 10u - 4) << seed;
        }
    }
}

TEST(Cocone, RandomClouds_GiveManifoldEdgesOrAnError) {
    std::size_t surfaces = 0, errors = 0;
    for (const std::size_t count : {4, 5, 6, 7, 8, 10, 15, 25, 60, 200})
        for (u64 seed = 1; seed <= 10; ++seed) {
            try {
                expect_promised(surface_through(random_cube(count, seed)), count);
                ++surfaces;
            } catch (const Error& error) {
                EXPECT_THAT(error.sentence(), testing::HasSubstr("no surface")) << count << ' ' << seed;
                ++errors;
            }
        }
    EXPECT_GT(surfaces, 50u);
    EXPECT_GT(errors, 0u);
}

TEST(Cocone, Lattices_GiveManifoldEdges) {
    expect_promised(surface_through(lattice_cube(4)), 125);
    const CoconeResult surface = surface_through(lattice_cube(6, 1, true));
    expect_promised(surface, 218);
    EXPECT_TRUE(topology(surface.mesh).closed);
    EXPECT_NEAR(signed_volume(surface.mesh), 216, 1e-9);
}

TEST(Cocone, TwoSheetsCloserThanTheSpacing_GiveManifoldEdges) {
    for (const double gap : {1e-6, 0.01, 0.1, 0.3, 0.6, 0.9, 1.5}) {
        Random random(5);
        Array<Vec3> positions;
        for (int sheet = 0; sheet < 2; ++sheet)
            for (int i = 0; i < 25; ++i)
                for (int j = 0; j < 25; ++j) {
                    const double x = i + random.uniform(-0.1, 0.1), y = j + random.uniform(-0.1, 0.1);
                    positions.emplace_back(x, y, sheet * gap + random.uniform(-0.01, 0.01) * gap);
                }
        PointCloud cloud;
        cloud.positions = std::move(positions);
        try {
            expect_promised(surface_through(cloud), 1250);
        } catch (const Error& error) {
            EXPECT_THAT(error.sentence(), testing::HasSubstr("no surface")) << gap;
        }
    }
}

}  // namespace
}  // namespace scanmill
