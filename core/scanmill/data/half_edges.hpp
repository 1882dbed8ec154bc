// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The half-edges of a mesh's triangles, and which of them are opposite.
///
/// Half-edge 3 t + i goes from corner i of triangle t to the next corner; corner i has the same number. Triangles with
/// a repeated vertex have no half-edges.

#include <compare>
#include <span>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill::half_edges {

inline u32 after(u32 half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }
inline u32 before(u32 half_edge) { return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1; }
inline u32 start(const TriangleMesh& mesh, u32 half_edge) { return mesh.triangles[half_edge / 3][half_edge % 3]; }
inline u32 end(const TriangleMesh& mesh, u32 half_edge) { return start(mesh, after(half_edge)); }

inline bool has_repeated_vertex(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

struct VertexHalfEdge {
    u32 other;  ///< the edge's larger vertex
    u32 number;
    auto operator<=>(const VertexHalfEdge&) const = default;
};

/// Half-edges grouped by the smaller vertex of their edges.
struct ByVertex {
    std::vector<u32> begin;  ///< the first half-edge of every vertex's group; at the end, the number of half-edges
    std::vector<VertexHalfEdge> half_edges;  ///< every group is sorted by edge, then by number
};

/// Cost: linear if no vertex has many edges, 24 bytes per triangle and 8 per vertex.
ByVertex by_smaller_vertex(const TriangleMesh& mesh);

/// Calls action(smaller vertex, half-edges of one edge) for every edge, by smaller and then by larger vertex.
template <class Action>
void for_each_edge(const ByVertex& by_vertex, Action&& action) {
    const std::span<const VertexHalfEdge> all = by_vertex.half_edges;
    for (u32 vertex = 0; vertex + 1 < by_vertex.begin.size(); ++vertex)
        for (u32 first = by_vertex.begin[vertex], last; first < by_vertex.begin[vertex + 1]; first = last) {
            for (last = first + 1; last < by_vertex.begin[vertex + 1] && all[last].other == all[first].other;) ++last;
            action(vertex, all.subspan(first, last - first));
        }
}

/// Values instead of an opposite half-edge: `boundary` if the edge is on the boundary, `no_half_edge` if the triangle
/// has a repeated vertex.
inline constexpr u32 boundary = ~u32(0), no_half_edge = ~u32(0) - 1;

/// The opposite of every half-edge, or `boundary`, or `no_half_edge`.
///
/// Throws Error for an index out of range and for more half-edges than 32 bits can number. Throws Error for an edge in
/// three or more triangles and for an edge with two half-edges of the same direction. The message contains the first
/// such edge (lowest vertices), its position and the number of such edges. Cost: that of by_smaller_vertex(), and 12
/// bytes per triangle.
Array<u32> opposites(const TriangleMesh& mesh);

}  // namespace scanmill::half_edges
