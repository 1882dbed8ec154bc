// SPDX-License-Identifier: GPL-3.0-or-later
// Boundary loops: outer boundaries and holes.

#include <gmock/gmock.h>

#include "filters/features/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::IsEmpty;

TEST(FeaturesOfAPlate, AreItsBoundaryAndFiveHolesOfTheirRadius) {
    const FeatureLines lines = features_of(plate_with_holes());
    EXPECT_EQ(lines.counts.boundaries, 1u);
    EXPECT_EQ(lines.counts.holes, 5u);
    EXPECT_EQ(lines.counts.ambiguous, 0u);
    EXPECT_EQ(lines.counts.creases, 0u);
    EXPECT_EQ(lines.counts.corners, 4u) << "a hole of 32 sides turns by 11.25 degrees";
    std::vector<Vec3> centres;
    for (const FeaturePolyline& hole : polylines_of(lines.graph, FeatureType::hole)) {
        EXPECT_TRUE(hole.closed);
        const std::vector<Vec3> positions = positions_of(lines.graph, hole);
        EXPECT_EQ(positions.size(), 32u);
        Vec3 centre = Vec3::Zero();
        for (const Vec3& position : positions) centre += position / 32;
        for (const Vec3& position : positions) EXPECT_NEAR((position - centre).norm(), hole_radius, 1e-12);
        centres.push_back(centre.array().round());
        EXPECT_EQ(positions[0].x(), std::ranges::min(positions, {}, [](const Vec3& p) { return p.x(); }).x())
            << "begins at its lowest position";
    }
    EXPECT_THAT(centres, testing::UnorderedElementsAreArray(hole_centres));
    const FeaturePolyline& boundary = lines.graph.polylines[0];
    EXPECT_EQ(boundary.type, FeatureType::outer_boundary);
    EXPECT_DOUBLE_EQ(length_of(lines.graph, boundary), 320);
    EXPECT_EQ(lines.graph.positions[lines.graph.vertices[boundary.begin]], Vec3(0, 0, 0));
}

TEST(FeaturesOfAGrid, AreOneLoop) {
    const FeatureLines lines = features_of(grid(7, 4));
    ASSERT_EQ(lines.graph.polylines.size(), 1u);
    EXPECT_EQ(lines.graph.polylines[0].type, FeatureType::outer_boundary);
    EXPECT_EQ(lines.graph.vertices.size(), 2u * (7 + 4));
    EXPECT_EQ(lines.counts.corners, 4u);
}

TEST(FeaturesOfATube, AreTwoLoops_ClassifiedByTheirLength) {
    const FeatureLines even = features_of(frustum(1, 1, 3, 40, false));
    EXPECT_EQ(even.counts.ambiguous, 2u);
    EXPECT_EQ(even.counts.boundaries, 1u);
    EXPECT_EQ(even.counts.holes, 1u);
    EXPECT_EQ(even.counts.creases, 0u);
    EXPECT_EQ(positions_of(even.graph, even.graph.polylines[0])[0].z(), 0) << "of equal loops the lower one is outer";

    const FeatureLines wider_above = features_of(frustum(1, 1.01, 3, 40, false));
    EXPECT_EQ(wider_above.counts.ambiguous, 2u);
    EXPECT_EQ(positions_of(wider_above.graph, wider_above.graph.polylines[0])[0].z(), 3);
}

TEST(FeaturesOfAFunnel, AreClassifiedByTheirArea) {
    const FeatureLines lines = features_of(frustum(3, 1, 1, 40, false));
    EXPECT_EQ(lines.counts.ambiguous, 0u);
    ASSERT_EQ(lines.graph.polylines.size(), 2u);
    EXPECT_EQ(lines.graph.polylines[0].type, FeatureType::outer_boundary);
    EXPECT_EQ(positions_of(lines.graph, lines.graph.polylines[0])[0].z(), 0);
    EXPECT_EQ(lines.graph.polylines[1].type, FeatureType::hole);
}

TEST(FeaturesOfAStrip, ThatIsNarrow_AreAmbiguousButAnOuterBoundary) {
    // n × 1 squares: area n, length 2 n + 2; their ratio falls below a thousandth from n = 248 on.
    EXPECT_EQ(features_of(grid(240, 1)).counts.ambiguous, 0u);
    const FeatureLines narrow = features_of(grid(256, 1));
    EXPECT_EQ(narrow.counts.ambiguous, 1u);
    EXPECT_EQ(narrow.counts.boundaries, 1u);
}

TEST(FeaturesOfASphere, AreNone) {
    const FeatureLines lines = features_of(geodesic_sphere(1, 8));
    EXPECT_THAT(lines.graph.polylines, IsEmpty());
    EXPECT_TRUE(lines.graph.corners.empty());
}

TEST(FeaturesOfAPiercedSphere, AreItsHole) {
    // Without the triangles around the pole.
    TriangleMesh sphere = geodesic_sphere(1, 8);
    std::vector<Triangle> kept;
    for (const Triangle& t : sphere.triangles)
        if (sphere.positions[t[0]].z() < 0.9) kept.push_back(t);
    sphere.triangles = Array<Triangle>(kept.begin(), kept.end());
    const FeatureLines lines = features_of(sphere);
    EXPECT_EQ(lines.counts.holes, 1u);
    EXPECT_EQ(lines.counts.boundaries, 0u);
    EXPECT_EQ(lines.counts.ambiguous, 0u);
}

TEST(FeaturesOfADroplet, ThatIsFlat_AreALoopThatBeginsAtItsCorner) {
    MeshBuilder builder;
    const std::vector<Vec3> round{{2, 0, 0},       {0.5, 0.85, 0},   {-0.3, 0.95, 0}, {-0.9, 0.4, 0},
                                  {-0.9, -0.4, 0}, {-0.3, -0.95, 0}, {0.5, -0.85, 0}};
    for (std::size_t i = 0; i < round.size(); ++i)
        builder.triangle(Vec3::Zero(), round[i], round[(i + 1) % round.size()]);
    FeatureParams params;
    params.corner_angle = Angle::degrees(60);
    const FeatureLines lines = features_of(builder.mesh(), params);
    ASSERT_EQ(lines.graph.polylines.size(), 1u);
    EXPECT_THAT(positions_of(lines.graph, lines.graph.polylines[0]), testing::ElementsAreArray(round));
    ASSERT_EQ(lines.graph.corners.size(), 1u);
    EXPECT_EQ(lines.graph.positions[lines.graph.corners[0]], Vec3(2, 0, 0));
}

TEST(FeaturesOfTwoFansThatTouch, KeepALoopEach_AndACornerBetweenThem) {
    const TriangleMesh bow =
        mesh_of({{0, 0, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {-1, 1, 0}}, {{0, 2, 1}, {0, 4, 3}});
    const FeatureLines lines = features_of(bow);
    EXPECT_EQ(lines.counts.boundaries, 2u);
    for (const FeaturePolyline& loop : lines.graph.polylines) EXPECT_EQ(loop.end - loop.begin, 3u);
    EXPECT_EQ(lines.counts.corners, 5u);
}

}  // namespace
}  // namespace scanmill
