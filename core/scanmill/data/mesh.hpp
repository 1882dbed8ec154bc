// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `mesh`: an indexed triangle mesh. Nothing is promised about manifoldness: see geometry/topology.hpp for the facts.

#include <array>

#include "scanmill/data/bounds.hpp"
#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Three vertex indices, counter-clockwise seen from outside.
using Triangle = std::array<u32, 3>;
/// Two vertex indices, the smaller first.
using Edge = std::array<u32, 2>;

inline Edge make_edge(u32 a, u32 b) { return a < b ? Edge{a, b} : Edge{b, a}; }

struct TriangleMesh {
    Frame frame;
    /// #vertices, relative to frame.origin.
    Buffer<Vec3> positions;
    /// #faces; every index < #vertices.
    Buffer<Triangle> triangles;
    ColumnTable vertex_columns;
    ColumnTable face_columns;
    /// The edges that edge_columns describe, one row each; empty when there are no edge columns.
    Buffer<Edge> edges;
    ColumnTable edge_columns;
    /// Sorted, without repeats.
    Buffer<Edge> sharp_edges;
};

/// Throws Error when an index is out of range or a column has another number of rows than its element.
void require_consistent(const TriangleMesh& mesh);

/// The triangles over only those vertices that they use, in vertex order, columns carried; the mesh's edges and sharp
/// edges keep those between used vertices.
TriangleMesh without_unused_vertices(const TriangleMesh& mesh);

/// Of the vertices that triangles use: one that no triangle names is no part of the surface, wherever it lies.
/// Non-finite vertices are passed over; empty without triangles.
BoundingBox surface_box(const TriangleMesh& mesh);

}  // namespace scanmill
