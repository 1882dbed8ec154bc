// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "repair/repair.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/mesh_operations.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Repaired : RepairResult {
    std::vector<std::string> doubts, warnings;
    Metrics metrics;
    double metric(std::string_view name) const { return metrics.find(name)->value; }
};
Repaired repaired(const TriangleMesh& mesh, const RepairParams& params = {}) {
    Context context;
    return {repair(mesh, params, context), doubts_of(context), context.warnings(), context.metrics()};
}

/// Some triangles reversed.
TriangleMesh muddled(const TriangleMesh& mesh, std::uint64_t seed, double share) {
    Random random(seed);
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    for (Triangle& triangle : triangles)
        if (random.uniform() < share) std::swap(triangle[0], triangle[1]);
    TriangleMesh result = mesh;
    result.triangles = std::move(triangles);
    return result;
}

void expect_manifold(const TriangleMesh& mesh) {
    const MeshTopology shape = topology(mesh);
    EXPECT_EQ(shape.nonmanifold_edges, 0u);
    EXPECT_EQ(shape.nonmanifold_vertices, 0u);
    EXPECT_EQ(shape.misoriented_edges, 0u);
    EXPECT_EQ(shape.degenerate_triangles, 0u);
    EXPECT_EQ(shape.unused_vertices, 0u);
    EXPECT_NO_THROW(require_consistent(mesh));
}

TEST(Repair, OfAGoodMesh_ChangesNothing) {
    for (const TriangleMesh& mesh : {cube(), torus(3, 1, 9, 7), without_triangles(icosahedron(), {3})}) {
        const Repaired result = repaired(mesh);
        EXPECT_TRUE(std::ranges::equal(result.mesh.triangles, mesh.triangles));
        EXPECT_TRUE(std::ranges::equal(result.mesh.positions, mesh.positions));
        for (const char* name : {"oriented", "stitched", "split-vertices", "split-edges", "removed-triangles",
                                 "removed-components", "removed-points", "flipped"})
            EXPECT_EQ(result.metric(name), 0) << name;
        EXPECT_THAT(result.doubts, IsEmpty());
        EXPECT_THAT(result.warnings, IsEmpty());
    }
}

TEST(Repair, OfAnOrientedManifold_CopiesNothing_UnlessItDescribesOtherEdges) {
    TriangleMesh mesh = cube();
    const auto& [a, b, c] = mesh.triangles[0];
    mesh.sharp_edges = Array<Edge>{make_edge(a, b)};
    EXPECT_EQ(repaired(mesh).mesh.triangles.data(), mesh.triangles.data());
    const auto is_edge = [&](const Edge& edge) {
        return std::ranges::any_of(mesh.triangles, [&](const Triangle& t) {
            return std::ranges::count(t, edge[0]) + std::ranges::count(t, edge[1]) == 2;
        });
    };
    Array<Edge> sharp;
    for (u32 v = 1; v < 8; ++v) sharp.push_back({0, v});
    mesh.sharp_edges = sharp;
    const Repaired result = repaired(mesh);
    EXPECT_EQ(result.mesh.sharp_edges.size(), static_cast<std::size_t>(std::ranges::count_if(sharp, is_edge)));
    EXPECT_LT(result.mesh.sharp_edges.size(), sharp.size());
}

TEST(Repair, OfASoup_IsTheClosedMesh) {
    const Repaired result = repaired(separate(cube()));
    EXPECT_EQ(result.stitched, 36u - 8u);
    EXPECT_EQ(result.mesh.positions.size(), 8u);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_DOUBLE_EQ(signed_volume(result.mesh), 1);
    EXPECT_EQ(result.metric("components"), 1);
    EXPECT_EQ(result.metric("boundary-loops"), 0);
}

TEST(Repair, OrientsClosedSurfacesOutwards_WhateverTheInputHad) {
    for (const double share : {0.2, 0.5, 0.8}) {
        const TriangleMesh whole = geodesic_sphere(1, 4), mesh = muddled(whole, 5, share);
        const Repaired result = repaired(mesh);
        expect_manifold(result.mesh);
        EXPECT_NEAR(signed_volume(result.mesh), signed_volume(whole), 1e-9);
        std::size_t reversed = 0;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) reversed += mesh.triangles[t] != whole.triangles[t];
        EXPECT_EQ(result.oriented, reversed);
    }
}

TEST(Repair, AMeshThatIsInsideOut_IsTurned_ACavityIsNot) {
    const TriangleMesh sphere = geodesic_sphere(1, 4), hollow = both(geodesic_sphere(2, 4), muddled(sphere, 1, 1));
    const Repaired turned = repaired(muddled(sphere, 1, 1));
    EXPECT_EQ(turned.oriented, sphere.triangles.size());
    EXPECT_NEAR(signed_volume(turned.mesh), signed_volume(sphere), 1e-9);
    EXPECT_EQ(repaired(hollow).oriented, 0u);
    const Repaired open = repaired(without_triangles(muddled(sphere, 1, 1), {0}));
    EXPECT_EQ(open.oriented, 0u);
}

TEST(Repair, BodiesThatFaceInwards_AreTurnedBesideOthers_ACavityInACavityFacesOutwards) {
    const TriangleMesh large = geodesic_sphere(3, 4), middle = geodesic_sphere(2, 4), small = geodesic_sphere(1, 4);
    const TriangleMesh nested = both(both(muddled(large, 1, 1), middle), muddled(small, 1, 1));
    const Repaired result = repaired(nested);
    EXPECT_EQ(result.oriented, nested.triangles.size());
    EXPECT_NEAR(signed_volume(result.mesh), signed_volume(large) - signed_volume(middle) + signed_volume(small), 1e-9);
}

TEST(Repair, TwoCubesWithOneWall_AreSeparatedAndDoubtful) {
    const Repaired result = repaired(both(cube(), shifted(cube(), {1, 0, 0})));
    EXPECT_GT(result.metric("boundary-loops"), 0);
    EXPECT_THAT(result.doubts, ElementsAre(AllOf(HasSubstr("the mesh had no boundary"), HasSubstr("edges had three"))));
    EXPECT_THAT(repaired(without_triangles(cube(), {0})).doubts, IsEmpty()) << "it had a boundary before";
}

TEST(Repair, OrientsOpenSurfaces_AsTheLargerArea) {
    // Three triangles in a row; the one that is reversed is the first.
    const TriangleMesh mesh =
        soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 0, 0}}, {{1, 0, 2}, {1, 3, 2}, {1, 4, 3}});
    const Repaired result = repaired(mesh);
    EXPECT_EQ(result.oriented, 1u);
    for (const auto& [a, b, c] : result.mesh.triangles) {
        const std::span<const Vec3> p = result.mesh.positions.span();
        EXPECT_GT((p[b] - p[a]).cross(p[c] - p[a]).z(), 0);
    }
    // As much area in both directions: as the first triangle.
    const TriangleMesh even = soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{1, 0, 2}, {1, 3, 2}});
    EXPECT_THAT(repaired(even).mesh.triangles[0], ElementsAre(1, 0, 2));
    EXPECT_EQ(repaired(even).oriented, 1u);
}

TEST(Repair, SplitsAnEdgeOfTwoCubes_IntoTwoClosedCubes) {
    // Soups share the edge from (1, 1, 0) to (1, 1, 1).
    const TriangleMesh mesh = both(cube(), shifted(cube(), {1, 1, 0}));
    const Repaired result = repaired(mesh);
    EXPECT_EQ(result.stitched, 2u);
    EXPECT_EQ(result.split_edges, 1u);
    EXPECT_EQ(result.split_vertices, 2u);
    expect_manifold(result.mesh);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(topology(result.mesh).components, 2u);
    EXPECT_NEAR(signed_volume(result.mesh), 2, 1e-12);
    const Repaired again = repaired(result.mesh);
    EXPECT_TRUE(std::ranges::equal(again.mesh.triangles, result.mesh.triangles));
}

TEST(Repair, SplitsAVertexWhereTwoSurfacesMeet) {
    const Repaired result = repaired(both(cube(), shifted(cube(), {1, 1, 1})));
    EXPECT_EQ(result.stitched, 1u);
    EXPECT_EQ(result.split_edges, 0u);
    EXPECT_EQ(result.split_vertices, 1u);
    expect_manifold(result.mesh);
}

TEST(Repair, AFin_IsCutOff) {
    const TriangleMesh mesh =
        soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
    const Repaired result = repaired(mesh);
    EXPECT_EQ(result.split_edges, 1u);
    expect_manifold(result.mesh);
    EXPECT_EQ(result.mesh.triangles.size(), 3u);
}

TEST(Repair, AMoebiusStrip_IsCut) {
    // Five triangles around; the last edge is joined after half a turn.
    Array<Vec3> positions;
    for (int i = 0; i < 5; ++i) positions.emplace_back(std::cos(i * 1.2566), std::sin(i * 1.2566), 0.3 * (i % 2));
    const TriangleMesh mesh = soup(std::move(positions), {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 0}, {4, 0, 1}});
    const Repaired result = repaired(mesh);
    expect_manifold(result.mesh);
    EXPECT_GT(result.split_vertices, 0u);
    EXPECT_EQ(result.mesh.triangles.size(), 5u);
}

TEST(Repair, AKleinBottle_IsCutAndDoubtful) {
    const TriangleMesh bottle = klein_bottle(24, 12);
    ASSERT_EQ(topology(bottle).boundary_edges, 0u);
    for (const TriangleMesh& mesh : {bottle, separate(bottle)}) {
        const Repaired result = repaired(mesh);
        expect_manifold(result.mesh);
        EXPECT_EQ(result.mesh.triangles.size(), bottle.triangles.size());
        EXPECT_NEAR(area(result.mesh), area(bottle), 1e-9);
        EXPECT_GT(result.metric("boundary-loops"), 0);
        EXPECT_THAT(result.doubts, ElementsAre(AllOf(HasSubstr("the mesh had no boundary"), HasSubstr("one-sided"))));
    }
}

TEST(Repair, TrianglesThatCoverEachOther_AreOpenAndDoubtful) {
    const Repaired result = repaired(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}));
    EXPECT_EQ(result.mesh.triangles.size(), 1u);
    EXPECT_THAT(result.doubts, ElementsAre(HasSubstr("1 triangle was removed")));
}

TEST(Repair, DropsTriangles_WithARepeatedVertexOrASecondTime) {
    TriangleMesh mesh = cube();
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    triangles.push_back({1, 1, 2});
    triangles.push_back({triangles[4][1], triangles[4][0], triangles[4][2]});
    triangles.push_back(triangles[0]);
    mesh.triangles = std::move(triangles);
    const Repaired result = repaired(mesh);
    EXPECT_EQ(result.repeated_vertex, 1u);
    EXPECT_EQ(result.duplicates, 2u);
    EXPECT_EQ(result.metric("removed-triangles"), 3);
    EXPECT_TRUE(std::ranges::equal(result.mesh.triangles, cube().triangles)) << "the first of equal ones stays";
}

TEST(Repair, TrianglesWithoutArea_AreFlippedOrDropped) {
    // The needle (0, 1, 4) has its middle vertex 4 on the edge between 0 and 1.
    const TriangleMesh inside =
        soup({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}, {1, 0, 0}}, {{0, 4, 2}, {4, 1, 2}, {0, 1, 4}, {1, 0, 3}});
    const Repaired flipped = repaired(inside);
    EXPECT_EQ(flipped.flipped, 1u);
    EXPECT_EQ(flipped.mesh.triangles.size(), 4u);
    EXPECT_DOUBLE_EQ(area(flipped.mesh), 2);
    expect_manifold(flipped.mesh);
    for (const auto& [a, b, c] : flipped.mesh.triangles) {
        const std::span<const Vec3> p = flipped.mesh.positions.span();
        EXPECT_EQ((p[b] - p[a]).cross(p[c] - p[a]).norm(), 1) << "four equal triangles";
    }
    const TriangleMesh border = without_triangles(inside, {3});
    const Repaired dropped = repaired(border);
    EXPECT_EQ(dropped.without_area, 1u);
    EXPECT_EQ(dropped.mesh.triangles.size(), 2u);
    EXPECT_EQ(dropped.unused_points, 1u) << "vertex 3 was in the triangle that is missing";
}

TEST(Repair, SurfacesThatOnlyATriangleWithoutAreaJoined_AreSeparated) {
    // The last triangle has vertex 2 between 0 and 1. Without it, two triangles touch in 2.
    TriangleMesh mesh =
        soup({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {1.5, 1, 0}}, {{0, 2, 3}, {2, 1, 4}, {1, 2, 0}});
    mesh.sharp_edges = {make_edge(2, 3), make_edge(2, 4)};
    mesh.edges = {make_edge(2, 3), make_edge(2, 4)};
    mesh.edge_columns.add(Column("mark", 1, Buffer<u32>{7, 8}));
    const Repaired result = repaired(mesh);
    expect_manifold(result.mesh);
    EXPECT_EQ(result.without_area, 1u);
    EXPECT_EQ(result.split_vertices, 1u);
    EXPECT_EQ(topology(result.mesh).components, 2u);
    ASSERT_EQ(result.mesh.sharp_edges.size(), 2u) << "copies of vertices keep their sharp edges";
    ASSERT_EQ(result.mesh.edges.size(), 2u);
    for (std::size_t row = 0; row < 2; ++row) {
        const auto& [a, b] = result.mesh.edges[row];
        EXPECT_EQ(result.mesh.positions[a] + result.mesh.positions[b], row == 0 ? Vec3(1.5, 1, 0) : Vec3(2.5, 1, 0));
    }
}

TEST(Repair, TrianglesWithoutArea_AreDroppedOneAfterAnother) {
    // The triangle of 1, 0 and 5 covers that of 1, 2 and 0. When it is gone, two fans meet in 1; then in 2.
    const TriangleMesh mesh = soup({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {1.5, 1, 0}, {3, 0, 0}, {2.5, 1, 0}},
                                   {{0, 2, 3}, {2, 1, 4}, {1, 2, 0}, {1, 0, 5}, {1, 5, 6}});
    const Repaired result = repaired(mesh);
    expect_manifold(result.mesh);
    EXPECT_EQ(result.without_area, 2u);
    EXPECT_EQ(result.split_vertices, 2u);
    EXPECT_EQ(result.mesh.triangles.size(), 3u);
    EXPECT_EQ(topology(result.mesh).components, 3u);
    EXPECT_EQ(area(result.mesh), 1.5);
}

TEST(Repair, SharpEdgesOfAFlippedNeedle_StaySharp) {
    TriangleMesh mesh =
        soup({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}, {1, 0, 0}}, {{0, 4, 2}, {4, 1, 2}, {0, 1, 4}, {1, 0, 3}});
    mesh.sharp_edges = {make_edge(0, 1)};
    const Repaired result = repaired(mesh);
    EXPECT_THAT(std::vector<Edge>(result.mesh.sharp_edges.begin(), result.mesh.sharp_edges.end()),
                ElementsAre(Edge{0, 4}, Edge{1, 4}));
}

TEST(Repair, Stitch_JoinsBoundariesWithinTheLength) {
    // Two unit squares with a gap of 0.25 between them.
    const TriangleMesh mesh = both(rectangle(1, 1), shifted(rectangle(1, 1), {1.25, 0, 0}));
    RepairParams params;
    params.stitch = Length(0.25);  // exactly: they are joined
    const Repaired result = repaired(mesh, params);
    EXPECT_EQ(result.stitched, 2u);
    EXPECT_EQ(topology(result.mesh).components, 1u);
    EXPECT_EQ(result.mesh.positions.size(), 6u);
    EXPECT_EQ(result.mesh.positions[1], Vec3(1, 0, 0)) << "the lower row stays where it is";
    EXPECT_DOUBLE_EQ(area(result.mesh), 2.25);
    params.stitch = Length(std::nextafter(0.25, 0));
    EXPECT_EQ(repaired(mesh, params).stitched, 0u);
}

TEST(Repair, Stitch_TakesTheNearestThenTheLowerRow) {
    // The corner (1, 0) of the last triangle is 0.25 from that of both others.
    const TriangleMesh mesh = soup(
        {{0.75, 0, 0}, {0, 5, 0}, {-5, 0, 0}, {1.25, 0, 0}, {2, 5, 0}, {1.5, 8, 0}, {1, 0, 0}, {1, -5, 0}, {2, -5, 0}},
        {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}});
    RepairParams params;
    params.stitch = Length(0.3);
    const Repaired result = repaired(mesh, params);
    EXPECT_EQ(result.stitched, 1u);
    EXPECT_EQ(result.split_vertices, 1u) << "two fans meet there";
    std::size_t at_lower = 0;
    for (const Vec3& p : result.mesh.positions) at_lower += p == Vec3(0.75, 0, 0);
    EXPECT_EQ(at_lower, 2u);
}

TEST(Repair, ATinyStitch_JoinsEqualPositionsOnly) {
    const TriangleMesh mesh = both(rectangle(1, 1), shifted(rectangle(1, 1), {1, 0, 0}));
    RepairParams params;
    for (const double stitch : {1e-300, 1e-30, 0x1p-52}) {
        params.stitch = Length(stitch);
        EXPECT_EQ(repaired(mesh, params).stitched, 2u) << stitch;
    }
}

TEST(Repair, AStitchThatCollapses_IsDoubtful) {
    RepairParams params;
    params.stitch = Length(1.1);
    const TriangleMesh mesh = both(rectangle(1, 1), shifted(rectangle(4, 2), {20, 0, 0}));
    const Repaired result = repaired(mesh, params);
    EXPECT_GT(result.repeated_vertex, 0u);
    EXPECT_THAT(result.doubts, ElementsAre(HasSubstr("that stitch collapses")));
    params.stitch = Length(100);
    EXPECT_THAT(error_of([&] { repaired(mesh, params); }).hint(), HasSubstr("lower stitch"));
}

TEST(Repair, SmallComponents_AreRemoved_ThoseAtTheLimitStay) {
    // Areas 6 and 2: a quarter.
    const TriangleMesh mesh = both(cube(), shifted(rectangle(2, 1), {5, 0, 0}));
    RepairParams params;
    params.min_component = Ratio::percent(25);
    EXPECT_EQ(repaired(mesh, params).removed_components, 0u);
    params.min_component = Ratio::percent(26);
    const Repaired result = repaired(mesh, params);
    EXPECT_EQ(result.removed_components, 1u);
    EXPECT_EQ(result.small, 2u);
    EXPECT_EQ(result.unused_points, 4u);
    EXPECT_EQ(result.mesh.positions.size(), 8u);
    EXPECT_THAT(result.doubts, ElementsAre(HasSubstr("25.0 % of the area were removed")));
}

TEST(Repair, Columns_FollowTheirRows) {
    TriangleMesh mesh = both(cube(), shifted(cube(), {1, 1, 0}));
    Array<u32> rows(mesh.positions.size()), faces(mesh.triangles.size());
    std::iota(rows.begin(), rows.end(), 0);
    std::iota(faces.begin(), faces.end(), 0);
    mesh.vertex_columns.add(Column("row", 1, Buffer<u32>(std::move(rows))));
    mesh.face_columns.add(Column("row", 1, Buffer<u32>(std::move(faces))));
    const Triangle first = mesh.triangles[20];
    mesh.edges = {make_edge(first[0], first[1])};
    mesh.edge_columns.add(Column("mark", 1, Buffer<u32>{7}));
    mesh.sharp_edges = {make_edge(first[1], first[2])};
    const Repaired result = repaired(mesh);
    const std::span<const u32> row = result.mesh.vertex_columns.find("row")->values<u32>();
    for (std::size_t v = 0; v < row.size(); ++v) EXPECT_EQ(result.mesh.positions[v], mesh.positions[row[v]]);
    const std::span<const u32> face = result.mesh.face_columns.find("row")->values<u32>();
    ASSERT_EQ(face.size(), 24u);
    for (std::size_t t = 0; t < 24; ++t) EXPECT_EQ(face[t], t);
    ASSERT_EQ(result.mesh.edges.size(), 1u);
    EXPECT_EQ(result.mesh.edge_columns.find("mark")->values<u32>()[0], 7u);
    const auto at = [](const TriangleMesh& in, const Edge& edge) {
        return std::pair(in.positions[edge[0]] + in.positions[edge[1]],
                         (in.positions[edge[0]] - in.positions[edge[1]]).norm());
    };
    EXPECT_EQ(at(result.mesh, result.mesh.edges[0]), at(mesh, mesh.edges[0]));
    ASSERT_GE(result.mesh.sharp_edges.size(), 1u);
    EXPECT_EQ(at(result.mesh, result.mesh.sharp_edges[0]), at(mesh, mesh.sharp_edges[0]));
}

/// With a "normal" along x at every corner, whose length is the vertex's number plus one.
void add_corner_normals(TriangleMesh& mesh) {
    Array<float> values;
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) values.insert(values.end(), {static_cast<float>(vertex + 1), 0, 0});
    mesh.face_columns.add(Column("corner-normals", 9, Buffer<float>(std::move(values))));
}

TEST(Repair, CornerNormals_FollowTheirCorners) {
    TriangleMesh mesh = muddled(geodesic_sphere(1, 3), 5, 0.3);
    add_corner_normals(mesh);
    const Repaired result = repaired(mesh);
    ASSERT_GT(result.oriented, 0u);
    const Column& column = *result.mesh.face_columns.find("corner-normals");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle &now = result.mesh.triangles[t], &input = mesh.triangles[t];
        const auto first = static_cast<std::size_t>(std::ranges::find(input, now[0]) - input.begin());
        const double sign = input[(first + 1) % 3] == now[1] ? 1 : -1;
        for (u32 i = 0; i < 3; ++i) ASSERT_EQ(column.number(t, 3 * i), sign * (now[i] + 1)) << t;
    }
}

TEST(Repair, CornerNormalsOfFlippedTriangles_AreTheirOwn) {
    TriangleMesh mesh =
        soup({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}, {1, 0, 0}}, {{0, 4, 2}, {4, 1, 2}, {0, 1, 4}, {1, 0, 3}});
    add_corner_normals(mesh);
    const Repaired result = repaired(mesh);
    ASSERT_EQ(result.flipped, 1u);
    const Column& column = *result.mesh.face_columns.find("corner-normals");
    for (u32 k = 0; k < 9; ++k) {
        EXPECT_EQ(column.number(0, k), mesh.face_columns.find("corner-normals")->number(0, k));
        for (const std::size_t t : {2, 3}) EXPECT_EQ(column.number(t, k), k % 3 == 2 ? 1 : 0);
    }
}

TEST(Repair, RandomSoups_BecomeManifolds) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        Random random(seed);
        Array<Vec3> positions;
        for (int i = 0; i < 40; ++i) positions.emplace_back(random.uniform(), random.uniform(), random.uniform());
        Array<Triangle> triangles;
        const auto vertex = [&] { return static_cast<u32>(random.uniform() * 40); };
        for (int i = 0; i < 400; ++i) triangles.push_back({vertex(), vertex(), vertex()});
        const TriangleMesh mesh = soup(std::move(positions), std::move(triangles));
        const Repaired result = repaired(mesh);
        expect_manifold(result.mesh);
        EXPECT_EQ(result.mesh.triangles.size() + result.repeated_vertex + result.duplicates, 400u);
        EXPECT_NEAR(area(result.mesh), area(repaired(separate(result.mesh)).mesh), 1e-9);
    }
}

TEST(Repair, RandomSoupsWithManyTrianglesWithoutArea_BecomeManifolds) {
    // With three values per coordinate, one of ten triangles has its corners on one line.
    std::size_t without_area = 0, flipped = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Random random(seed);
        const auto number = [&](int values) { return static_cast<u32>(random.uniform() * values); };
        Array<Vec3> positions;
        for (u32 i = 0; i < 18; ++i) positions.emplace_back(i % 3, i / 3 % 3, i / 9);
        Array<Triangle> triangles;
        for (int i = 0; i < 25; ++i) triangles.push_back({number(18), number(18), number(18)});
        TriangleMesh mesh = soup(std::move(positions), std::move(triangles));
        const Repaired result = repaired(mesh);
        const MeshTopology shape = topology(result.mesh);
        EXPECT_EQ(shape.nonmanifold_edges, 0u) << seed;
        EXPECT_EQ(shape.nonmanifold_vertices, 0u) << seed;
        EXPECT_EQ(shape.misoriented_edges, 0u) << seed;
        EXPECT_EQ(shape.unused_vertices, 0u) << seed;
        without_area += result.without_area;
        flipped += result.flipped;
    }
    EXPECT_GT(without_area, 50u);
    EXPECT_GT(flipped, 0u);
}

TEST(RepairRefuses, NoTriangles) {
    const Error error = error_of([] { repaired({}); });
    EXPECT_EQ(error.sentence(), "the mesh has no triangles; repair needs at least one");
    EXPECT_FALSE(error.hint().empty());
}

TEST(RepairRefuses, NaN) {
    TriangleMesh mesh = cube();
    Array<Vec3> positions(8, Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0));
    mesh.positions = std::move(positions);
    EXPECT_THAT(error_of([&] { repaired(mesh); }).sentence(), HasSubstr("8 of 8 vertices"));
}

TEST(RepairRefuses, ParametersOutOfRange) {
    RepairParams params;
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double stitch : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
        params.stitch = Length(stitch);
        const Error error = error_of([&] { repaired(cube(), params); });
        EXPECT_THAT(error.sentence(), HasSubstr("stitch must be 0 or more"));
        EXPECT_FALSE(error.hint().empty());
    }
    params = {};
    for (const double share : {-0.01, nan}) {
        params.min_component = Ratio::fraction(share);
        EXPECT_THAT(error_of([&] { repaired(cube(), params); }).sentence(), HasSubstr("min-component must be from 0"));
    }
    params.min_component = Ratio::percent(101);
    const Error error = error_of([&] { repaired(cube(), params); });
    EXPECT_THAT(error.sentence(), HasSubstr("min-component must be from 0 to 100 %; it is 101 %"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(RepairRefuses, AMeshOfSpecksOnly) {
    TriangleMesh mesh = soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    for (int i = 1; i < 4; ++i)
        mesh = both(mesh, shifted(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), {5.0 * i, 0, 0}));
    RepairParams params;
    params.min_component = Ratio::percent(30);
    const Error error = error_of([&] { repaired(mesh, params); });
    EXPECT_EQ(error.sentence(),
              "each of the 4 components is below min-component: the largest has 25 % of the area, and 30 % are needed");
    EXPECT_THAT(error.hint(), HasSubstr("lower min-component"));
}

TEST(RepairRefuses, TrianglesOnOneLine) {
    const TriangleMesh line = soup({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 0, 0}}, {{0, 1, 2}, {1, 2, 3}});
    EXPECT_EQ(error_of([&] { repaired(line); }).sentence(), "the corners of every triangle are on one line");
    const TriangleMesh point = soup({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}});
    EXPECT_EQ(error_of([&] { repaired(point); }).sentence(),
              "no triangle has three different corners; the mesh has 1 triangle");
}

TEST(Repair, Cancelled_Ends) {
    for (int after = 0; after < 5; ++after) {
        ContextOptions options;
        options.is_cancelled = [left = after]() mutable { return left-- <= 0; };
        Context context(options);
        EXPECT_THROW(repair(separate(cube()), {}, context), Cancelled) << after;
    }
}

TEST(RepairReal, AMuddledScan_IsTheScan) {
    SCANMILL_REAL_SCAN(path, shared_data, "4-open/holes.off");
    const TriangleMesh mesh = *read_mesh(path);
    const Repaired result = repaired(muddled(separate(mesh), 3, 0.3));
    expect_manifold(result.mesh);
    const MeshTopology before = topology(mesh), after = topology(result.mesh);
    EXPECT_EQ(after.triangles, before.triangles);
    EXPECT_EQ(after.boundary_edges, before.boundary_edges);
    EXPECT_EQ(after.components, before.components);
    EXPECT_EQ(after.euler, before.euler);
}

}  // namespace
}  // namespace scanmill::test
