// SPDX-License-Identifier: GPL-3.0-or-later
// Creases and corners of surfaces that can be counted by hand.

#include <gmock/gmock.h>

#include "filters/features/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double degree = std::numbers::pi / 180;

TEST(FeaturesOfAHinge, AreACreaseBetweenTwoCorners_AndOneBoundary_RowByRow) {
    // Vertices by position: 0 (-1,0,0), 1 (-1,1,0), 2 (0,0,-1), 3 (0,0,0), 4 (0,1,-1), 5 (0,1,0), up to rounding of
    // cos 90°.
    const FeatureLines lines = features_of(hinge(90));
    const FeatureGraph& graph = lines.graph;
    ASSERT_EQ(graph.polylines.size(), 2u);
    EXPECT_EQ(graph.polylines[0].type, FeatureType::outer_boundary);
    EXPECT_TRUE(graph.polylines[0].closed);
    EXPECT_EQ(graph.polylines[1].type, FeatureType::crease);
    EXPECT_FALSE(graph.polylines[1].closed);
    // The loop has the surface on its left and begins at the lowest corner; the crease has ascending y.
    const std::vector<Vec3> loop = positions_of(graph, graph.polylines[0]);
    ASSERT_EQ(loop.size(), 6u);
    EXPECT_EQ(loop[0], Vec3(-1, 0, 0));
    EXPECT_EQ(loop[1], Vec3(0, 0, 0));
    EXPECT_EQ(loop[5], Vec3(-1, 1, 0));
    EXPECT_THAT(positions_of(graph, graph.polylines[1]), ElementsAre(Vec3(0, 0, 0), Vec3(0, 1, 0)));
    // Along y, the square at z = 0 with normal z is on the left, the one below it with normal x on the right.
    const u32 row = graph.polylines[1].begin;
    EXPECT_TRUE(graph.left_normals[row].isApprox(Vec3::UnitZ(), 1e-15));
    EXPECT_TRUE(graph.right_normals[row].isApprox(Vec3::UnitX(), 1e-15));
    EXPECT_EQ(graph.left_normals[row + 1], Vec3::Zero());
    EXPECT_EQ(graph.right_normals[row + 1], Vec3::Zero());
    EXPECT_EQ(graph.left_normals[0], Vec3::UnitZ());
    EXPECT_EQ(graph.right_normals[0], Vec3::Zero());
    // Four where the boundary turns by 90 degrees, two where the crease ends on it.
    EXPECT_THAT(graph.corners.span(), ElementsAre(0, 1, 2, 3, 4, 5));
    EXPECT_EQ(lines.counts.creases, 1u);
    EXPECT_EQ(lines.counts.boundaries, 1u);
    EXPECT_EQ(lines.counts.holes, 0u);
    EXPECT_EQ(lines.counts.corners, 6u);
}

TEST(FeaturesOfAHinge, AngleAtTheLimit_IsNotSharp_AngleAboveItIs) {
    for (const double angle : {10.0, 30.0, 40.0, 45.0, 60.0, 90.0, 120.0}) {
        FeatureParams params;
        params.sharp_angle = Angle::degrees(angle);
        EXPECT_EQ(features_of(hinge(angle), params).counts.creases, 0u) << angle;
        EXPECT_EQ(features_of(hinge(angle + 1e-6), params).counts.creases, 1u) << angle;
        EXPECT_EQ(features_of(hinge(-angle), params).counts.creases, 0u)
            << "concave edges are sharp like convex ones, " << angle;
        EXPECT_EQ(features_of(hinge(-angle - 1e-6), params).counts.creases, 1u) << angle;
    }
}

TEST(FeaturesOfACube, AreItsTwelveEdgesAndEightCorners) {
    const FeatureLines lines = features_of(cube(2));
    EXPECT_EQ(lines.counts.creases, 12u);
    EXPECT_EQ(lines.counts.corners, 8u);
    EXPECT_EQ(lines.counts.boundaries + lines.counts.holes, 0u);
    for (const FeaturePolyline& crease : lines.graph.polylines) {
        ASSERT_EQ(crease.end - crease.begin, 2u);
        const std::vector<Vec3> ends = positions_of(lines.graph, crease);
        const Vec3 direction = ends[1] - ends[0], left = lines.graph.left_normals[crease.begin],
                   right = lines.graph.right_normals[crease.begin];
        EXPECT_EQ(direction.norm(), 2);
        EXPECT_EQ(direction.maxCoeff(), 2) << "from the lower end to the higher";
        // Both normals point out of the cube; at a convex edge their cross product points along it.
        EXPECT_EQ(left.cross(right), direction / 2);
        EXPECT_GT(left.dot(ends[0] - Vec3::Ones()), 0);
        EXPECT_GT(right.dot(ends[0] - Vec3::Ones()), 0);
    }
}

TEST(FeaturesOfACube, WithALimitOfNinetyDegrees_AreNone) {
    FeatureParams params;
    params.sharp_angle = Angle::degrees(90);
    const FeatureLines lines = features_of(cube(), params);
    EXPECT_THAT(lines.graph.polylines, IsEmpty());
    EXPECT_EQ(lines.graph.positions.size(), 0u);
    EXPECT_EQ(lines.counts.corners, 0u);
}

TEST(FeaturesOfAnLBlock, AreItsEighteenEdgesAndTwelveCorners_ReflexOneIncluded) {
    const FeatureLines lines = features_of(l_block());
    EXPECT_EQ(lines.counts.creases, 18u);
    EXPECT_EQ(lines.counts.corners, 12u);
    const bool reflex = std::ranges::any_of(lines.graph.polylines, [&](const FeaturePolyline& crease) {
        const std::vector<Vec3> ends = positions_of(lines.graph, crease);
        return ends[0] == Vec3(1, 1, 0) && ends[1] == Vec3(1, 1, 1);
    });
    EXPECT_TRUE(reflex);
}

TEST(FeaturesOfACone, AreItsBaseRing_TheApexIsNotACorner) {
    const u32 sides = 48;
    const FeatureLines lines = features_of(frustum(1, 0, 2, sides, true));
    ASSERT_EQ(lines.graph.polylines.size(), 1u);
    const FeaturePolyline& ring = lines.graph.polylines[0];
    EXPECT_EQ(ring.type, FeatureType::crease);
    EXPECT_TRUE(ring.closed);
    EXPECT_EQ(ring.end - ring.begin, sides);
    EXPECT_EQ(lines.counts.corners, 0u);
    const std::vector<Vec3> positions = positions_of(lines.graph, ring);
    for (const Vec3& position : positions) EXPECT_GE(position.x(), positions[0].x()) << "begins at its lowest position";
    EXPECT_LT(positions[1].y(), positions.back().y()) << "and goes to the lower of the two neighbours";
    for (u32 row = ring.begin; row < ring.end; ++row) {
        const Vec3& below =
            lines.graph.left_normals[row].z() < 0 ? lines.graph.left_normals[row] : lines.graph.right_normals[row];
        EXPECT_EQ(below, -Vec3::UnitZ());
    }
}

TEST(FeaturesOfACone, WithFewSides_AreTheEdgesToItsApex_ACorner) {
    const FeatureLines lines = features_of(frustum(1, 0, 1, 4, true));
    EXPECT_EQ(lines.counts.creases, 8u);
    EXPECT_EQ(lines.counts.corners, 5u);
}

TEST(FeaturesOfAPrism, AreAllOrNoneOfItsSideEdges) {
    const TriangleMesh prism = frustum(1, 1, 1, 36, true);  // its faces meet at 10 degrees
    FeatureParams params;
    EXPECT_EQ(features_of(prism, params).counts.creases, 2u);
    params.sharp_angle = Angle::degrees(10);
    EXPECT_EQ(features_of(prism, params).counts.creases, 2u);
    params.sharp_angle = Angle::degrees(9.999);
    EXPECT_EQ(features_of(prism, params).counts.creases, 3u * 36);
    // The rings turn by the same angle.
    params = {};
    params.corner_angle = Angle::degrees(10);
    EXPECT_EQ(features_of(prism, params).counts.corners, 0u);
    params.corner_angle = Angle::degrees(9.999);
    const FeatureLines cut = features_of(prism, params);
    EXPECT_EQ(cut.counts.corners, 72u);
    EXPECT_EQ(cut.counts.creases, 72u);
}

TEST(FeaturesOfADroplet, AreACreaseThatIsClosedAtItsOnlyCorner) {
    // A flat cone over a drop-shaped outline with one sharp turn, at (2, 0, 0).
    std::vector<Vec3> outline{{2, 0, 0}};
    for (int i = -6; i <= 6; ++i) {
        const double angle = std::numbers::pi + i * 20 * degree;
        outline.insert(outline.begin() + 1, Vec3(std::cos(angle), std::sin(angle), 0));
    }
    MeshBuilder builder;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec3 &a = outline[i], &b = outline[(i + 1) % outline.size()];
        builder.triangle(b, a, Vec3(0, 0, 0.2));
        builder.triangle(a, b, Vec3(0, 0, 0));
    }
    const FeatureLines lines = features_of(builder.mesh());
    ASSERT_EQ(lines.graph.polylines.size(), 1u);
    EXPECT_TRUE(lines.graph.polylines[0].closed);
    ASSERT_EQ(lines.graph.corners.size(), 1u);
    EXPECT_EQ(lines.graph.positions[lines.graph.corners[0]], Vec3(2, 0, 0));
    const std::vector<Vec3> positions = positions_of(lines.graph, lines.graph.polylines[0]);
    EXPECT_EQ(positions[0], Vec3(2, 0, 0)) << "begins at its corner, not at its lowest position";
    EXPECT_LT(positions[1].x() * 1e3 + positions[1].y(), positions.back().x() * 1e3 + positions.back().y());
}

}  // namespace
}  // namespace scanmill
