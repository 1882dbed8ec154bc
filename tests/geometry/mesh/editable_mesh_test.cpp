// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/editable_mesh.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "scanmill/base/random.hpp"
#include "scanmill/data/topology.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using Triangles = std::vector<Triangle>;

constexpr u32 boundary = half_edges::boundary;

/// Positions do not matter to edits: all at zero.
TriangleMesh abstract_mesh(std::size_t vertices, std::span<const Triangle> triangles) {
    TriangleMesh mesh;
    mesh.positions = Array<Vec3>(vertices, Vec3::Zero());
    mesh.triangles = Array<Triangle>(triangles.begin(), triangles.end());
    return mesh;
}
TriangleMesh abstract_mesh(std::size_t vertices, std::initializer_list<Triangle> triangles) {
    return abstract_mesh(vertices, std::span(triangles.begin(), triangles.size()));
}

TriangleMesh side_by_side(std::initializer_list<TriangleMesh> meshes) {
    Triangles triangles;
    u32 shift = 0;
    for (const TriangleMesh& mesh : meshes) {
        for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({a + shift, b + shift, c + shift});
        shift += static_cast<u32>(mesh.positions.size());
    }
    return abstract_mesh(shift, triangles);
}

/// `width` × `height` squares, each cut into two triangles, those in `holes` left out.
TriangleMesh grid(u32 width, u32 height, const std::set<u32>& holes = {}) {
    Triangles triangles;
    for (u32 y = 0; y < height; ++y)
        for (u32 x = 0; x < width; ++x) {
            if (holes.contains(y * width + x)) continue;
            const u32 a = y * (width + 1) + x, b = a + 1, c = b + width + 1, d = c - 1;
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
    return abstract_mesh((width + 1) * (height + 1), triangles);
}

Triangles triangles_of(const EditableMesh& mesh) {
    const Array<Triangle> compact = mesh.compact_triangles();
    return {compact.begin(), compact.end()};
}

Triangle from_lowest(Triangle t) {
    std::ranges::rotate(t, std::ranges::min_element(t));
    return t;
}

std::multiset<Triangle> as_set(const Triangles& triangles) {
    std::multiset<Triangle> result;
    for (const Triangle& t : triangles) result.insert(from_lowest(t));
    return result;
}

MeshTopology topology_of(std::size_t vertices, const Triangles& triangles) {
    return topology(abstract_mesh(vertices, triangles));
}

/// Every vertex has one fan, edges have at most two triangles, oriented alike, and no two triangles have the same three
/// vertices.
bool is_surface(std::size_t vertices, const Triangles& triangles) {
    const MeshTopology found = topology_of(vertices, triangles);
    std::set<Triangle> distinct;
    for (Triangle t : triangles) {
        std::ranges::sort(t);
        distinct.insert(t);
    }
    return found.nonmanifold_edges + found.nonmanifold_vertices + found.misoriented_edges +
                   found.degenerate_triangles ==
               0 &&
           distinct.size() == triangles.size();
}

/// The half-edges of `mesh` are those of a mesh built from its triangles.
void expect_as_built_anew(const EditableMesh& mesh) {
    const EditableMesh anew(abstract_mesh(mesh.vertices(), triangles_of(mesh)));
    ASSERT_EQ(mesh.triangles(), anew.triangles());
    std::vector<u32> rows;  // row in `mesh`, by row in `anew`
    for (u32 row = 0; row < mesh.rows(); ++row)
        if (!mesh.is_empty(row)) rows.push_back(row);
    ASSERT_EQ(rows.size(), anew.rows());
    const auto in_mesh = [&](u32 h) { return h == boundary ? boundary : 3 * rows[h / 3] + h % 3; };
    for (u32 h = 0; h < 3 * anew.rows(); ++h) {
        ASSERT_EQ(mesh.start(in_mesh(h)), anew.start(h));
        ASSERT_EQ(mesh.opposite(in_mesh(h)), in_mesh(anew.opposite(h))) << "of half-edge " << in_mesh(h);
    }
    for (u32 vertex = 0; vertex < mesh.vertices(); ++vertex) {
        ASSERT_EQ(mesh.is_used(vertex), anew.is_used(vertex)) << vertex;
        if (!mesh.is_used(vertex)) continue;
        ASSERT_FALSE(mesh.is_empty(mesh.first(vertex) / 3)) << vertex;
        ASSERT_EQ(mesh.start(mesh.first(vertex)), vertex);
        ASSERT_EQ(mesh.is_boundary_vertex(vertex), anew.is_boundary_vertex(vertex)) << vertex;
        if (anew.is_boundary_vertex(vertex)) {
            ASSERT_EQ(mesh.first(vertex), in_mesh(anew.first(vertex))) << vertex;
        }
        ASSERT_EQ(mesh.valence(vertex), anew.valence(vertex)) << vertex;
    }
}

TEST(EditableMesh, OfASquare_HasItsEdgesAndFans) {
    // 3 - 2
    // | / |
    // 0 - 1
    const EditableMesh mesh(grid(1, 1));  // (0, 1, 3), (0, 3, 2) by rows of vertices
    EXPECT_EQ(mesh.triangle(0), (Triangle{0, 1, 3}));
    EXPECT_EQ(mesh.triangle(1), (Triangle{0, 3, 2}));
    EXPECT_EQ(mesh.opposite(2), 3u);  // 3 → 0 and 0 → 3
    EXPECT_EQ(mesh.opposite(3), 2u);
    EXPECT_TRUE(mesh.is_boundary(0));
    EXPECT_EQ(mesh.apex(3), 2u);
    EXPECT_EQ(mesh.first(0), 0u) << "0 → 1 is on the boundary";
    EXPECT_EQ(mesh.next_around(0), 3u);
    EXPECT_EQ(mesh.next_around(3), boundary);
    EXPECT_EQ(mesh.valence(0), 3u);
    EXPECT_EQ(mesh.valence(1), 2u);
    EXPECT_EQ(mesh.start(5), 2u);
    EXPECT_EQ(mesh.end(5), 0u);
    EXPECT_TRUE(mesh.has_edge(0, 2));
    EXPECT_TRUE(mesh.has_edge(2, 0));
    EXPECT_FALSE(mesh.has_edge(1, 2));
    std::vector<u32> ring;
    mesh.ring(0, ring);
    EXPECT_THAT(ring, ElementsAre(1, 3, 2));
}

TEST(EditableMesh, FlipOfASquaresDiagonal_KeepsTheHalfEdge) {
    EditableMesh mesh(grid(1, 1));
    ASSERT_TRUE(mesh.can_flip(3));
    EXPECT_EQ(mesh.flip(3), 0u) << "the row of the neighbour";
    EXPECT_EQ(mesh.start(3), 1u) << "the apex of the neighbour";
    EXPECT_EQ(mesh.end(3), 2u);
    EXPECT_THAT(as_set(triangles_of(mesh)), ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
    EXPECT_EQ(mesh.start(mesh.first(0)), 0u);
    EXPECT_EQ(mesh.end(mesh.first(0)), 1u);
    EXPECT_FALSE(mesh.has_edge(0, 3));
    expect_as_built_anew(mesh);
}

TEST(EditableMesh, EdgesOfATetrahedron_DoNotFlip_TheOtherDiagonalExists) {
    const EditableMesh mesh(regular_tetrahedron());
    for (u32 h = 0; h < 12; ++h) EXPECT_FALSE(mesh.can_flip(h)) << h;
}

TEST(EditableMesh, EdgesOnTheBoundary_DoNotFlip) {
    const EditableMesh mesh(grid(1, 1));
    for (const u32 h : {0u, 1u, 4u, 5u}) EXPECT_FALSE(mesh.can_flip(h)) << h;
}

TEST(EditableMesh, TwoTrianglesBackToBack_DoNotFlip) {
    const EditableMesh mesh(abstract_mesh(3, {{0, 1, 2}, {0, 2, 1}}));
    for (u32 h = 0; h < 6; ++h) EXPECT_FALSE(mesh.can_flip(h)) << h;
}

TEST(EditableMesh, RemovalOfTheCentreOfAHexagon_UsesItsRowsInOrder) {
    Triangles triangles{{7, 8, 9}};
    for (u32 i = 0; i < 6; ++i) triangles.push_back({i, (i + 1) % 6, 6});
    triangles.push_back({9, 8, 10});
    EditableMesh mesh(abstract_mesh(11, triangles));
    std::vector<u32> ring, rows;
    mesh.ring(6, ring);
    EXPECT_THAT(ring, ElementsAre(0, 1, 2, 3, 4, 5));
    const std::vector<EditableMesh::RingTriangle> fan{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
    ASSERT_TRUE(mesh.can_remove(6, fan));
    mesh.remove(6, fan, rows);
    EXPECT_THAT(rows, ElementsAre(1, 2, 3, 4));
    EXPECT_EQ(mesh.triangles(), 6u);
    EXPECT_EQ(mesh.rows(), 8u);
    EXPECT_TRUE(mesh.is_empty(5));
    EXPECT_TRUE(mesh.is_empty(6));
    EXPECT_FALSE(mesh.is_used(6));
    EXPECT_THAT(triangles_of(mesh), ElementsAre(Triangle{7, 8, 9}, Triangle{0, 1, 2}, Triangle{0, 2, 3},
                                                Triangle{0, 3, 4}, Triangle{0, 4, 5}, Triangle{9, 8, 10}));
    expect_as_built_anew(mesh);
}

TEST(EditableMesh, RemovalOfABoundaryVertex_ClosesItsRingByABoundaryEdge) {
    // 3 - 4 - 5
    // | / | / |
    // 0 - 1 - 2
    EditableMesh mesh(grid(2, 1));
    std::vector<u32> ring, rows;
    mesh.ring(1, ring);
    EXPECT_THAT(ring, ElementsAre(2, 5, 4, 0));
    const std::vector<EditableMesh::RingTriangle> two{{0, 1, 2}, {0, 2, 3}};
    ASSERT_TRUE(mesh.can_remove(1, two));
    mesh.remove(1, two, rows);
    EXPECT_THAT(as_set(triangles_of(mesh)), ElementsAre(Triangle{0, 2, 4}, Triangle{0, 4, 3}, Triangle{2, 5, 4}));
    EXPECT_EQ(mesh.start(mesh.first(0)), 0u);
    EXPECT_EQ(mesh.end(mesh.first(0)), 2u);
    EXPECT_TRUE(mesh.is_boundary(mesh.first(0)));
    expect_as_built_anew(mesh);
}

TEST(EditableMesh, CornerOfATetrahedron_IsNotRemoved_TwoTrianglesWouldLieBackToBack) {
    const EditableMesh mesh(regular_tetrahedron());
    const std::vector<EditableMesh::RingTriangle> one{{0, 1, 2}};
    for (u32 vertex = 0; vertex < 4; ++vertex) EXPECT_FALSE(mesh.can_remove(vertex, one)) << vertex;
}

/// Random edits, each compared with the same edit of a list of triangles.
class RandomEdits {
public:
    RandomEdits(const TriangleMesh& mesh, std::uint64_t seed) : mesh_(mesh), random_(seed) {}

    std::size_t flips = 0, refused_flips = 0, removals = 0, boundary_removals = 0, refused_removals = 0;

    void step() {
        before_ = triangles_of(mesh_);
        found_ = topology_of(mesh_.vertices(), before_);
        if (random_.index(3) == 0)
            flip();
        else
            remove();
        expect_as_built_anew(mesh_);
    }

private:
    u32 any_half_edge() {
        for (;;)
            if (const u32 h = static_cast<u32>(random_.index(3 * mesh_.rows())); !mesh_.is_empty(h / 3)) return h;
    }
    u32 any_vertex() {
        for (;;)
            if (const u32 vertex = static_cast<u32>(random_.index(mesh_.vertices())); mesh_.is_used(vertex))
                return vertex;
    }
    /// The list of triangles before the edit without those that have all of `vertices`, and with `added`.
    Triangles replaced(const std::vector<std::vector<u32>>& without, const Triangles& added) const {
        Triangles result;
        std::ranges::copy_if(before_, std::back_inserter(result), [&](const Triangle& t) {
            return std::ranges::none_of(without, [&](const std::vector<u32>& vertices) {
                return std::ranges::all_of(vertices, [&](u32 v) { return std::ranges::find(t, v) != t.end(); });
            });
        });
        result.insert(result.end(), added.begin(), added.end());
        return result;
    }
    void expect_changed(long vertices, long edges, long triangles, long boundary_edges) {
        const MeshTopology now = topology_of(mesh_.vertices(), triangles_of(mesh_));
        EXPECT_EQ(static_cast<long>(now.vertices), static_cast<long>(found_.vertices) + vertices);
        EXPECT_EQ(static_cast<long>(now.edges), static_cast<long>(found_.edges) + edges);
        EXPECT_EQ(static_cast<long>(now.triangles), static_cast<long>(found_.triangles) + triangles);
        EXPECT_EQ(static_cast<long>(now.boundary_edges), static_cast<long>(found_.boundary_edges) + boundary_edges);
        EXPECT_EQ(now.euler, found_.euler);
        EXPECT_EQ(now.boundary_loops, found_.boundary_loops);
        EXPECT_EQ(now.components, found_.components);
    }

    void flip() {
        const u32 h = any_half_edge(), a = mesh_.start(h), b = mesh_.end(h), c = mesh_.apex(h);
        if (mesh_.is_boundary(h)) {
            EXPECT_FALSE(mesh_.can_flip(h));
            return;
        }
        const u32 other = mesh_.opposite(h), d = mesh_.apex(other);
        const Triangles expected = replaced({{a, b}}, {{c, a, d}, {d, b, c}});
        ASSERT_EQ(mesh_.can_flip(h), is_surface(mesh_.vertices(), expected));
        if (!mesh_.can_flip(h)) {
            ++refused_flips;
            return;
        }
        ++flips;
        EXPECT_EQ(mesh_.flip(h), other / 3);
        EXPECT_EQ(mesh_.start(h), d);
        EXPECT_EQ(mesh_.end(h), c);
        EXPECT_EQ(mesh_.apex(h), a);
        EXPECT_EQ(as_set(triangles_of(mesh_)), as_set(expected));
        EXPECT_FALSE(mesh_.has_edge(a, b));
        EXPECT_TRUE(mesh_.has_edge(c, d));
        expect_changed(0, 0, 0, 0);
    }

    /// Triangulates the polygon with the corners begin … end.
    void triangulate(u32 begin, u32 end, std::vector<EditableMesh::RingTriangle>& result) {
        if (end - begin < 2) return;
        const u32 apex = begin + 1 + static_cast<u32>(random_.index(end - begin - 1));
        result.push_back({begin, apex, end});
        std::ranges::rotate(result.back(), result.back().begin() + static_cast<long>(random_.index(3)));
        triangulate(begin, apex, result);
        triangulate(apex, end, result);
    }

    void remove() {
        const u32 vertex = any_vertex();
        const bool is_open = mesh_.is_boundary_vertex(vertex);
        std::vector<u32> ring, rows{17};
        mesh_.ring(vertex, ring);
        std::vector<EditableMesh::RingTriangle> triangulation;
        triangulate(0, static_cast<u32>(ring.size()) - 1, triangulation);
        if (triangulation.empty()) {  // the ring is an edge
            EXPECT_FALSE(mesh_.can_remove(vertex, triangulation));
            return;
        }
        Triangles added;
        for (const auto& [i, j, k] : triangulation) added.push_back({ring[i], ring[j], ring[k]});
        const Triangles expected = replaced({{vertex}}, added);
        // A boundary of three edges must not disappear: its other two vertices would be joined twice.
        const bool keeps_loops = topology_of(mesh_.vertices(), expected).boundary_loops == found_.boundary_loops;
        ASSERT_EQ(mesh_.can_remove(vertex, triangulation), is_surface(mesh_.vertices(), expected) && keeps_loops);
        if (!mesh_.can_remove(vertex, triangulation)) {
            ++refused_removals;
            return;
        }
        ++removals;
        boundary_removals += is_open;
        mesh_.remove(vertex, triangulation, rows);
        EXPECT_EQ(as_set(triangles_of(mesh_)), as_set(expected));
        ASSERT_EQ(rows.size(), 1 + added.size());
        EXPECT_EQ(rows[0], 17u) << "rows are appended";
        for (std::size_t i = 0; i < added.size(); ++i) EXPECT_EQ(mesh_.triangle(rows[i + 1]), added[i]);
        EXPECT_FALSE(mesh_.is_used(vertex));
        if (is_open)
            expect_changed(-1, -2, -1, -1);
        else
            expect_changed(-1, -3, -2, 0);
    }

    EditableMesh mesh_;
    Random random_;
    Triangles before_;
    MeshTopology found_;
};

TEST(EditableMesh, AfterEveryRandomEdit_IsAsBuiltAnew_AndTheTopologyFollowsTheEdit) {
    const std::vector<TriangleMesh> meshes{
        cube(),
        geodesic_sphere(1, 3),
        torus(2, 1, 7, 5),
        grid(1, 1),
        grid(7, 5),
        grid(6, 6, {7, 8, 14, 27, 28}),  // two holes
        without_triangles(torus(2, 1, 6, 6), {3, 20, 21}),
        side_by_side({geodesic_sphere(1, 2), grid(3, 2), regular_tetrahedron(), grid(4, 4, {5}), cube()})};
    std::size_t flips = 0, refused_flips = 0, removals = 0, boundary_removals = 0, refused_removals = 0;
    for (std::size_t i = 0; i < meshes.size(); ++i)
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            RandomEdits edits(meshes[i], seed);
            for (int step = 0; step < 400; ++step) {
                edits.step();
                ASSERT_FALSE(HasFailure()) << "mesh " << i << ", seed " << seed << ", step " << step;
            }
            flips += edits.flips;
            refused_flips += edits.refused_flips;
            removals += edits.removals;
            boundary_removals += edits.boundary_removals;
            refused_removals += edits.refused_removals;
        }
    // Every kind of edit and refusal occurred often.
    EXPECT_GT(flips, 500u);
    EXPECT_GT(refused_flips, 100u);
    EXPECT_GT(boundary_removals, 100u);
    EXPECT_GT(removals - boundary_removals, 300u);
    EXPECT_GT(refused_removals, 300u);
}

TEST(EditableMesh, FlipBackAndForth_RestoresTheTriangles) {
    EditableMesh mesh(torus(2, 1, 7, 5));
    const std::multiset<Triangle> before = as_set(triangles_of(mesh));
    std::size_t flipped = 0;
    for (u32 h = 0; h < 3 * mesh.rows(); ++h) {
        if (!mesh.can_flip(h)) continue;
        mesh.flip(h);
        ASSERT_TRUE(mesh.can_flip(h)) << "the old edge is free again";
        mesh.flip(h);
        ASSERT_EQ(as_set(triangles_of(mesh)), before) << h;
        ++flipped;
    }
    EXPECT_GT(flipped, 0u);
    expect_as_built_anew(mesh);
}

TEST(EditableMesh, OfNothing_IsEmpty) {
    const EditableMesh mesh{TriangleMesh{}};
    EXPECT_EQ(mesh.vertices(), 0u);
    EXPECT_EQ(mesh.triangles(), 0u);
    EXPECT_TRUE(mesh.compact_triangles().empty());
}

Error refusal(const TriangleMesh& mesh) {
    return error_of([&] { EditableMesh{mesh}; });
}

TEST(EditableMeshRefuses, AVertexWithSeveralFans) {
    // Two triangles that touch in vertex 2, and two tetrahedra that touch in vertex 5.
    const TriangleMesh bow = abstract_mesh(5, {{0, 1, 2}, {2, 3, 4}});
    EXPECT_THAT(refusal(bow).sentence(),
                AllOf(HasSubstr("vertex 2 (0, 0, 0) form several fans"), HasSubstr("such vertices: 1")));
    EXPECT_THAT(refusal(bow).hint(), HasSubstr("own vertex"));
    const TriangleMesh tetrahedra =
        abstract_mesh(8, {{1, 2, 3}, {1, 3, 5}, {1, 5, 2}, {2, 5, 3}, {4, 6, 7}, {4, 7, 5}, {4, 5, 6}, {6, 5, 7}});
    EXPECT_THAT(refusal(tetrahedra).sentence(), HasSubstr("vertex 5"));
    // An open and a closed fan at vertex 5.
    const TriangleMesh flag = abstract_mesh(8, {{6, 7, 5}, {1, 2, 3}, {1, 3, 5}, {1, 5, 2}, {2, 5, 3}});
    EXPECT_THAT(refusal(flag).sentence(), HasSubstr("vertex 5"));
}

TEST(EditableMeshRefuses, AnEdgeInThreeTriangles) {
    const Error error = refusal(abstract_mesh(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
    EXPECT_THAT(error.sentence(), HasSubstr("in 3 triangles, among them 0, 1 and 2"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(EditableMeshRefuses, NeighboursOrientedDifferently) {
    const Error error = refusal(abstract_mesh(4, {{0, 1, 2}, {0, 1, 3}}));
    EXPECT_THAT(error.sentence(), HasSubstr("in the same direction"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(EditableMeshRefuses, ARepeatedVertex) {
    const Error error = refusal(abstract_mesh(4, {{0, 1, 2}, {1, 3, 1}, {2, 2, 3}}));
    EXPECT_THAT(error.sentence(),
                AllOf(HasSubstr("triangle 1 has the vertices 1, 3 and 1"), HasSubstr("such triangles: 2")));
    EXPECT_FALSE(error.hint().empty());
}

TEST(EditableMeshRefuses, AnIndexOutOfRange) {
    EXPECT_THAT(refusal(abstract_mesh(3, {{0, 1, 3}})).sentence(), HasSubstr("3"));
}

}  // namespace
}  // namespace scanmill::test
