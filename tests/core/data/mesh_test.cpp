// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

/// Two triangles over vertices 1, 3, 4, 6 of seven, with columns on everything.
TriangleMesh decorated_mesh() {
    TriangleMesh mesh;
    mesh.frame = {LengthUnit::millimetre, Vec3(1000, 0, 0), "part"};
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(3, 0, 0),
                      Vec3(4, 1, 0), Vec3(5, 0, 0), Vec3(6, 1, 0)};
    mesh.triangles = {{1, 3, 4}, {4, 3, 6}};
    mesh.vertex_columns.add(Column("id", 1, Buffer<u32>{0, 1, 2, 3, 4, 5, 6}));
    mesh.face_columns.add(Column("shade", 1, Buffer<u8>{100, 200}));
    // Between used vertices, between a used and an unused one either way round, between unused ones.
    mesh.edges = {make_edge(0, 1), make_edge(1, 3), make_edge(1, 2), make_edge(0, 5), make_edge(3, 6), make_edge(1, 6)};
    mesh.edge_columns.add(Column("angle", 1, Buffer<double>{0.1, 1.3, 1.2, 0.5, 3.6, 1.6}));
    mesh.sharp_edges = {make_edge(0, 2), make_edge(1, 2), make_edge(1, 3), make_edge(2, 3), make_edge(4, 6)};
    return mesh;
}

TEST(Edge, Ends_AreOrdered) {
    EXPECT_EQ(make_edge(2, 7), (Edge{2, 7}));
    EXPECT_EQ(make_edge(7, 2), (Edge{2, 7}));
    EXPECT_EQ(make_edge(5, 5), (Edge{5, 5}));
}

TEST(RequireConsistent, SoundMeshes_Pass) {
    EXPECT_NO_THROW(require_consistent(TriangleMesh{}));
    EXPECT_NO_THROW(require_consistent(cube()));
    EXPECT_NO_THROW(require_consistent(decorated_mesh()));
}

TEST(RequireConsistent, TriangleBeyondTheVertices_IsNamed) {
    for (int corner = 0; corner < 3; ++corner) {
        TriangleMesh mesh = decorated_mesh();
        Triangle bad{0, 1, 2};
        bad[corner] = 7;
        mesh.triangles = {{1, 3, 4}, bad};
        EXPECT_EQ(sentence_of([&] { require_consistent(mesh); }), "triangle 1 names vertex 7; there are 7");
    }
}

TEST(RequireConsistent, EdgeBeyondTheVertices_IsNamed) {
    TriangleMesh mesh = decorated_mesh();
    mesh.edges = {make_edge(0, 1), make_edge(1, 3), make_edge(3, 100), make_edge(5, 6), make_edge(1, 6)};
    EXPECT_EQ(sentence_of([&] { require_consistent(mesh); }), "edge 2 names vertex 100; there are 7");
}

TEST(RequireConsistent, SharpEdgeBeyondTheVertices_IsNamed) {
    TriangleMesh mesh = decorated_mesh();
    mesh.sharp_edges = {make_edge(7, 8)};
    EXPECT_EQ(sentence_of([&] { require_consistent(mesh); }), "sharp edge 0 names vertex 7; there are 7");
}

TEST(RequireConsistent, ColumnOfAnotherLength_IsNamedWithItsElement) {
    TriangleMesh mesh = decorated_mesh();
    mesh.vertex_columns = {};
    mesh.vertex_columns.add(Column("id", 1, Buffer<u32>{1, 2, 3}));
    EXPECT_EQ(sentence_of([&] { require_consistent(mesh); }), "column 'id' has 3 rows for 7 vertices");
    mesh = decorated_mesh();
    mesh.face_columns = {};
    mesh.face_columns.add(Column("shade", 1, Buffer<u8>{1, 2, 3}));
    EXPECT_EQ(sentence_of([&] { require_consistent(mesh); }), "column 'shade' has 3 rows for 2 triangles");
    mesh = decorated_mesh();
    mesh.edges = {make_edge(0, 1)};
    EXPECT_EQ(sentence_of([&] { require_consistent(mesh); }), "column 'angle' has 6 rows for 1 edges");
}

TEST(WithoutUnusedVertices, UsedVertices_KeepTheirOrderTheirColumnsAndTheFrame) {
    const TriangleMesh mesh = decorated_mesh();
    const TriangleMesh compact = without_unused_vertices(mesh);
    EXPECT_NO_THROW(require_consistent(compact));
    EXPECT_THAT(compact.positions.span(), ElementsAre(Vec3(1, 0, 0), Vec3(3, 0, 0), Vec3(4, 1, 0), Vec3(6, 1, 0)));
    EXPECT_THAT(compact.triangles.span(), ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}));
    EXPECT_EQ(*compact.vertex_columns.find("id"), Column("id", 1, Buffer<u32>{1, 3, 4, 6}));
    EXPECT_EQ(compact.face_columns, mesh.face_columns);
    EXPECT_EQ(compact.frame, mesh.frame);
}

TEST(WithoutUnusedVertices, Edges_StayBetweenUsedVerticesWithTheirColumns) {
    const TriangleMesh compact = without_unused_vertices(decorated_mesh());
    EXPECT_THAT(compact.edges.span(), ElementsAre(Edge{0, 1}, Edge{1, 3}, Edge{0, 3}));
    EXPECT_EQ(*compact.edge_columns.find("angle"), Column("angle", 1, Buffer<double>{1.3, 3.6, 1.6}));
    EXPECT_THAT(compact.sharp_edges.span(), ElementsAre(Edge{0, 1}, Edge{2, 3}));
}

TEST(WithoutUnusedVertices, MeshThatUsesAll_ComesBackEqual) {
    const TriangleMesh mesh = icosahedron();
    const TriangleMesh compact = without_unused_vertices(mesh);
    EXPECT_TRUE(std::ranges::equal(compact.positions, mesh.positions));
    EXPECT_TRUE(std::ranges::equal(compact.triangles, mesh.triangles));
}

TEST(WithoutUnusedVertices, NoTriangles_LeaveNothing) {
    TriangleMesh mesh = decorated_mesh();
    mesh.triangles = {};
    mesh.face_columns = {};
    const TriangleMesh compact = without_unused_vertices(mesh);
    EXPECT_TRUE(compact.positions.empty());
    EXPECT_TRUE(compact.edges.empty());
    EXPECT_TRUE(compact.sharp_edges.empty());
    ASSERT_TRUE(compact.vertex_columns.find("id")) << "a column without rows is still a column";
    EXPECT_EQ(compact.edge_columns.find("angle")->rows(), 0u);
}

}  // namespace
}  // namespace scanmill::test
