// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/topology.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "scanmill/base/random.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

/// Positions do not matter to topology: `vertices` of them, all at zero.
TriangleMesh abstract_mesh(std::size_t vertices, std::initializer_list<Triangle> triangles) {
    TriangleMesh mesh;
    mesh.positions = Array<Vec3>(vertices, Vec3::Zero());
    mesh.triangles = triangles;
    return mesh;
}

/// Both meshes as one, the second's vertices after the first's.
TriangleMesh side_by_side(const TriangleMesh& first, const TriangleMesh& second) {
    Array<Vec3> positions(first.positions.begin(), first.positions.end());
    positions.insert(positions.end(), second.positions.begin(), second.positions.end());
    Array<Triangle> triangles(first.triangles.begin(), first.triangles.end());
    const u32 shift = static_cast<u32>(first.positions.size());
    for (const auto& [a, b, c] : second.triangles) triangles.push_back({a + shift, b + shift, c + shift});
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

TEST(Topology, Nothing_HasNoPiecesAndIsNotClosed) {
    const MeshTopology facts = topology(TriangleMesh{});
    EXPECT_EQ(facts.vertices, 0u);
    EXPECT_EQ(facts.components, 0u);
    EXPECT_EQ(facts.euler, 0);
    EXPECT_FALSE(facts.closed);
    EXPECT_FALSE(facts.genus);
}

TEST(Topology, OneTriangle_IsADisc) {
    const MeshTopology facts = topology(abstract_mesh(3, {{0, 1, 2}}));
    EXPECT_EQ(facts.vertices, 3u);
    EXPECT_EQ(facts.edges, 3u);
    EXPECT_EQ(facts.triangles, 1u);
    EXPECT_EQ(facts.boundary_edges, 3u);
    EXPECT_EQ(facts.boundary_loops, 1u);
    EXPECT_EQ(facts.components, 1u);
    EXPECT_EQ(facts.euler, 1);
    EXPECT_EQ(facts.nonmanifold_vertices, 0u);
    EXPECT_FALSE(facts.closed);
    EXPECT_EQ(facts.genus, 0);
}

TEST(Topology, TwoTrianglesBackToBack_AreAClosedPillow) {
    const MeshTopology facts = topology(abstract_mesh(3, {{0, 1, 2}, {0, 2, 1}}));
    EXPECT_EQ(facts.euler, 2);
    EXPECT_TRUE(facts.closed);
    EXPECT_EQ(facts.genus, 0);
}

TEST(Topology, TheSameTriangleTwice_IsMisorientedAlongAllItsEdges) {
    const MeshTopology facts = topology(abstract_mesh(3, {{0, 1, 2}, {1, 2, 0}}));
    EXPECT_EQ(facts.misoriented_edges, 3u);
    EXPECT_FALSE(facts.closed);
    EXPECT_FALSE(facts.genus);
}

TEST(Topology, Tetrahedron_HasSixEdgesAndIsClosed) {
    const MeshTopology facts = topology(regular_tetrahedron());
    EXPECT_EQ(facts.vertices, 4u);
    EXPECT_EQ(facts.edges, 6u);
    EXPECT_EQ(facts.euler, 2);
    EXPECT_EQ(facts.boundary_edges, 0u);
    EXPECT_EQ(facts.boundary_loops, 0u);
    EXPECT_TRUE(facts.closed);
    EXPECT_EQ(facts.genus, 0);
}

TEST(Topology, TriangleTurnedOver_DisagreesWithItsThreeNeighbours) {
    const MeshTopology facts = topology(abstract_mesh(4, {{0, 2, 1}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}));
    EXPECT_EQ(facts.misoriented_edges, 3u);
    EXPECT_EQ(facts.nonmanifold_vertices, 0u);
    EXPECT_FALSE(facts.closed);
    EXPECT_FALSE(facts.genus);
}

TEST(Topology, BowTie_OneVertexInTwoFansIsNotManifold) {
    const MeshTopology facts = topology(abstract_mesh(5, {{0, 1, 2}, {0, 3, 4}}));
    EXPECT_EQ(facts.nonmanifold_vertices, 1u);
    EXPECT_EQ(facts.nonmanifold_edges, 0u);
    EXPECT_EQ(facts.components, 2u) << "pieces hang together through edges, not through a vertex";
    EXPECT_EQ(facts.boundary_loops, 1u) << "both rims pass the shared vertex";
    EXPECT_FALSE(facts.genus);
}

TEST(Topology, TwoTetrahedraSharingAVertex_AreNotClosedAlthoughEveryEdgeIs) {
    const MeshTopology facts = topology(
        abstract_mesh(7, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 6, 5}}));
    EXPECT_EQ(facts.boundary_edges, 0u);
    EXPECT_EQ(facts.misoriented_edges, 0u);
    EXPECT_EQ(facts.nonmanifold_vertices, 1u);
    EXPECT_FALSE(facts.closed);
    EXPECT_FALSE(facts.genus);
}

TEST(Topology, ThreeTrianglesOnOneEdge_MakeItAndItsEndsUnmanifold) {
    const MeshTopology facts = topology(abstract_mesh(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
    EXPECT_EQ(facts.edges, 7u);
    EXPECT_EQ(facts.nonmanifold_edges, 1u);
    EXPECT_EQ(facts.nonmanifold_vertices, 2u);
    EXPECT_EQ(facts.boundary_edges, 6u);
    EXPECT_EQ(facts.components, 1u);
    EXPECT_FALSE(facts.genus);
}

/// The strip of five triangles i, i+1, i+2 (mod 5), every other one turned over.
TEST(Topology, MoebiusStrip_CannotBeOriented) {
    const MeshTopology facts = topology(abstract_mesh(5, {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 0, 4}, {4, 0, 1}}));
    EXPECT_EQ(facts.edges, 10u);
    EXPECT_EQ(facts.boundary_edges, 5u);
    EXPECT_EQ(facts.boundary_loops, 1u);
    EXPECT_EQ(facts.euler, 0);
    EXPECT_EQ(facts.nonmanifold_vertices, 0u);
    EXPECT_EQ(facts.misoriented_edges, 1u);
    EXPECT_FALSE(facts.genus);
}

TEST(Topology, Annulus_HasTwoLoopsAndGenusZero) {
    const MeshTopology facts =
        topology(abstract_mesh(6, {{0, 1, 3}, {1, 4, 3}, {1, 2, 4}, {2, 5, 4}, {2, 0, 5}, {0, 3, 5}}));
    EXPECT_EQ(facts.boundary_edges, 6u);
    EXPECT_EQ(facts.boundary_loops, 2u);
    EXPECT_EQ(facts.euler, 0);
    EXPECT_FALSE(facts.closed);
    EXPECT_EQ(facts.genus, 0);
}

TEST(Topology, Torus_HasGenusOne) {
    const MeshTopology facts = topology(torus(3, 1, 5, 7));
    EXPECT_EQ(facts.edges, 3 * 5 * 7u);
    EXPECT_EQ(facts.euler, 0);
    EXPECT_TRUE(facts.closed);
    EXPECT_EQ(facts.genus, 1);
}

TEST(Topology, TorusWithAHole_KeepsItsGenus) {
    const MeshTopology facts = topology(without_triangles(torus(3, 1, 5, 7), {0, 1}));
    EXPECT_EQ(facts.boundary_edges, 4u);
    EXPECT_EQ(facts.boundary_loops, 1u);
    EXPECT_EQ(facts.euler, -1);
    EXPECT_FALSE(facts.closed);
    EXPECT_EQ(facts.genus, 1);
}

TEST(Topology, SphereBesideTwoTori_AddsUpPiecesAndGenus) {
    const MeshTopology facts =
        topology(side_by_side(side_by_side(geodesic_sphere(1, 3), torus(3, 1, 4, 4)), torus(3, 1, 3, 3)));
    EXPECT_EQ(facts.components, 3u);
    EXPECT_EQ(facts.euler, 2);
    EXPECT_TRUE(facts.closed);
    EXPECT_EQ(facts.genus, 2);
}

TEST(Topology, CubeWithTwoFacesOff_HasTwoLoops) {
    // Bottom (rows 0 and 1) and top (rows 2 and 3) leave a tube.
    const MeshTopology facts = topology(without_triangles(cube(), {0, 1, 2, 3}));
    EXPECT_EQ(facts.boundary_loops, 2u);
    EXPECT_EQ(facts.boundary_edges, 8u);
    EXPECT_EQ(facts.euler, 0);
    EXPECT_EQ(facts.genus, 0);
}

TEST(Topology, UnusedVertices_AreCountedAndCountForNothingElse) {
    const MeshTopology facts = topology(abstract_mesh(9, {{1, 3, 5}}));
    EXPECT_EQ(facts.vertices, 3u);
    EXPECT_EQ(facts.unused_vertices, 6u);
    EXPECT_EQ(facts.euler, 1);
    EXPECT_EQ(facts.genus, 0);
}

TEST(Topology, DegenerateTriangle_IsCountedAndMakesNoEdges) {
    const MeshTopology facts = topology(abstract_mesh(3, {{0, 1, 2}, {0, 0, 1}}));
    EXPECT_EQ(facts.triangles, 2u);
    EXPECT_EQ(facts.degenerate_triangles, 1u);
    EXPECT_EQ(facts.edges, 3u);
    EXPECT_EQ(facts.boundary_edges, 3u);
    EXPECT_EQ(facts.components, 1u);
    EXPECT_FALSE(facts.genus) << "a mesh with degenerate triangles is not a manifold";
}

TEST(Topology, EveryPairOfEqualCorners_IsDegenerate) {
    EXPECT_EQ(topology(abstract_mesh(2, {{0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 1}})).degenerate_triangles, 4u);
}

TEST(Topology, SoupWithUnmergedCorners_IsAllBoundary) {
    const TriangleMesh whole = cube();
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (const Triangle& t : whole.triangles) {
        const u32 first = static_cast<u32>(positions.size());
        for (u32 vertex : t) positions.push_back(whole.positions[vertex]);
        triangles.push_back({first, first + 1, first + 2});
    }
    TriangleMesh soup;
    soup.positions = std::move(positions);
    soup.triangles = std::move(triangles);
    const MeshTopology facts = topology(soup);
    EXPECT_EQ(facts.components, 12u);
    EXPECT_EQ(facts.boundary_edges, 36u);
    EXPECT_EQ(facts.boundary_loops, 12u);
    EXPECT_EQ(facts.genus, 0);
}

/// Renaming vertices, reordering triangles and reversing all triangles changes no property.
TEST(Topology, OfAShuffledMesh_IsTheSame) {
    const TriangleMesh mesh = without_triangles(torus(3, 1, 6, 9), {0, 1, 2, 40, 70});
    const MeshTopology expected = topology(mesh);
    Random random(7);
    for (int round = 0; round < 20; ++round) {
        std::vector<u32> name(mesh.positions.size());
        std::iota(name.begin(), name.end(), u32(0));
        for (std::size_t i = name.size(); i > 1; --i) std::swap(name[i - 1], name[random.index(i)]);
        Array<Triangle> triangles;
        for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({name[b], name[a], name[c]});
        for (std::size_t i = triangles.size(); i > 1; --i) std::swap(triangles[i - 1], triangles[random.index(i)]);
        TriangleMesh shuffled;
        shuffled.positions = mesh.positions;
        shuffled.triangles = std::move(triangles);
        const MeshTopology facts = topology(shuffled);
        EXPECT_EQ(facts.edges, expected.edges);
        EXPECT_EQ(facts.boundary_edges, expected.boundary_edges);
        EXPECT_EQ(facts.boundary_loops, expected.boundary_loops);
        EXPECT_EQ(facts.components, expected.components);
        EXPECT_EQ(facts.nonmanifold_vertices, expected.nonmanifold_vertices);
        EXPECT_EQ(facts.misoriented_edges, 0u);
        EXPECT_EQ(facts.genus, expected.genus);
    }
}

TEST(DefectsText, NamesOnlyWhatIsThere) {
    EXPECT_EQ(defects_text(topology(abstract_mesh(4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}))), "");
    EXPECT_EQ(defects_text(topology(abstract_mesh(3, {{0, 1, 2}}))), "3 boundary edges in 1 loop");
    EXPECT_EQ(defects_text(topology(abstract_mesh(4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 0, 1}}))),
              "1 triangle with a repeated vertex");
}

TriangleMesh inside_out(TriangleMesh mesh) {
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
    mesh.triangles = std::move(triangles);
    return mesh;
}

TEST(SignedVolume, IsThatOfTheBody_NegativeInsideOut) {
    const TriangleMesh block = l_block(2), reversed = inside_out(block);
    EXPECT_DOUBLE_EQ(scanmill::signed_volume(block.positions.span(), block.triangles.span()), 24);
    EXPECT_DOUBLE_EQ(scanmill::signed_volume(reversed.positions.span(), reversed.triangles.span()), -24);
    EXPECT_EQ(scanmill::signed_volume({}, {}), 0);
}

TEST(IsInsideOut, OnlyForClosedMeshesOfNegativeVolume) {
    EXPECT_FALSE(is_inside_out(cube()));
    EXPECT_TRUE(is_inside_out(inside_out(cube())));
    EXPECT_FALSE(is_inside_out(without_triangles(inside_out(cube()), {0}))) << "open";
    EXPECT_FALSE(is_inside_out({}));
    // A cavity in a larger body is right.
    EXPECT_FALSE(is_inside_out(side_by_side(geodesic_sphere(2, 3), inside_out(geodesic_sphere(1, 3)))));
    EXPECT_TRUE(is_inside_out(side_by_side(inside_out(geodesic_sphere(2, 3)), geodesic_sphere(1, 3))));
    // Two opposite triangles enclose nothing.
    TriangleMesh flat;
    flat.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0.1), Vec3(0.3, 1, 0.7)};
    flat.triangles = {Triangle{0, 1, 2}, Triangle{0, 2, 1}};
    EXPECT_FALSE(is_inside_out(flat));
}

}  // namespace
}  // namespace scanmill::test
