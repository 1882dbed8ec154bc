// SPDX-License-Identifier: GPL-3.0-or-later
// Boundary loops: which go round a surface and which round a hole in it.

#include <gmock/gmock.h>

#include "filters/features_cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::IsEmpty;

TEST(FeaturesOfAPlate, AreItsBorderAndFiveHolesOfTheirRadius) {
    const FeatureLines lines = features_of(plate_with_holes());
    EXPECT_EQ(lines.counts.boundaries, 1u);
    EXPECT_EQ(lines.counts.holes, 5u);
    EXPECT_EQ(lines.counts.ambiguous, 0u);
    EXPECT_EQ(lines.counts.creases, 0u);
    EXPECT_EQ(lines.counts.corners, 4u) << "a hole of 32 sides turns by 11.25 degrees";
    std::vector<Vec3> centres;
    for (const FeaturePolyline& hole : polylines_of(lines.graph, FeatureType::hole)) {
        EXPECT_TRUE(hole.closed);
        const std::vector<Vec3> places = places_of(lines.graph, hole);
        EXPECT_EQ(places.size(), 32u);
        Vec3 centre = Vec3::Zero();
        for (const Vec3& place : places) centre += place / 32;
        for (const Vec3& place : places) EXPECT_NEAR((place - centre).norm(), hole_radius, 1e-12);
        centres.push_back(centre.array().round());
        EXPECT_EQ(places[0].x(), std::ranges::min(places, {}, [](const Vec3& p) { return p.x(); }).x())
            << "begins at its lowest place";
    }
    EXPECT_THAT(centres, testing::UnorderedElementsAreArray(hole_centres));
    const FeaturePolyline& border = lines.graph.polylines[0];
    EXPECT_EQ(border.type, FeatureType::outer_boundary);
    EXPECT_DOUBLE_EQ(length_of(lines.graph, border), 320);
    EXPECT_EQ(lines.graph.positions[lines.graph.vertices[border.begin]], Vec3(0, 0, 0));
}

TEST(FeaturesOfAGrid, AreOneLoopOfItsBorder) {
    const FeatureLines lines = features_of(grid(7, 4));
    ASSERT_EQ(lines.graph.polylines.size(), 1u);
    EXPECT_EQ(lines.graph.polylines[0].type, FeatureType::outer_boundary);
    EXPECT_EQ(lines.graph.vertices.size(), 2u * (7 + 4));
    EXPECT_EQ(lines.counts.corners, 4u);
}

TEST(FeaturesOfATube, AreTwoLoops_OfWhichTheLengthDecides) {
    const FeatureLines even = features_of(frustum(1, 1, 3, 40, false));
    EXPECT_EQ(even.counts.ambiguous, 2u);
    EXPECT_EQ(even.counts.boundaries, 1u);
    EXPECT_EQ(even.counts.holes, 1u);
    EXPECT_EQ(even.counts.creases, 0u);
    EXPECT_EQ(places_of(even.graph, even.graph.polylines[0])[0].z(), 0) << "of equal loops the lower one is outer";

    const FeatureLines wider_above = features_of(frustum(1, 1.01, 3, 40, false));
    EXPECT_EQ(wider_above.counts.ambiguous, 2u);
    EXPECT_EQ(places_of(wider_above.graph, wider_above.graph.polylines[0])[0].z(), 3);
}

TEST(FeaturesOfAFunnel, AreToldApartByTheirArea) {
    const FeatureLines lines = features_of(frustum(3, 1, 1, 40, false));
    EXPECT_EQ(lines.counts.ambiguous, 0u);
    ASSERT_EQ(lines.graph.polylines.size(), 2u);
    EXPECT_EQ(lines.graph.polylines[0].type, FeatureType::outer_boundary);
    EXPECT_EQ(places_of(lines.graph, lines.graph.polylines[0])[0].z(), 0);
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
    // Five of the triangles round a corner of the icosahedron, all but one.
    TriangleMesh sphere = geodesic_sphere(1, 8);
    std::vector<Triangle> left;
    for (const Triangle& t : sphere.triangles)
        if (sphere.positions[t[0]].z() < 0.9) left.push_back(t);
    sphere.triangles = Array<Triangle>(left.begin(), left.end());
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
    EXPECT_THAT(places_of(lines.graph, lines.graph.polylines[0]), testing::ElementsAreArray(round));
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
