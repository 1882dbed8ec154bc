// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The boundary of a set of cells, whether it is a 2-manifold, its cavities, and the vertices in no cell.

#include <span>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/tets.hpp"

namespace scanmill {

/// The vertices in no cell, ascending. The weights of other points hide these vertices. Cost: linear.
Array<u32> hidden_vertices(const TetMesh& tets);

/// The facets between cells labelled 1 and other cells or the outside, oriented outwards, as vertices of `tets`; sorted
/// by cell, then by corner.
Array<Triangle> boundary_triangles(const TetMesh& tets, std::span<const u8> labels, unsigned threads);
/// A mesh of the given triangles with only the vertices that they use, in vertex order, with all columns.
TriangleMesh boundary_mesh(const TetMesh& tets, Array<Triangle> triangles);

/// Labels enclosed cells 1. An enclosed cell is not labelled 1, and no path through cells that are not labelled 1
/// connects it to the outside of the hull. Cost: linear.
void fill_cavities(const TetMesh& tets, std::span<u8> labels);

/// A triangle seen from one of its corners: the edge opposite to this corner, in the triangle's direction.
struct LinkEdge {
    u32 from, to;
};

/// For each vertex, the edges opposite to it in its triangles, in unspecified order.
/// Cost: linear, 24 bytes per triangle.
class BoundaryLinks {
public:
    BoundaryLinks(std::span<const Triangle> triangles, std::size_t vertices, unsigned threads);

    std::size_t vertices() const { return ends_.size(); }
    std::span<LinkEdge> of(std::size_t vertex) {
        const u32 first = vertex == 0 ? 0 : ends_[vertex - 1];
        return {edges_.data() + first, ends_[vertex] - first};
    }

private:
    Array<u32> ends_;
    Array<LinkEdge> edges_;
};

struct BoundaryDefects {
    /// Vertices whose triangles are not exactly one closed fan, ascending.
    Array<u32> vertices;
    /// Edges with more than two triangles.
    std::size_t edges = 0;
};

/// Finds the places where the boundary is not a 2-manifold. Pre: the triangles bound a set of cells, so every directed
/// edge occurs as often as its reverse. Cost: linear, 24 bytes per triangle for the links.
BoundaryDefects boundary_defects(std::span<const Triangle> triangles, std::size_t vertices, unsigned threads);
/// The same with given links; sorts the longer links by `from`.
BoundaryDefects boundary_defects(BoundaryLinks& links, unsigned threads);

/// Unites the vertices of every triangle; returns the number of sets that contain a triangle.
std::size_t join_vertices(std::span<const Triangle> triangles, DisjointSets& vertices);

}  // namespace scanmill
