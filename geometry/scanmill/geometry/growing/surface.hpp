// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The growing surface: its triangles, the triangles around every vertex, and the state and normal of every point.

#include <array>
#include <utility>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/geometry/growing/distinct_points.hpp"
#include "scanmill/geometry/growing/edge_sides.hpp"
#include "scanmill/geometry/growing/fixed_edges.hpp"
#include "scanmill/geometry/growing/point_normals.hpp"

namespace scanmill::growing {

inline constexpr u32 invalid_index = ~u32(0);

/// The triangles around every vertex, in one cache line per vertex.
///
/// Triangle (v, a, b), counter-clockwise, is stored at v as the edge a → b of v's link. The half-edge v → x belongs to
/// a triangle if a link edge of v begins with x. The half-edge x → v belongs to a triangle if a link edge of v ends
/// with x. So each end of an edge refers to both triangles of the edge.
class Fans {
public:
    struct LinkEdge {
        u32 first, last;
    };

    explicit Fans(std::size_t vertices) : blocks_(vertices) {
        for (Block& block : blocks_) block = {{}, 0, invalid_index};
    }

    /// Calls action(LinkEdge) for every triangle at the vertex, until the action returns true. Returns whether it did.
    template <class Action>
    bool any(u32 vertex, Action&& action) const {
        for (u32 index = vertex; index != invalid_index; index = blocks_[index].next)
            for (u32 i = 0; i < blocks_[index].count; ++i)
                if (action(blocks_[index].link[i])) return true;
        return false;
    }
    bool empty(u32 vertex) const { return blocks_[vertex].count == 0; }

    /// The third corner of the triangle of half-edge from → to; invalid_index if there is none.
    u32 left_of(u32 from, u32 to) const {
        u32 third = invalid_index;
        any(from, [&](const LinkEdge& edge) { return edge.first == to && (third = edge.last, true); });
        return third;
    }
    /// The third corner of the triangle of the opposite half-edge to → from, looked up at `from`.
    u32 right_of(u32 from, u32 to) const {
        u32 third = invalid_index;
        any(from, [&](const LinkEdge& edge) { return edge.last == to && (third = edge.first, true); });
        return third;
    }
    /// Whether the triangles form one closed fan. Pre: not empty.
    bool closed(u32 vertex) const {
        const u32 begin = blocks_[vertex].link[0].first;
        u32 steps = 0, end = begin;
        do {
            end = left_of(vertex, end);
            ++steps;
        } while (end != begin && end != invalid_index);
        return end == begin && steps == count(vertex);
    }
    u32 count(u32 vertex) const {
        u32 sum = 0;
        for (u32 index = vertex; index != invalid_index; index = blocks_[index].next) sum += blocks_[index].count;
        return sum;
    }
    void add(const Triangle& triangle) {
        for (std::size_t i = 0; i < 3; ++i) add(triangle[i], {triangle[(i + 1) % 3], triangle[(i + 2) % 3]});
    }
    /// Pre: the triangle was added.
    void remove(const Triangle& triangle) {
        for (std::size_t i = 0; i < 3; ++i) remove(triangle[i], {triangle[(i + 1) % 3], triangle[(i + 2) % 3]});
    }

    /// Reverses all triangles at the vertex. Callers must reverse all vertices of a component; in between, the two fans
    /// of an edge contradict each other.
    void reverse(u32 vertex) {
        for (u32 index = vertex; index != invalid_index; index = blocks_[index].next)
            for (u32 i = 0; i < blocks_[index].count; ++i)
                std::swap(blocks_[index].link[i].first, blocks_[index].link[i].last);
    }

private:
    static constexpr u32 capacity = 7;
    struct Block {
        std::array<LinkEdge, capacity> link;
        u32 count;
        u32 next;
    };

    void add(u32 vertex, LinkEdge edge) {
        u32 index = vertex;
        while (blocks_[index].count == capacity) {
            if (blocks_[index].next == invalid_index) {
                blocks_.push_back({{}, 0, invalid_index});
                blocks_[index].next = static_cast<u32>(blocks_.size() - 1);
            }
            index = blocks_[index].next;
        }
        blocks_[index].link[blocks_[index].count++] = edge;
    }

    void remove(u32 vertex, LinkEdge edge) {
        u32 last = vertex;
        while (blocks_[last].next != invalid_index && blocks_[blocks_[last].next].count > 0) last = blocks_[last].next;
        const LinkEdge moved = blocks_[last].link[--blocks_[last].count];
        if (moved.first == edge.first) return;
        for (u32 index = vertex;; index = blocks_[index].next)
            for (u32 i = 0; i < blocks_[index].count; ++i)
                if (blocks_[index].link[i].first == edge.first) {
                    blocks_[index].link[i] = moved;
                    return;
                }
    }

    /// One block per vertex, followed by further blocks of vertices with more triangles than one block can hold.
    Array<Block> blocks_;
};

/// The point is in no triangle (unused), on the boundary of the surface (front), or has a closed fan of triangles
/// (interior).
enum class PointState : u8 { unused, front, interior };

/// The limits under which a triangle was formed. 0: the given limits. 1, 2 …: limits that are relaxed more and more.
/// closing_pass: the triangle closed a hole.
using Pass = u8;
inline constexpr Pass closing_pass = 4;

/// Cosine of a dihedral deviation (angle between normals) of 150 degrees. At larger angles a triangle lies on its
/// neighbour.
inline constexpr double fold_cosine = -0.8660254037844387;

/// A surface that has no triangles at first. It keeps references to the points and the neighbourhoods.
struct Surface {
    /// `search_radii`, `density_radii`: one per point. `signs_count`: see `oriented`.
    Surface(const DistinctPoints& from, const Neighbourhoods& near, PointNormals point_normals,
            Array<double> search_radii, Array<double> density_radii, bool signs_count);

    const DistinctPoints& points;
    const Neighbourhoods& neighbourhoods;
    const Array<Vec3>& positions;
    /// At points of the surface, each normal is on the same side as the triangles' normals. At other points this holds
    /// only if `oriented`.
    Array<Vec3> normals;
    /// Surface variation, see PointNormals.
    Array<float> variation;
    /// For each point, the distance within which points are sought to continue the surface.
    Array<double> search_radius;
    /// For each point, the search radius that follows from the density alone. Triangles that are small compared with it
    /// are as small as the points' spacing requires.
    Array<double> density_radius;
    /// Whether the signs of the normals are known. If so, triangles must agree with them.
    bool oriented;
    /// The power of two above the longest side of the points' box. Exact predicates use a point at this distance along
    /// a unit normal. With a shorter distance, the sum would lose digits of the normal.
    double axis_length;
    /// Edges that the surface must contain. They are sharp: triangles at them and at their ends need not agree with
    /// their neighbours' normals. Normally none.
    FixedEdges fixed_edges;
    /// The sides of the fixed edges. Growth joins no points on two sides of one; closing holes may.
    EdgeSides edge_sides;

    Fans fans;
    Array<PointState> states;
    Array<Triangle> triangles;
    Array<Pass> passes;

    bool is_used(u32 point) const { return states[point] != PointState::unused; }
    /// Whether given normals put the points on two sides of a thin part.
    bool face_apart(u32 a, u32 b) const { return oriented && normals[a].dot(normals[b]) <= 0; }
    /// The next vertex along the boundary, with the surface on the left. Pre: a boundary vertex with one fan.
    u32 next_on_boundary(u32 vertex) const;
    /// Calls action(vertices) for every boundary loop, starting with its lowest vertex. Loops are sorted by their
    /// lowest vertex. The action may close the loop. Pre: every vertex has one fan.
    template <class Action>
    void for_each_boundary_loop(Action&& action) const {
        std::vector<bool> visited(states.size(), false);
        for (u32 begin = 0; begin < states.size(); ++begin) {
            if (states[begin] != PointState::front || visited[begin]) continue;
            std::vector<u32> loop;
            for (u32 vertex = begin; !visited[vertex]; vertex = next_on_boundary(vertex)) {
                visited[vertex] = true;
                loop.push_back(vertex);
            }
            action(std::move(loop));
        }
    }
    /// The unit normal of triangle a b c.
    Vec3 facet_normal(u32 a, u32 b, u32 c) const;

    /// Adds a → b → c. Pre: none of its three half-edges has a triangle.
    void add(const Triangle& triangle, Pass pass);
    /// Removes from the list the triangles that were removed from the fans. Of equal triangles, the oldest is removed.
    void drop(std::vector<Triangle> removed);
};

/// Whether the sine of the triangle's smallest angle is at least this.
bool has_angles_of(const Surface& surface, const Triangle& triangle, double least_sine);

/// Whether the triangle's normal agrees with the normal of each of its points. The cosine between them must be at least
/// `point_cosine`, or `sharp_cosine` at points at edges. Points at tips agree with every normal. The sign counts at
/// points of the surface, and at all points if the surface is oriented.
bool agrees_with_points(const Surface& surface, const Triangle& triangle, const Vec3& normal, double point_cosine,
                        double sharp_cosine);

/// Removes triangles until the triangles of every vertex form one fan, open or closed. If a vertex has several fans,
/// the fan with most triangles stays; of equally large fans, the one with the lowest vertex. Returns the number of
/// removed triangles. Cost: linear.
std::size_t remove_extra_fans(Surface& surface);

}  // namespace scanmill::growing
