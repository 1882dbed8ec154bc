// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes of a few triangles, whose flips can be found by hand.

#include <gmock/gmock.h>

#include "filters/edge_flip/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::UnorderedElementsAre;

std::vector<std::string> warnings_of(const TriangleMesh& mesh, const EdgeFlipParams& params) {
    Context context;
    edge_flip(mesh, params, context);
    return context.warnings();
}

TEST(EdgeFlip, LongDiagonalOfAKite_BecomesTheShortOne) {
    for (const Criterion criterion : {Criterion::delaunay, Criterion::shorter}) {
        const EdgeFlipResult result = flipped(kite(), criterion);
        EXPECT_THAT(result.flips, ElementsAre(EdgeFlip{0, 1, 2, 3}));
        EXPECT_THAT(result.mesh.triangles.span(), UnorderedElementsAre(Triangle{3, 2, 0}, Triangle{2, 3, 1}));
        // The triangles have the half angle atan(0.2 / 1) at the ends of the long diagonal, before and after.
        const double half = std::atan(0.2);
        EXPECT_NEAR(result.min_angle_before, half, 1e-15);
        EXPECT_NEAR(result.min_angle_after, 2 * half, 1e-15);
        EXPECT_EQ(result.left.total(), 0u);
    }
}

TEST(EdgeFlip, ShortDiagonalOfAKite_Stays) {
    TriangleMesh mesh = kite();
    mesh.triangles = {{0, 3, 2}, {1, 2, 3}};
    for (const Criterion criterion : all_criteria) {
        const EdgeFlipResult result = flipped(mesh, criterion);
        EXPECT_THAT(result.flips, IsEmpty());
        EXPECT_TRUE(std::ranges::equal(result.mesh.triangles, mesh.triangles)) << "rows and first corners stay";
    }
}

TEST(EdgeFlip, DiagonalsOfASquareAndOfARectangle_AreTies_BothStay) {
    for (const double width : {1.0, 3.0}) {
        TriangleMesh mesh = mesh_of({{0, 0, 0}, {width, 0, 0}, {width, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
        for (const Criterion criterion : all_criteria) EXPECT_THAT(flipped(mesh, criterion).flips, IsEmpty());
        mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
        for (const Criterion criterion : all_criteria) EXPECT_THAT(flipped(mesh, criterion).flips, IsEmpty());
    }
}

TEST(EdgeFlip, CornersOnOneCircle_AreATie_ALittleOffItAreNot) {
    // Angles 0°, 70°, 130° and 250° on the unit circle; the triangulation with the diagonal from the first to the
    // third.
    const auto on_circle = [](double angle, double radius = 1) {
        return Vec3(radius * std::cos(angle * degree), radius * std::sin(angle * degree), 0);
    };
    for (const double radius : {1 - 1e-6, 1.0, 1 + 1e-6}) {
        const TriangleMesh mesh =
            mesh_of({on_circle(0), on_circle(70), on_circle(130), on_circle(250, radius)}, {{0, 1, 2}, {0, 2, 3}});
        // Delaunay: the fourth corner is inside the circle of the other three if its radius is smaller.
        EXPECT_THAT(flipped(mesh).flips, SizeIs(radius < 1 ? 1 : 0)) << radius;
    }
}

TEST(EdgeFlip, DiagonalsOfRegularPolygons_AreTies_HoweverTheirCornersAreRounded) {
    for (u32 corners = 4; corners <= 40; ++corners) {
        std::vector<Vec3> positions;
        std::vector<Triangle> triangles;
        for (u32 i = 0; i < corners; ++i) {
            const double angle = 0.3 + 2 * std::numbers::pi * i / corners;
            positions.emplace_back(1 + 3 * std::cos(angle), 3 * std::sin(angle), 7);
            if (i > 1) triangles.push_back({0, i - 1, i});
        }
        EXPECT_THAT(flipped(mesh_of(positions, triangles)).flips, IsEmpty()) << corners;
    }
}

TEST(EdgeFlip, DiagonalOfANonConvexQuadrilateral_Stays_AndIsNotBlocked) {
    // A dart: the other diagonal is outside.
    const TriangleMesh dart = mesh_of({{0, 0, 0}, {3, 0, 0}, {-1, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {1, 0, 3}});
    for (const Criterion criterion : all_criteria) {
        const EdgeFlipResult result = flipped(dart, criterion);
        if (criterion == Criterion::paper) {
            // The paper's words, taken literally, fold the dart over itself.
            EXPECT_THAT(result.flips, SizeIs(1));
            continue;
        }
        EXPECT_THAT(result.flips, IsEmpty());
        EXPECT_EQ(result.left.total(), 0u);
    }
}

TEST(EdgeFlip, DiagonalThroughACorner_Stays) {
    // Corner 0 is on the other diagonal: a flip would make a triangle without area.
    const TriangleMesh mesh = mesh_of({{0, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {1, 0, 3}});
    for (const Criterion criterion : all_criteria) EXPECT_THAT(flipped(mesh, criterion).flips, IsEmpty());
}

TEST(EdgeFlip, TheOnlyTriangle_AndATetrahedron_Stay) {
    const TriangleMesh one = mesh_of({{0, 0, 0}, {9, 0, 0}, {1, 1, 0}}, {{0, 1, 2}});
    for (const Criterion criterion : all_criteria) {
        EXPECT_THAT(flipped(one, criterion).flips, IsEmpty());
        EXPECT_THAT(flipped(regular_tetrahedron(), criterion).flips, IsEmpty());
    }
}

TEST(EdgeFlip, OfAFlatTetrahedron_IsBlocked_BecauseTheOtherDiagonalExists) {
    const TriangleMesh mesh = mesh_of({{0, 0, 0}, {2, 0, 0}, {1, 0.2, -0.01}, {1, -0.2, -0.01}},
                                      {{0, 1, 2}, {1, 0, 3}, {0, 2, 3}, {1, 3, 2}});
    ASSERT_GT(signed_volume(mesh), 0);
    EdgeFlipParams params;
    EXPECT_EQ(flipped(mesh, params).left.connected, 1u);
    EXPECT_THAT(
        warnings_of(mesh, params),
        ElementsAre(
            "1 edge is not flipped although the criterion is fulfilled: 1 with the other diagonal in use as an edge"));
}

TEST(EdgeFlip, DiagonalsOfACubeStay_WithAndWithoutItsTwelveSharpEdges) {
    TriangleMesh mesh = cube();
    for (const Criterion criterion : all_criteria) EXPECT_THAT(flipped(mesh, criterion).flips, IsEmpty());
    Array<Edge> sharp;
    for (const Edge& edge : edges_of(mesh))
        if ((mesh.positions[edge[0]] - mesh.positions[edge[1]]).norm() == 1) sharp.push_back(edge);
    ASSERT_EQ(sharp.size(), 12u);
    mesh.sharp_edges = std::move(sharp);
    for (const Criterion criterion : all_criteria) {
        const EdgeFlipResult result = flipped(mesh, criterion);
        EXPECT_THAT(result.flips, IsEmpty());
        EXPECT_TRUE(std::ranges::equal(result.mesh.sharp_edges, mesh.sharp_edges));
    }
}

TEST(EdgeFlip, LongEdgesOfAPlate_AreBlocked_WithoutSharpEdgesToo) {
    // Part of a plate: slim triangles in two faces at a right angle, joined by the edge of length 20.
    const TriangleMesh mesh = mesh_of({{0, 0, 0}, {20, 0, 0}, {10, 1, 0}, {10, 0, 1}}, {{0, 1, 2}, {1, 0, 3}});
    for (const Criterion criterion : {Criterion::delaunay, Criterion::shorter}) {
        EdgeFlipParams params;
        params.criterion = criterion;
        const EdgeFlipResult result = flipped(mesh, params);
        EXPECT_THAT(result.flips, IsEmpty());
        EXPECT_EQ(result.left.deviating, 1u) << "the surface would move far more than 10 % of the shorter diagonal";
    }
}

TEST(EdgeFlip, ASharpEdge_StaysAndIsCounted) {
    TriangleMesh mesh = kite();
    mesh.sharp_edges = {{0, 1}};
    const EdgeFlipResult result = flipped(mesh);
    EXPECT_THAT(result.flips, IsEmpty());
    EXPECT_EQ(result.left, (BlockedEdges{.sharp = 1}));
    EXPECT_THAT(warnings_of(mesh, {}),
                ElementsAre("1 edge is not flipped although the criterion is fulfilled: 1 sharp"));
}

TEST(EdgeFlip, ASharpEdgeBesideAFlip_IsStillSharp) {
    // The edge from 1 to 2 belongs to a kite and to a slim triangle beyond; both it and the kite's diagonal may flip.
    const TriangleMesh plain =
        mesh_of({{0, 0, 0}, {2, 0, 0}, {1, 0.2, 0}, {1, -0.2, 0}, {1.55, 0.17, 0}}, {{0, 1, 2}, {1, 0, 3}, {2, 1, 4}});
    EdgeFlipParams params;
    ASSERT_TRUE(edges_of(flipped(plain, params).mesh).count({2, 3})) << "the first kite flips";
    ASSERT_FALSE(edges_of(flipped(plain, params).mesh).count({1, 2})) << "the second one, too";
    TriangleMesh sharp = plain;
    sharp.sharp_edges = {{1, 2}};
    EXPECT_TRUE(edges_of(flipped(sharp, params).mesh).count({2, 3}));
    EXPECT_TRUE(edges_of(flipped(sharp, params).mesh).count({1, 2}));
    EXPECT_EQ(flipped(sharp, params).left.sharp, 1u);
}

TEST(EdgeFlip, OfABentKite_NeedsADeviation) {
    // Bent by 60°, the diagonals are 0.2 sin 30° = 0.1 apart; the short one is 0.4 cos 30° = 0.346 long.
    EdgeFlipParams params;
    params.deviation = Ratio::fraction(0.1 / 0.3465);
    EXPECT_THAT(flipped(kite(60), params).flips, IsEmpty());
    EXPECT_EQ(flipped(kite(60), params).left, (BlockedEdges{.deviating = 1}));
    params.deviation = Ratio::fraction(0.1 / 0.3463);
    EXPECT_THAT(flipped(kite(60), params).flips, SizeIs(1));
    params.deviation = Ratio::percent(10);
    EXPECT_THAT(
        warnings_of(kite(60), params),
        ElementsAre(AllOf(HasSubstr("1 edge is not flipped"),
                          HasSubstr(": 1 where the surface would move by more than 10 % of the shorter diagonal"))));
}

TEST(EdgeFlip, InATiltedPlane_NeedsNoDeviationAndNoBending) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    TriangleMesh mesh = swept(random_plane(100, 5));
    const std::size_t flips = flipped(mesh).flips.size();
    ASSERT_GT(flips, 100u);
    Array<Vec3> positions;
    for (const Vec3& position : mesh.positions) positions.push_back(turn * position + Vec3(5, -3, 2));
    mesh.positions = std::move(positions);
    EdgeFlipParams params;
    params.keep_angle = Angle::degrees(0);
    params.deviation = Ratio::percent(0);
    const EdgeFlipResult result = flipped(mesh, params);
    EXPECT_EQ(result.flips.size(), flips);
    EXPECT_EQ(result.left.total(), 0u);
}

/// A kite, bent by 18 degrees, and a triangle beyond the edge from 1 to 2, bent by 18 degrees in the same direction.
TriangleMesh bent_strip() {
    TriangleMesh mesh = kite(-18);
    std::vector<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    const Vec3 along = (positions[2] - positions[1]).normalized();
    const Vec3 normal = (positions[1] - positions[0]).cross(positions[2] - positions[0]).normalized();
    const Vec3 outwards = Eigen::AngleAxisd(18 * degree, along) * Vec3(along.cross(normal));
    positions.push_back((positions[1] + positions[2]) / 2 + outwards);
    return mesh_of(positions, {{0, 1, 2}, {1, 0, 3}, {2, 1, 4}});
}

TEST(EdgeFlip, ThatWouldBendTheSurfaceMore_NeedsAnAngleToKeep) {
    const TriangleMesh mesh = bent_strip();
    const auto [before, after] = Rules(mesh, {}).largest_bends(0);
    ASSERT_NEAR(before, 18 * degree, 1e-12);
    ASSERT_GT(after, 22 * degree);
    EdgeFlipParams params;
    params.deviation = Ratio::percent(50);
    params.keep_angle = Angle::radians(after - 1e-6);
    EXPECT_EQ(flipped(mesh, params).left, (BlockedEdges{.folding = 1}));
    params.keep_angle = Angle::radians(after + 1e-6);
    EXPECT_THAT(flipped(mesh, params).flips, ElementsAre(EdgeFlip{0, 1, 2, 3}));
    params.keep_angle = Angle::degrees(20);
    EXPECT_THAT(warnings_of(mesh, params),
                ElementsAre(AllOf(HasSubstr("1 edge is not flipped"), HasSubstr(": 1 where triangles would fold"),
                                  HasSubstr("more than 20 deg"))));
}

TEST(EdgeFlip, WhereTheSurfaceBendsAsMuchAlready_NeedsNoAngleToKeep) {
    EdgeFlipParams params;
    params.keep_angle = Angle::degrees(0);
    params.deviation = Ratio::percent(50);
    EXPECT_THAT(flipped(kite(20), params).flips, SizeIs(1)) << "20 degrees become 2 atan(0.2 sin 10°)";
}

TEST(EdgeFlip, ThatMakesALongEdge_NeedsALongMaximum) {
    EdgeFlipParams params;
    params.max_edge = Length(0.4);  // in the kite 0.2 + 0.2, exactly
    EXPECT_EQ(flipped(kite(), params).left, (BlockedEdges{.too_long = 1})) << "not shorter than the maximum";
    EXPECT_THAT(warnings_of(kite(), params),
                ElementsAre(AllOf(HasSubstr("1 edge is not flipped"), HasSubstr(": 1 with"),
                                  HasSubstr("not shorter than max-edge"))));
    params.max_edge = Length(0.4000001);
    EXPECT_THAT(flipped(kite(), params).flips, SizeIs(1));
}

TEST(EdgeFlip, TriangleWithoutArea_IsFlippedAlongItsLongestEdge_First) {
    // The kite's flip is possible, too; the cap of the three collinear corners comes later in the list.
    const TriangleMesh mesh = mesh_of({{0, 0, 0},
                                       {2, 0, 0},
                                       {1, 0.2, 0},
                                       {1, -0.2, 0},  //
                                       {5, 0, 0},
                                       {7, 0, 0},
                                       {5.5, 0, 0},
                                       {6, -1, 0}},
                                      {{0, 1, 2}, {1, 0, 3}, {4, 5, 6}, {5, 4, 7}});
    for (const Criterion criterion : {Criterion::delaunay, Criterion::shorter}) {
        const EdgeFlipResult result = flipped(mesh, criterion);
        EXPECT_THAT(result.flips, ElementsAre(EdgeFlip{4, 5, 6, 7}, EdgeFlip{0, 1, 2, 3}));
        EXPECT_EQ(result.min_angle_before, 0);
        EXPECT_GT(result.min_angle_after, 15 * degree);
    }
}

TEST(EdgeFlip, TrianglesWithoutAreaAtACrease_AreFlipped_TheyHaveTheNormalOfTheirNeighbour) {
    // A wall on a floor, at a right angle and leaning over it; on the line where they meet are two more vertices of the
    // wall, with caps.
    for (const Vec3& up : {Vec3(0, 0, 1), Vec3(0.6, 0, 0.8)}) {
        // Two caps, the floor, the wall.
        const std::vector<Triangle> triangles{{0, 1, 3}, {0, 3, 2}, {4, 5, 1}, {4, 1, 0},
                                              {0, 2, 6}, {2, 3, 6}, {3, 7, 6}, {3, 1, 7}};
        const TriangleMesh mesh = mesh_of(
            {{0, 0, 0}, {0, 3, 0}, {0, 1, 0}, {0, 2, 0}, {1, 0, 0}, {1, 3, 0}, up, up + Vec3(0, 3, 0)}, triangles);
        ASSERT_EQ(topology(mesh).nonmanifold_edges + topology(mesh).misoriented_edges, 0u);
        const EdgeFlipResult result = flipped(mesh);
        EXPECT_GT(result.min_angle_after, 15 * degree);
        EXPECT_NEAR(area(result.mesh), area(mesh), 1e-12) << "the crease is where it was";
        EXPECT_EQ(result.left.folding, 0u);
        expect_laws(mesh, result, {});
    }
}

TEST(EdgeFlip, OfCollinearCorners_DoesNothing) {
    const std::vector<Triangle> triangles{{0, 1, 2}, {1, 0, 3}};
    for (const TriangleMesh& mesh : {mesh_of({{0, 0, 0}, {3, 0, 0}, {1, 0, 0}, {2, 0, 0}}, triangles),
                                     mesh_of({{0, 0, 0}, {3, 0, 0}, {-1, 0, 0}, {-2, 0, 0}}, triangles)})
        for (const Criterion criterion : all_criteria) {
            const EdgeFlipResult result = flipped(mesh, criterion);
            EXPECT_THAT(result.flips, IsEmpty());
            EXPECT_EQ(result.min_angle_after, 0);
            // Between the corners 2 and 3 the quadrilateral is not convex: two straight angles at corner 0.
            if (mesh.positions[2].x() < 0) {
                EXPECT_EQ(result.left.total(), 0u);
            }
        }
}

TEST(EdgeFlip, KeepsVertexColumnsSharpEdgesAndFrame_DropsFaceAndEdgeColumns) {
    TriangleMesh mesh = kite();
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    positions.emplace_back(7, 7, 7);  // in no triangle
    mesh.positions = std::move(positions);
    mesh.frame.origin = Vec3(1e6, 2e6, 0);
    mesh.frame.unit = LengthUnit::millimetre;
    mesh.sharp_edges = {{0, 2}};
    mesh.vertex_columns.add(Column("quality", 1, Buffer<float>{1, 2, 3, 4, 5}));
    mesh.face_columns.add(Column("patch", 1, Buffer<u32>{8, 9}));
    mesh.face_columns.add(Column("side", 1, Buffer<u32>{1, 1}));
    mesh.edges = {{0, 1}};
    mesh.edge_columns.add(Column("angle", 1, Buffer<float>{0.5f}));
    Context context;
    const EdgeFlipResult result = edge_flip(mesh, {}, context);
    EXPECT_EQ(result.mesh.positions.size(), 5u);
    EXPECT_EQ(result.mesh.frame.origin, mesh.frame.origin);
    EXPECT_EQ(result.mesh.frame.unit, LengthUnit::millimetre);
    EXPECT_EQ(result.mesh.vertex_columns, mesh.vertex_columns);
    EXPECT_THAT(result.mesh.sharp_edges.span(), ElementsAre(Edge{0, 2}));
    EXPECT_TRUE(result.mesh.face_columns.empty());
    EXPECT_TRUE(result.mesh.edges.empty());
    EXPECT_TRUE(result.mesh.edge_columns.empty());
    EXPECT_THAT(context.warnings(),
                ElementsAre("face columns are dropped, because flips replace triangles: 'patch', 'side'",
                            "edge columns are dropped, because flips replace edges: 'angle'"));
}

TEST(EdgeFlip, ReportsItsMetrics) {
    TriangleMesh mesh = kite();
    Context context;
    double progress = 0;
    edge_flip(mesh, {}, context);
    const auto metric = [&](std::string_view name) { return context.metrics().find(name)->value; };
    EXPECT_EQ(metric("flips"), 1);
    EXPECT_EQ(metric("left"), 0);
    EXPECT_NEAR(metric("min-angle-before"), std::atan(0.2), 1e-15);
    EXPECT_NEAR(metric("min-angle-after"), 2 * std::atan(0.2), 1e-15);
    EXPECT_EQ(context.metrics().find("min-angle-after")->unit, Unit::angle);
    EXPECT_THAT(context.warnings(), IsEmpty());
    ContextOptions options;
    options.on_progress = [&](double fraction) {
        EXPECT_GE(fraction, progress);
        progress = fraction;
    };
    Context watched(options);
    edge_flip(swept(random_plane(20'000, 1)), {}, watched);
    EXPECT_EQ(progress, 1);
}

TEST(EdgeFlip, StopsWhenCancelled) {
    const TriangleMesh mesh = swept(random_plane(20'000, 1));
    for (const int calls : {0, 1, 3}) {
        ContextOptions options;
        int left = calls;
        options.is_cancelled = [&] { return left-- == 0; };
        Context context(options);
        EXPECT_THROW(edge_flip(mesh, {}, context), Cancelled) << calls;
    }
}

}  // namespace
}  // namespace scanmill
