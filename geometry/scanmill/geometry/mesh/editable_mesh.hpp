// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A triangle mesh that is edited: edges are flipped, vertices removed.
///
/// Half-edges are numbered as in half_edges.hpp: half-edge 3 t + i goes from corner i of triangle t to the next corner.
/// No edit makes more triangles than it removes. The new triangles take the rows of the removed ones, and rows left
/// over stay empty. Triangles that no edit touches keep their rows, so the mesh is written in input order.
///
/// The class has no positions: edits change the topology only, and callers decide the geometry.

#include <optional>
#include <span>
#include <vector>

#include "scanmill/data/half_edges.hpp"

namespace scanmill {

class EditableMesh {
public:
    static constexpr u32 none = ~u32(0);

    /// Pre: every vertex has at most one fan of triangles, open or closed; no triangle has a repeated vertex. Throws
    /// Error if a precondition is violated, naming the first such vertex or triangle. Throws Error where
    /// half_edges::opposites() does. Cost: linear, 24 bytes per triangle and 4 per vertex, and 24 bytes per triangle
    /// during construction.
    explicit EditableMesh(const TriangleMesh& mesh);
    /// The same with `opposite` from half_edges::opposites(mesh).
    EditableMesh(const TriangleMesh& mesh, Array<u32> opposite);

    std::size_t vertices() const { return first_.size(); }
    /// Number of rows, including empty ones.
    std::size_t rows() const { return corners_.size() / 3; }
    std::size_t triangles() const { return triangles_; }
    bool is_empty(u32 row) const { return corners_[3 * row] == none; }
    Triangle triangle(u32 row) const { return {corners_[3 * row], corners_[3 * row + 1], corners_[3 * row + 2]}; }

    static u32 after(u32 half_edge) { return half_edges::after(half_edge); }
    static u32 before(u32 half_edge) { return half_edges::before(half_edge); }
    u32 start(u32 half_edge) const { return corners_[half_edge]; }
    u32 end(u32 half_edge) const { return corners_[after(half_edge)]; }
    /// The vertex of the half-edge's triangle that is not an end of the half-edge.
    u32 apex(u32 half_edge) const { return corners_[before(half_edge)]; }
    /// half_edges::boundary for a half-edge on the boundary.
    u32 opposite(u32 half_edge) const { return opposite_[half_edge]; }
    bool is_boundary(u32 half_edge) const { return opposite_[half_edge] == half_edges::boundary; }

    /// A half-edge that starts at the vertex. At a boundary vertex it is the first of its fan, counter-clockwise seen
    /// from outside. `none` for a vertex without triangles.
    u32 first(u32 vertex) const { return first_[vertex]; }
    bool is_used(u32 vertex) const { return first_[vertex] != none; }
    bool is_boundary_vertex(u32 vertex) const { return is_boundary(first_[vertex]); }
    /// The next half-edge from the same vertex, counter-clockwise, or half_edges::boundary after the last one.
    u32 next_around(u32 half_edge) const { return opposite_[before(half_edge)]; }
    /// Calls action(half-edge) for every half-edge from the vertex, counter-clockwise. Pre: is_used(vertex).
    template <class Action>
    void for_each_around(u32 vertex, Action&& action) const {
        const u32 begin = first_[vertex];
        u32 half_edge = begin;
        do {
            action(half_edge);
            half_edge = next_around(half_edge);
        } while (half_edge != begin && half_edge != half_edges::boundary);
    }
    /// Number of edges at the vertex.
    u32 valence(u32 vertex) const;
    bool has_edge(u32 a, u32 b) const;

    /// Whether the two triangles at the edge may be replaced by the two at the other diagonal. The edge must be
    /// interior, and the other diagonal must not be an edge yet. Every vertex must keep at least three edges (two on
    /// the boundary).
    bool can_flip(u32 half_edge) const;
    /// Replaces triangle (a, b, c) of half-edge (a, b) by (c, a, d), and the neighbour (b, a, d) by (d, b, c). The
    /// half-edge keeps its number and becomes (d, c). Returns the row of the neighbour. Pre: can_flip().
    u32 flip(u32 half_edge);

    /// The vertices around a vertex, counter-clockwise. The ring of an open fan goes from one end of the fan to the
    /// other.
    /// Pre: is_used(vertex).
    void ring(u32 vertex, std::vector<u32>& vertices) const;
    /// A triangle of a hole; its corners are positions in the ring.
    using RingTriangle = std::array<u32, 3>;
    /// The link condition for remove(): every edge of the triangulation between vertices that are not neighbours in the
    /// ring is new. At a corner of a tetrahedron, the reverse of the new triangle must not exist either. Cost: linear
    /// in the valences of the ring. Pre: the triangles are as for remove().
    bool can_remove(u32 vertex, std::span<const RingTriangle> triangulation) const;
    /// Removes the vertex and triangulates the hole. In an open ring, a new boundary edge joins the last vertex to the
    /// first. Appends the rows of the new triangles in the order of `triangulation`. Pre: can_remove(); the triangles
    /// are counter-clockwise and triangulate the polygon of the ring.
    void remove(u32 vertex, std::span<const RingTriangle> triangulation, std::vector<u32>& new_rows);

    /// The triangles of all rows that are not empty, in the order of rows.
    Array<Triangle> compact_triangles() const;

private:
    void set(u32 row, u32 a, u32 b, u32 c);
    /// Makes two half-edges opposite; `one` or `other` may be half_edges::boundary.
    void link(u32 one, u32 other);

    Array<u32> corners_;  ///< start vertex of every half-edge
    Array<u32> opposite_;  ///< opposite of every half-edge
    Array<u32> first_;  ///< first() of every vertex
    std::size_t triangles_ = 0;
    /// Scratch memory of remove(): opposites of the ring's half-edges, rows of the removed triangles, and new
    /// half-edges by the ring positions of their ends.
    std::vector<u32> outside_, rows_, by_ends_;
};

}  // namespace scanmill
