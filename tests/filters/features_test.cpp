// SPDX-License-Identifier: GPL-3.0-or-later
// Lines and corners of surfaces whose feature lines can be counted by hand.

#include <gmock/gmock.h>

#include "filters/features_cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double degree = std::numbers::pi / 180;

TEST(FeaturesOfAHinge, AreACreaseBetweenTwoCorners_AndOneBoundary_RowByRow) {
    // Vertices by place: 0 (-1,0,0), 1 (-1,1,0), 2 (0,0,-1), 3 (0,0,0), 4 (0,1,-1), 5 (0,1,0), up to rounding of
// cos 90.
    const FeatureLines lines = features_of(hinge(90));
    const FeatureGraph& graph = lines.graph;
    ASSERT_EQ(graph.polylines.size(), 2u);
    EXPECT_EQ(graph.polylines[0].type, FeatureType::outer_boundary);
    EXPECT_TRUE(graph.polylines[0].closed);
    EXPECT_EQ(graph.polylines[1].type, FeatureType::crease);
    EXPECT_FALSE(graph.polylines[1].closed);
    // The loop keeps the surface on its left and begins at the lowest corner; the crease goes up y.
    const std::vector<Vec3> loop = places_of(graph, graph.polylines[0]);
    ASSERT_EQ(loop.size(), 6u);
    EXPECT_EQ(loop[0], Vec3(-1, 0, 0));
    EXPECT_EQ(loop[1], Vec3(0, 0, 0));
    EXPECT_EQ(loop[5], Vec3(-1, 1, 0));
    EXPECT_THAT(places_of(graph, graph.polylines[1]), ElementsAre(Vec3(0, 0, 0), Vec3(0, 1, 0)));
    // Up y, the square at z = 0 is on the left, its normal z; the one that hangs down on the right, its normal x.
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
    for (const double bend : {10.0, 30.0, 40.0, 45.0, 60.0, 90.0, 120.0}) {
        FeatureParams params;
        params.sharp_angle = Angle::degrees(bend);
        EXPECT_EQ(features_of(hinge(bend), params).counts.creases, 0u) << bend;
        EXPECT_EQ(features_of(hinge(bend + 1e-6), params).counts.creases, 1u) << bend;
        EXPECT_EQ(features_of(hinge(-bend), params).counts.creases, 0u) << "a valley bends as a ridge does, " << bend;
        EXPECT_EQ(features_of(hinge(-bend - 1e-6), params).counts.creases, 1u) << bend;
    }
}

TEST(FeaturesOfACube, AreItsTwelveEdgesAndEightCorners) {
    const FeatureLines lines = features_of(cube(2));
    EXPECT_EQ(lines.counts.creases, 12u);
    EXPECT_EQ(lines.counts.corners, 8u);
    EXPECT_EQ(lines.counts.boundaries + lines.counts.holes, 0u);
    for (const FeaturePolyline& crease : lines.graph.polylines) {
        ASSERT_EQ(crease.end - crease.begin, 2u);
        const std::vector<Vec3> ends = places_of(lines.graph, crease);
        const Vec3 way = ends[1] - ends[0], left = lines.graph.left_normals[crease.begin],
                   right = lines.graph.right_normals[crease.begin];
        EXPECT_EQ(way.norm(), 2);
        EXPECT_EQ(way.maxCoeff(), 2) << "from the lower end to the higher";
        // Both normals point out of the cube; a ridge turns to the right, seen along the way.
        EXPECT_EQ(left.cross(right), way / 2);
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
        const std::vector<Vec3> ends = places_of(lines.graph, crease);
        return ends[0] == Vec3(1, 1, 0) && ends[1] == Vec3(1, 1, 1);
    });
    EXPECT_TRUE(reflex);
}

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

TEST(FeaturesOfACone, AreItsBaseRing_TheApexIsNoCorner) {
    const u32 sides = 48;
    const FeatureLines lines = features_of(frustum(1, 0, 2, sides, true));
    ASSERT_EQ(lines.graph.polylines.size(), 1u);
    const FeaturePolyline& ring = lines.graph.polylines[0];
    EXPECT_EQ(ring.type, FeatureType::crease);
    EXPECT_TRUE(ring.closed);
    EXPECT_EQ(ring.end - ring.begin, sides);
    EXPECT_EQ(lines.counts.corners, 0u);
    const std::vector<Vec3> places = places_of(lines.graph, ring);
    for (const Vec3& place : places) EXPECT_GE(place.x(), places[0].x()) << "begins at its lowest place";
    EXPECT_LT(places[1].y(), places.back().y()) << "and goes to the lower of the two neighbours";
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

TEST(FeaturesOfAPrism, DependOnTheAngleOfItsSides_AllAtOnce) {
    const TriangleMesh prism = frustum(1, 1, 1, 36, true);  // its sides meet at 10 degrees
    FeatureParams params;
    EXPECT_EQ(features_of(prism, params).counts.creases, 2u);
    params.sharp_angle = Angle::degrees(10);
    EXPECT_EQ(features_of(prism, params).counts.creases, 2u);
    params.sharp_angle = Angle::degrees(9.999);
    EXPECT_EQ(features_of(prism, params).counts.creases, 3u * 36);
    // The rings turn by as much.
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
    const std::vector<Vec3> places = places_of(lines.graph, lines.graph.polylines[0]);
    EXPECT_EQ(places[0], Vec3(2, 0, 0)) << "begins at its corner, not at its lowest place";
    EXPECT_LT(places[1].x() * 1e3 + places[1].y(), places.back().x() * 1e3 + places.back().y());
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

TEST(FeaturesWithSharpEdgesOfTheMesh, HaveThemAsCreases) {
    TriangleMesh flat = grid(2, 1);
    // The edge between the two squares, and one of the border, which is a line anyhow.
    std::vector<Edge> own;
    for (const Triangle& t : flat.triangles)
        for (int i = 0; i < 3; ++i) {
            const Vec3 &a = flat.positions[t[i]], &b = flat.positions[t[(i + 1) % 3]];
            if ((a.x() == 1 && b.x() == 1) || (a.x() == 0 && b.x() == 0))
                own.push_back(make_edge(t[i], t[(i + 1) % 3]));
        }
    std::ranges::sort(own);
    own.erase(std::ranges::unique(own).begin(), own.end());
    ASSERT_EQ(own.size(), 2u);
    EXPECT_EQ(features_of(flat).counts.creases, 0u);
    flat.sharp_edges = Array<Edge>(own.begin(), own.end());
    const FeatureLines lines = features_of(flat);
    EXPECT_EQ(lines.counts.creases, 1u);
    EXPECT_EQ(lines.counts.corners, 6u) << "the crease ends on the border";
    EXPECT_THAT(places_of(lines.graph, lines.graph.polylines[1]), ElementsAre(Vec3(1, 0, 0), Vec3(1, 1, 0)));
    EXPECT_EQ(lines.graph.left_normals[lines.graph.polylines[1].begin], Vec3::UnitZ());
    EXPECT_EQ(lines.graph.right_normals[lines.graph.polylines[1].begin], Vec3::UnitZ());
}

TEST(FeaturesWithALeastLength, AreChainedAnewWithoutTheShortOnes) {
    // A box of 4 × 1 × 1: its eight edges of length 1 go, the four long ones stay and no longer meet anything.
    TriangleMesh box = cube();
    std::vector<Vec3> positions(box.positions.begin(), box.positions.end());
    for (Vec3& p : positions) p.x() *= 4;
    box.positions = Array<Vec3>(positions.begin(), positions.end());
    FeatureParams params;
    params.min_length = 1;
    EXPECT_EQ(features_of(box, params).counts.creases, 12u) << "as long as the limit is not shorter";
    params.min_length = 1.5;
    const FeatureLines lines = features_of(box, params);
    EXPECT_EQ(lines.counts.dropped, 8u);
    EXPECT_EQ(lines.counts.creases, 4u);
    EXPECT_EQ(lines.counts.corners, 8u) << "where a crease ends";
    params.min_length = 5;
    const FeatureLines none = features_of(box, params);
    EXPECT_EQ(none.counts.dropped, 12u);
    EXPECT_THAT(none.graph.polylines, IsEmpty());
    EXPECT_TRUE(none.graph.positions.empty());
}

TEST(FeaturesWithALeastLength, JoinWhatAShortSpurHadCutInTwo) {
    // A strip bent along y = 0 … 3 at x = 0, its own sharp edge a spur of length 1 that meets the crease in the middle.
    TriangleMesh bent = hinge(60);
    MeshBuilder builder;
    for (const Triangle& t : bent.triangles) {
        std::array<Vec3, 3> p;
        for (std::size_t i = 0; i < 3; ++i) p[i] = bent.positions[t[i]];
        for (const double y : {0.0, 1.0, 2.0, 3.0})
            builder.triangle(p[0] + Vec3(0, y, 0), p[1] + Vec3(0, y, 0), p[2] + Vec3(0, y, 0));
    }
    TriangleMesh strip = builder.mesh();
    const auto vertex_at = [&](const Vec3& place) {
        return static_cast<u32>(std::ranges::find(strip.positions, place) - strip.positions.begin());
    };
    strip.sharp_edges = {make_edge(vertex_at(Vec3(-1, 2, 0)), vertex_at(Vec3(0, 2, 0)))};
    EXPECT_EQ(features_of(strip).counts.creases, 3u);
    FeatureParams params;
    params.min_length = 1.5;
    const FeatureLines lines = features_of(strip, params);
    EXPECT_EQ(lines.counts.dropped, 1u);
    ASSERT_EQ(lines.counts.creases, 1u);
    EXPECT_EQ(length_of(lines.graph, polylines_of(lines.graph, FeatureType::crease)[0]), 4);
}

TEST(FeaturesOfAFlatSquareWithNeedles, AreItsBorder) {
    // The middle of a side as a vertex of a triangle without area, between the two halves.
    const TriangleMesh mesh =
        mesh_of({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}});
    const FeatureLines lines = features_of(mesh);
    EXPECT_EQ(lines.counts.without_area, 1u);
    EXPECT_EQ(lines.counts.creases, 0u);
    EXPECT_EQ(lines.counts.boundaries, 1u);
    EXPECT_EQ(lines.counts.corners, 4u);
}

TEST(FeaturesOfAHingeWithANeedle, FollowTheShortSides) {
    // As above, with one half folded up along the diagonal: the crease goes through the middle.
    const TriangleMesh mesh =
        mesh_of({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 0, 3}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}});
    const FeatureLines lines = features_of(mesh);
    EXPECT_EQ(lines.counts.without_area, 1u);
    ASSERT_EQ(lines.counts.creases, 1u);
    EXPECT_THAT(places_of(lines.graph, polylines_of(lines.graph, FeatureType::crease)[0]),
                ElementsAre(Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(2, 2, 0)));
}

TEST(FeaturesOfAHingeWithNeedlesAmongNeedles, FollowTheShortSides) {
    // Six vertices on the bend, filled with four triangles without area; the middle one has no other neighbours.
    std::vector<Vec3> positions;
    for (int i = 0; i < 6; ++i) positions.emplace_back(i, 0, 0);
    positions.emplace_back(2.5, 2, 0);
    positions.emplace_back(2.5, 0, -3);
    std::vector<Triangle> triangles{{0, 5, 6}, {0, 2, 4}, {4, 5, 0}, {0, 1, 2}, {2, 3, 4}};
    for (u32 i = 0; i < 5; ++i) triangles.push_back({i + 1, i, 7});
    const FeatureLines lines = features_of(mesh_of(positions, triangles));
    EXPECT_EQ(lines.counts.without_area, 4u);
    ASSERT_EQ(lines.counts.creases, 1u);
    EXPECT_THAT(places_of(lines.graph, polylines_of(lines.graph, FeatureType::crease)[0]),
                ElementsAre(Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(4, 0, 0), Vec3(5, 0, 0)));
}

TEST(FeaturesOfAMeshWithDoubledVertices, PassOverTrianglesThatNameAVertexTwice) {
    TriangleMesh mesh = cube();
    std::vector<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    triangles.insert(triangles.begin() + 3, {5, 5, 1});
    mesh.triangles = Array<Triangle>(triangles.begin(), triangles.end());
    const FeatureLines lines = features_of(mesh);
    EXPECT_EQ(lines.counts.without_area, 1u);
    EXPECT_EQ(lines.counts.creases, 12u);
    EXPECT_EQ(lines.counts.corners, 8u);
}

TEST(Features, TellTheirCountsAndTheirDoubts) {
    std::vector<std::string> warnings;
    ContextOptions options;
    options.on_warning = [&](std::string_view text) { warnings.emplace_back(text); };
    Context context(options);
    features(frustum(1, 1, 3, 40, false), {}, context);
    EXPECT_THAT(warnings, ElementsAre(testing::HasSubstr("2 boundary loops whose area does not tell")));
    for (const auto& [name, count] : std::map<std::string, double>{{"creases", 0},
                                                                   {"holes", 1},
                                                                   {"boundaries", 1},
                                                                   {"corners", 0},
                                                                   {"ambiguous", 2},
                                                                   {"dropped", 0},
                                                                   {"without-area", 0}})
        EXPECT_EQ(context.metrics().find(name)->value, count) << name;
}

TEST(Features, KeepTheFrame) {
    TriangleMesh mesh = cube();
    mesh.frame = {LengthUnit::millimetre, Vec3(1e6, 0, -3), "part"};
    EXPECT_EQ(features_of(mesh).graph.frame, mesh.frame);
}

}  // namespace
}  // namespace scanmill
