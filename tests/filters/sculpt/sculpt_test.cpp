// SPDX-License-Identifier: GPL-3.0-or-later
// Cases computed by hand.

#include <gmock/gmock.h>

#include <numbers>

#include "filters/sculpt/cases.hpp"
#include "scanmill/base/random.hpp"
#include "sculpt/criteria.hpp"
#include "support/doubts.hpp"

namespace scanmill {
namespace {

using namespace test;
using std::numbers::pi;
using testing::HasSubstr;

double total_bending_of(const TriangleMesh& mesh) {
    BoundaryLinks links(mesh.triangles.span(), mesh.positions.size(), 1);
    return sculpting::total_bending(links, mesh.positions.span(), 1);
}

TEST(Bending, OfRegularSolids_IsEdgesTimesTheAngleBetweenNormals) {
    EXPECT_NEAR(total_bending_of(cube()), 12 * pi / 2, 1e-12);
    EXPECT_NEAR(total_bending_of(regular_tetrahedron()), 6 * (pi - std::acos(1.0 / 3)), 1e-12);
    EXPECT_NEAR(total_bending_of(icosahedron()), 30 * (pi - std::acos(-std::sqrt(5.0) / 3)), 1e-12);
}

TEST(Bending, OfAnySize_IsTheSame) {
    const double bending = total_bending_of(icosahedron());
    for (double radius : {1e-9, 3e-5, 7e8}) EXPECT_NEAR(total_bending_of(icosahedron(radius)), bending, 1e-9);
}

TEST(Sculpt, PointBelowTheTopOfACube_IsExposedAndThenItsPitIsOpened) {
    const TetMesh hull = hull_of(dented_cube());
    ASSERT_EQ(hull.cells.size(), 12u);
    const SculptResult result = sculpted(hull);
    ASSERT_EQ(result.removals.size(), 2u);
    EXPECT_EQ(result.removals[0].step, SculptStep::exposing);
    EXPECT_NEAR(result.removals[0].gain, -5.6637, 5e-5);
    EXPECT_EQ(result.removals[1].step, SculptStep::smoothing);
    EXPECT_NEAR(result.removals[1].gain, 3.7611, 5e-5);
    // The removed volume is a pyramid of height 0.1 below the top.
    EXPECT_NEAR(result.volume_removed, 0.1 / 3, 1e-15);
    EXPECT_NEAR(signed_volume(result.mesh), 1 - 0.1 / 3, 1e-12);
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.vertices, 9u);
    EXPECT_EQ(found.edges, 21u);
    EXPECT_EQ(found.triangles, 14u);
    EXPECT_NEAR(result.bending_before, 6 * pi, 1e-12);
    EXPECT_NEAR(result.bending_after, 6 * pi - result.removals[0].gain - result.removals[1].gain, 1e-12);
    EXPECT_TRUE(result.blocked_points.empty() && result.deep_points.empty());
}

TEST(Sculpt, OfTwoEqualSteps_TheOneWithTheLowerCornersComesFirst) {
    const TetMesh hull = hull_of(dented_cube());
    const SculptResult result = sculpted(hull);
    // The top's two triangles are equal except for their positions.
    std::array<std::array<Point, 4>, 2> corners;
    for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < 4; ++k) corners[i][k] = point(hull.positions[hull.cells[result.removals[i].cell][k]]);
        std::ranges::sort(corners[i]);
    }
    EXPECT_LT(corners[0], corners[1]);
}

TEST(Sculpt, WithoutLookahead_StillExposesEveryPoint) {
    SculptParams params;
    params.lookahead = false;
    EXPECT_EQ(sculpted(hull_of(dented_cube()), params).mesh.positions.size(), 9u);
}

TEST(Sculpt, MinGainAboveTheGain_LeavesThePitHalfOpen) {
    SculptParams params;
    params.min_gain = Angle::radians(3.77);
    const SculptResult closed = sculpted(hull_of(dented_cube()), params);
    EXPECT_EQ(closed.removals.size(), 1u);
    params.min_gain = Angle::radians(3.75);
    EXPECT_EQ(sculpted(hull_of(dented_cube()), params).removals.size(), 2u);
}

TEST(Sculpt, SolidWithEveryPointOnItAndNoSharpEdge_DoesNotChange) {
    const SculptResult result = sculpted(hull_of(fibonacci_sphere(200)));
    EXPECT_TRUE(result.removals.empty());
    EXPECT_EQ(result.bending_before, result.bending_after);
}

/// The block 2 × 2 × 2 without a quarter, sampled every 0.25: at this alpha seven samples of the concave edge are in
/// the interior.
TetMesh webbed_l_block() {
    const TetMesh tets = tets_of(l_block_surface(4, 2, 8, 2e-3));
    const double cover = solid_of(tets).alpha_cover;
    return solid_of(tets, at_alpha(1.6 * cover)).tets;
}

TEST(Sculpt, WebAlongAConcaveEdge_IsRemoved) {
    const TetMesh webbed = webbed_l_block();
    ASSERT_EQ(webbed.positions.size(), 354u);
    const MeshTopology before = topology(mesh_of(webbed, webbed.inside.span()));
    EXPECT_EQ(before.vertices, 347u);
    EXPECT_EQ(before.triangles, 690u);
    const SculptResult result = sculpted(webbed);
    EXPECT_GT(result.exposing, 0u);
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.vertices, 354u);
    EXPECT_EQ(found.triangles, 704u);
    EXPECT_NEAR(signed_volume(mesh_of(webbed, webbed.inside.span())), 6.065, 0.005);
    EXPECT_NEAR(signed_volume(result.mesh), 6, 0.01);
}

TEST(Sculpt, NearDuplicates_AreExposedWithoutLargePitsInTheSolid) {
    // A scan and a copy of it rounded to float: pits a millionth deep, whose edges are as sharp as any others.
    const PointCloud sphere = fibonacci_sphere(2000, 0);
    PointCloud rounded;
    Array<Vec3> positions;
    for (const Vec3& p : sphere.positions) positions.push_back(p.cast<float>().cast<double>());
    rounded.positions = std::move(positions);
    const AlphaSolidResult solid = solid_of(tets_of(joined(sphere, rounded)));
    EXPECT_GT(solid.interior_points.size(), 500u);
    const SculptResult result = sculpted(solid.tets);
    EXPECT_EQ(result.blocked_points.size() + result.deep_points.size(), 0u);
    const auto longest_edge = [](const TriangleMesh& mesh) {
        double longest = 0;
        for (const Triangle& t : mesh.triangles)
            for (int i = 0; i < 3; ++i)
                longest = std::max(longest, (mesh.positions[t[i]] - mesh.positions[t[(i + 1) % 3]]).norm());
        return longest;
    };
    EXPECT_LT(longest_edge(result.mesh), 1.5 * longest_edge(solid.mesh));
    EXPECT_LT(result.volume_removed, 0.1 * signed_volume(solid.mesh));
}

TEST(Sculpt, SeparateSolids_AreEachSculpted) {
    const TetMesh tets = tets_of(joined(dented_cube(), moved(dented_cube(), 1, Vec3(5, 0, 0))));
    TetMesh labelled = tets;
    Array<u8> inside(tets.cells.size());
    for (std::size_t c = 0; c < inside.size(); ++c)
        inside[c] = std::ranges::all_of(tets.cells[c], [](u32 v) { return v < 9; }) ||
                    std::ranges::all_of(tets.cells[c], [](u32 v) { return v >= 9; });
    labelled.inside = std::move(inside);
    const SculptResult result = sculpted(labelled);
    EXPECT_EQ(topology(result.mesh).components, 2u);
    EXPECT_EQ(result.exposing, 2u);
    EXPECT_EQ(result.mesh.triangles.size(), 28u);
    EXPECT_NEAR(signed_volume(result.mesh), 2 * (1 - 0.1 / 3), 1e-12);
}

TEST(Sculpt, VerticesOfNoCell_AreCountedAndChangeNothing) {
    TetMesh hull = hull_of(dented_cube());
    Array<Vec3> positions(hull.positions.begin(), hull.positions.end());
    positions.push_back(Vec3(0.5, 0.5, 0.5));
    hull.positions = std::move(positions);
    const SculptResult result = sculpted(hull);
    EXPECT_EQ(result.outside_points, 1u);
    EXPECT_EQ(result.mesh.positions.size(), 9u);
}

TEST(Sculpt, Columns_AreCarriedToTheBoundary) {
    TetMesh hull = hull_of(dented_cube());
    hull.vertex_columns.add(Column("number", 1, Buffer<u32>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
    const SculptResult result = sculpted(hull);
    ASSERT_NE(result.mesh.vertex_columns.find("number"), nullptr);
    EXPECT_EQ(result.mesh.vertex_columns.find("number")->number(8), 8);
    EXPECT_NE(result.tets.vertex_columns.find("number"), nullptr);
}

TEST(Sculpt, NoiseThatTurnsTriangles_IsMeasuredAndDoubtful) {
    for (const double noise : {0.0, 0.003, 0.006}) {  // standard deviation; the edges are 0.06 long
        Random random(7);
        const double half_width = std::sqrt(3.0) * noise;
        PointCloud cloud;
        Array<Vec3> positions;
        for (const Vec3& p : geodesic_sphere(1, 20).positions)
            positions.push_back(p * (1 + random.uniform(-half_width, half_width)));
        cloud.positions = std::move(positions);
        Context context;
        const SculptResult result = sculpt(solid_of(tets_of(cloud)).tets, {}, context);
        EXPECT_LE(result.noise, 1.15 * noise);
        if (noise < 0.006) {
            EXPECT_THAT(doubts_of(context), testing::IsEmpty());
            continue;
        }
        EXPECT_GE(result.noise, 0.85 * noise);
        EXPECT_THAT(doubts_of(context), testing::ElementsAre(HasSubstr("workflow raw-scans")));
    }
}

}  // namespace
}  // namespace scanmill
