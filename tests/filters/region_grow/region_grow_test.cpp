// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "filters/region_grow/cases.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;

TEST(RegionGrow_ThreePoints, MakeOneTriangleFacingUp) {
    const RegionGrowResult result = grown(cloud_of({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}));
    ASSERT_EQ(result.mesh.triangles.size(), 1u);
    EXPECT_EQ(result.mesh.triangles[0], (Triangle{0, 2, 1}));
    EXPECT_EQ(result.components, 1u);
    EXPECT_EQ(result.loops, 1u);
    EXPECT_EQ(result.holes, 0u);
}

TEST(RegionGrow_UnevenQuadrilateral, TakesTheDiagonalWithEmptyCircles) {
    // The circle through (0, 0), (1, 1) and (1, −1) has its centre at (1, 0) and the radius 1: it holds (1.5, 0). So
    // the diagonal runs from (0, 0) to (1.5, 0).
    const RegionGrowResult result = grown(cloud_of({{0, 0, 0}, {1, -1, 0}, {1.5, 0, 0}, {1, 1, 0}}));
    ASSERT_EQ(result.mesh.triangles.size(), 2u);
    for (const Triangle& t : result.mesh.triangles) {
        EXPECT_THAT(t, testing::Contains(0u));
        EXPECT_THAT(t, testing::Contains(2u));
    }
}

TEST(RegionGrow_Square, BreaksTheTieByPosition) {
    const PointCloud square = grid(2, 2);
    const auto first = by_position(grown(square).mesh);
    EXPECT_EQ(first.size(), 2u);
    for (std::uint64_t seed = 1; seed < 9; ++seed) EXPECT_EQ(by_position(grown(shuffled(square, seed)).mesh), first);
}

TEST(RegionGrow_FourCornersOfATetrahedron, CloseIntoOne) {
    const PointCloud corners = vertices_of(regular_tetrahedron());
    const RegionGrowResult result = grown(corners);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_GT(signed_volume(result.mesh), 0);
}

class RegionGrowOfAGrid : public testing::TestWithParam<std::pair<u32, u32>> {};

TEST_P(RegionGrowOfAGrid, FillsItsRectangle) {
    const auto [m, n] = GetParam();
    for (const PointCloud& cloud : {grid(m, n), rotated(grid(m, n), 0.7)}) {
        const RegionGrowResult result = grown(cloud);
        expect_consistent(result);
        EXPECT_EQ(result.mesh.triangles.size(), 2 * (m - 1) * (n - 1));
        EXPECT_EQ(result.loops, 1u);
        EXPECT_EQ(result.holes, 0u);
        EXPECT_EQ(topology(result.mesh).boundary_edges, 2 * (m + n - 2));
        EXPECT_EQ(result.unused_points, 0u);
        EXPECT_NEAR(area(result.mesh), (m - 1) * (n - 1), 1e-9);
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, RegionGrowOfAGrid,
                         testing::Values(std::pair{2u, 2u}, std::pair{2u, 9u}, std::pair{5u, 4u}, std::pair{30u, 17u}));

TEST(RegionGrow_Sphere, IsClosedAndFacesOutwards) {
    const PointCloud cloud = fibonacci_sphere(3000);
    const RegionGrowResult result = grown(cloud);
    expect_consistent(result);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * 3000u - 4);
    EXPECT_EQ(result.loops, 0u);
    EXPECT_GT(signed_volume(result.mesh), 0);
}

/// Around the z axis, every other ring turned by half a step.
PointCloud cylinder(u32 around, u32 rings) {
    std::vector<Vec3> points;
    for (u32 ring = 0; ring < rings; ++ring)
        for (u32 i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * (i + 0.5 * (ring % 2)) / around;
            points.push_back(Vec3(std::cos(angle), std::sin(angle), 0.1 * ring));
        }
    return cloud_from(std::move(points));
}

TEST(RegionGrow_OpenCylinder, HasTwoLoops) {
    const RegionGrowResult result = grown(cylinder(60, 20));
    expect_consistent(result);
    EXPECT_EQ(result.loops, 2u);
    EXPECT_EQ(topology(result.mesh).euler, 0);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * 60u * 19);
}

TEST(RegionGrow_OpenCylinder, WarnsThatItsLoopsAreAmbiguous) {
    // Two equal loops: neither area nor length decides which one is the outer boundary.
    ContextOptions options;
    Context context(options);
    const RegionGrowResult result = region_grow(cylinder(60, 20), {}, context);
    EXPECT_EQ(result.ambiguous_loops, 2u);
    EXPECT_EQ(result.triangles_without_area, 0u);
    EXPECT_THAT(context.warnings(),
                ElementsAre(testing::HasSubstr(
                    "the area of 2 boundary loops does not decide between outer boundary and hole")));
}

TEST(RegionGrow_RegularCylinder, BreaksItsTiesWithoutGaps) {
    std::vector<Vec3> points;
    for (u32 ring = 0; ring < 15; ++ring)
        for (u32 i = 0; i < 40; ++i) {
            const double angle = 2 * std::numbers::pi * i / 40;
            points.push_back(Vec3(std::cos(angle), std::sin(angle), 0.15 * ring));
        }
    const RegionGrowResult result = grown(cloud_from(std::move(points)));
    expect_consistent(result);
    EXPECT_EQ(result.loops, 2u);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * 40u * 14);
}

/// Two half planes that meet in the y axis: z = 0 for x ≤ 0, x = 0 for z ≤ 0.
PointCloud edge_of_90_degrees(u32 steps) {
    std::vector<Vec3> points;
    for (u32 y = 0; y <= steps; ++y) {
        for (u32 x = 0; x <= steps; ++x) points.push_back(Vec3(-1.0 * x, y, 0));
        for (u32 z = 1; z <= steps; ++z) points.push_back(Vec3(0, y, -1.0 * z));
    }
    return cloud_from(std::move(points));
}

TEST(RegionGrow_TwoPlanesAt90Degrees, SmallerLimit_GivesTwoPatchesAndASharpEdge) {
    const RegionGrowResult result = grown(edge_of_90_degrees(12), with_max_normal_angle(60));
    expect_manifold(result.mesh);
    EXPECT_EQ(result.components, 2u);
    EXPECT_GE(result.patch_edges, 10u);
    // Both face outwards, as the outside of one edge.
    Vec3 sum = Vec3::Zero();
    for (const Triangle& t : result.mesh.triangles) {
        sum += normal_of(result.mesh, t) / 2;
        for (u32 corner : t) {  // no triangle cuts the corner
            const Vec3 &p = result.mesh.positions[corner], n = normal_of(result.mesh, t);
            EXPECT_TRUE(n.x() == 0 ? p.z() == 0 : p.x() == 0);
        }
    }
    EXPECT_GT(sum.x(), 100);
    EXPECT_GT(sum.z(), 100);
    // A line along the edge has the normals of both patches.
    std::size_t beyond = 0;
    const FeatureGraph& lines = result.features;
    for (std::size_t i = 0; i < lines.vertices.size(); ++i) {
        EXPECT_NEAR(lines.left_normals[i].norm(), 1, 1e-9);
        if (lines.right_normals[i].isZero()) continue;
        ++beyond;
        EXPECT_NEAR(lines.right_normals[i].norm(), 1, 1e-9);
        EXPECT_NEAR(lines.left_normals[i].dot(lines.right_normals[i]), 0, 1e-9);
        EXPECT_GE(lines.right_normals[i].minCoeff(), -1e-9);
    }
    EXPECT_EQ(beyond, result.patch_edges);
    // The boundary edges of the patch that ends next to the edge are sharp.
    EXPECT_GE(result.mesh.sharp_edges.size(), 12u);
}

TEST(RegionGrow_TwoPlanesAt90Degrees, LargerLimit_GivesOnePatchWithACrease) {
    const RegionGrowResult result = grown(edge_of_90_degrees(12), with_max_normal_angle(100));
    expect_consistent(result);
    EXPECT_EQ(result.components, 1u);
    EXPECT_EQ(topology(result.mesh).euler, 1);
    // All triangles of the two rectangles; the limit also allows a cap at either end of the edge, at 90 degrees.
    EXPECT_GE(result.mesh.triangles.size(), 2 * 24u * 12);
    EXPECT_LE(result.mesh.triangles.size(), 2 * 24u * 12 + 2);
    std::size_t along_edge = 0;
    for (const auto& [a, b] : result.mesh.sharp_edges) {
        const Vec3 &p = result.mesh.positions[a], &q = result.mesh.positions[b];
        along_edge += p.x() == 0 && p.z() == 0 && q.x() == 0 && q.z() == 0;
    }
    EXPECT_EQ(along_edge, 12u);
    EXPECT_GE(result.creases, 1u);
}

TEST(RegionGrow_Cube, HasTwelveCreasesAndEightCorners) {
    const RegionGrowResult result = grown(lattice_cube(8, 1, true));
    expect_consistent(result);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * 386u - 4);
    EXPECT_EQ(result.creases, 12u);
    EXPECT_EQ(result.corners, 8u);
    EXPECT_NEAR(signed_volume(result.mesh), 512, 1e-9);
}

TEST(RegionGrow_Midpoint, FillsGridAndSphere) {
    RegionGrowParams params;
    params.score = RegionGrowParams::Score::midpoint;
    const RegionGrowResult result = grown(grid(12, 9), params);
    expect_consistent(result);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * 11u * 8);
    const RegionGrowResult sphere = grown(fibonacci_sphere(2000), params);
    expect_consistent(sphere);
    EXPECT_LE(sphere.unused_points, 10u);
}

TEST(RegionGrow_Start, DecidesWhereTheComponentBegins) {
    RegionGrowParams params;
    params.start = 37;
    const RegionGrowResult result = grown(grid(10, 10), params);
    expect_consistent(result);
    EXPECT_EQ(result.mesh.triangles.size(), 162u);
    EXPECT_THAT(result.mesh.triangles[0], testing::Contains(37u));
}

TEST(RegionGrow_Columns, StayWithTheirPoints) {
    PointCloud cloud = grid(4, 4);
    Array<double> weights(17);
    for (std::size_t i = 0; i < 17; ++i) weights[i] = static_cast<double>(i);
    cloud = joined(cloud_of({{1, 2, 0}}), cloud);  // a repeat of a grid point, before it
    cloud.columns.add(Column("weight", 1, Buffer<double>(std::move(weights))));
    const RegionGrowResult result = grown(cloud);
    EXPECT_EQ(result.duplicates, 1u);
    ASSERT_EQ(result.mesh.positions.size(), 16u);
    for (u32 vertex = 0; vertex < 16; ++vertex) {
        EXPECT_EQ(result.mesh.vertex_columns.find("weight")->number(vertex), result.rows[vertex]);
        EXPECT_EQ(result.mesh.positions[vertex], cloud.positions[result.rows[vertex]]);
    }
    EXPECT_EQ(result.rows[0], 0u);
}

/// A floor of step 1 and, along its side x = 0, a wall of `wall_rows` rows.
PointCloud sheet_with_wall(u32 floor_rows, u32 along, u32 wall_rows) {
    std::vector<Vec3> points;
    for (u32 y = 0; y < along; ++y) {
        for (u32 x = 0; x < floor_rows; ++x) points.push_back(Vec3(x, y, 0));
        for (u32 z = 1; z <= wall_rows; ++z) points.push_back(Vec3(0, y, z));
    }
    return cloud_from(std::move(points));
}

TEST(RegionGrow_OpenSheets, WithACreaseHaveNoPatchEdge) {
    for (const PointCloud& sheet :
         {sheet_with_wall(15, 20, 15), sheet_with_wall(30, 30, 1), sheet_with_wall(30, 30, 2)})
        for (const double angle : {0.0, 0.7}) {
            const RegionGrowResult result = grown(rotated(sheet, angle));
            expect_consistent(result);
            EXPECT_EQ(result.components, 1u);
            EXPECT_EQ(result.loops, 1u);
            EXPECT_EQ(result.patch_edges, 0u);
        }
}

TEST(RegionGrow_TwoSheets, AreNotBridgedThreeVoxelsApart) {
    // A grid of step 1 is as dense as voxels of 1.25 leave points.
    std::vector<Vec3> points;
    for (const Vec3& p : grid(20, 20).positions) {
        points.push_back(p);
        points.push_back(p + Vec3(0, 0, 3.75));
    }
    const RegionGrowResult result = grown(cloud_from(std::move(points)));
    expect_consistent(result);
    EXPECT_EQ(result.components, 2u);
    EXPECT_EQ(result.loops, 2u);
    for (const Triangle& t : result.mesh.triangles) {
        EXPECT_EQ(result.mesh.positions[t[0]].z(), result.mesh.positions[t[1]].z());
        EXPECT_EQ(result.mesh.positions[t[0]].z(), result.mesh.positions[t[2]].z());
    }
}

}  // namespace
}  // namespace scanmill
