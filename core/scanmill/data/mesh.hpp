// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `mesh`: an indexed triangle mesh. It need not be a manifold; topology() checks whether it is.

#include <array>

#include "scanmill/data/points.hpp"

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
constexpr auto fields(const TriangleMesh*) {
    return std::tuple{field("frame", &TriangleMesh::frame),
                      field("positions", &TriangleMesh::positions).means(Meaning::position),
                      field("triangles", &TriangleMesh::triangles),
                      field("vertex-columns", &TriangleMesh::vertex_columns),
                      field("face-columns", &TriangleMesh::face_columns),
                      field("edges", &TriangleMesh::edges),
                      field("edge-columns", &TriangleMesh::edge_columns),
                      field("sharp-edges", &TriangleMesh::sharp_edges)};
}

/// Throws Error if an index is out of range or a column has a wrong number of rows.
void require_consistent(const TriangleMesh& mesh);

/// The mesh without the vertices that are in no triangle, and without edges and sharp edges at such vertices. All
/// columns remain; vertices keep their order.
TriangleMesh without_unused_vertices(const TriangleMesh& mesh);

/// The mesh's vertices with their columns and frame, in order; shares their memory.
PointCloud points_of(const TriangleMesh& mesh);

/// The mesh without vertices that have a NaN or infinite coordinate, and without triangles, edges and sharp edges at
/// such vertices. All columns and the order remain, and so do unused vertices.
Cleaned<TriangleMesh> without_invalid_points(const TriangleMesh& mesh);

/// The box of the finite vertices that are in a triangle; empty without triangles.
BoundingBox surface_box(const TriangleMesh& mesh);

}  // namespace scanmill
