// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The sides of a mesh's triangles, and which of them meet at an edge.
///
/// A side has the number 3 t + i: the one of triangle t from its corner i to the next. So has that corner. Triangles
/// that name a vertex twice have no sides that count.

#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill::half_edges {

inline u32 after(u32 half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }
inline u32 before(u32 half_edge) { return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1; }
inline u32 start(const TriangleMesh& mesh, u32 half_edge) { return mesh.triangles[half_edge / 3][half_edge % 3]; }
inline u32 end(const TriangleMesh& mesh, u32 half_edge) { return start(mesh, after(half_edge)); }

inline bool names_a_vertex_twice(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

struct VertexHalfEdge {
    u32 other;  ///< the edge's larger vertex
    u32 number;
};

/// The sides of proper triangles, by the smaller vertex of their edges.
struct ByVertex {
    std::vector<u32> begin;   ///< where a vertex's sides begin, and one more
    std::vector<VertexHalfEdge> half_edges;  ///< of one vertex: by edge, then by number
};

/// Cost: linear where no vertex has many edges, 24 bytes per triangle and 8 per vertex.
ByVertex by_smaller_vertex(const TriangleMesh& mesh);

/// In place of an opposite: nothing on the other side; the side of a triangle that names a vertex twice.
inline constexpr u32 boundary = ~u32(0), no_half_edge = ~u32(0) - 1;

/// Of every side the one that passes its edge in the other direction, or `boundary`, or `no_half_edge`.
///
/// Throws Error for an index out of range, for more triangles than 32 bits number sides of, for an edge in three or
/// more triangles and for an edge that two triangles pass in the same direction, naming the first such edge (lowest
/// vertices) with its place, and how many there are. Cost: as above and 12 bytes per triangle.
Array<u32> opposites(const TriangleMesh& mesh);

}  // namespace scanmill::half_edges
