// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The feature edges of the mesh that is decimated: its creases and boundary edges; and the classes of its vertices.

#include <span>
#include <vector>

#include "decimate/decimate.hpp"
#include "scanmill/data/half_edges.hpp"

namespace scanmill::decimating {

struct FeatureScale {
    double corner_angle = 0;  ///< radians
    /// A turn of a line is roughness if it vanishes when measured over this distance on both sides.
    double reach = 0;
};

class FeatureNetwork {
public:
    /// `opposite`: half_edges::opposites(mesh), `sharp`: whether the edge of a half-edge is on a crease, see
    /// creases.hpp. Keeps references to mesh and opposite.
    FeatureNetwork(const TriangleMesh& mesh, std::span<const u32> opposite, std::vector<bool> sharp,
                   const FeatureScale& scale);

    VertexClass vertex_class(u32 vertex) const { return classes_[vertex]; }
    /// Whether the vertex is the apex of a cone: a corner without feature edges.
    bool is_singular(u32 vertex) const { return classes_[vertex] == VertexClass::corner && counts_[vertex] == 0; }
    /// Whether the edge of the half-edge is sharp or on the boundary.
    bool is_feature(u32 half_edge) const { return features_[half_edge]; }
    /// Number of the mesh's declared sharp edges that are not features at this scale.
    std::size_t ignored_declared() const { return ignored_declared_; }

    /// A half-edge from the vertex. For a boundary vertex it is the first one of its fan, counter-clockwise. For a
    /// vertex without triangles it is half_edges::boundary.
    u32 first(u32 vertex) const { return first_[vertex]; }
    /// Calls action(half-edge, other end) for every feature edge at the vertex, counter-clockwise. The half-edge starts
    /// at the vertex, except for the last one of an open fan, which ends there. Pre: the vertex has triangles.
    template <class Action>
    void for_each_line(u32 vertex, Action&& action) const {
        u32 half_edge = first_[vertex];
        do {
            if (features_[half_edge]) action(half_edge, half_edges::end(mesh_, half_edge));
            const u32 last = half_edges::before(half_edge);
            if (opposite_[last] == half_edges::boundary) action(last, half_edges::start(mesh_, last));
            half_edge = opposite_[last];
        } while (half_edge != half_edges::boundary && half_edge != first_[vertex]);
    }
    /// Both neighbours on the feature line through a vertex. Pre: the vertex has two feature edges.
    std::array<u32, 2> line_neighbours(u32 vertex) const;
    /// Follows the line from `vertex` over its neighbour `next` to the first vertex for which `is_end` holds. Calls
    /// passed(v) for every vertex v on the way. Pre: each vertex on the way has two feature edges.
    template <class IsEnd, class Passed>
    u32 follow_line(u32 vertex, u32 next, IsEnd&& is_end, Passed&& passed) const {
        while (!is_end(next)) {
            passed(next);
            const auto [one, other] = line_neighbours(next);
            vertex = std::exchange(next, one == vertex ? other : one);
        }
        return next;
    }

private:
    const Vec3& position(u32 vertex) const { return mesh_.positions[vertex]; }
    void count_features();
    Vec3 point_on_line(u32 vertex, u32 next, double distance, bool& is_closed) const;
    bool turns(u32 vertex, const FeatureScale& scale) const;
    void classify(const FeatureScale& scale);
    void find_singular();

    const TriangleMesh& mesh_;
    std::span<const u32> opposite_;
    Array<u32> first_;
    std::vector<bool> features_;  ///< by half-edge
    Array<u32> counts_;  ///< by vertex: number of its feature edges
    Array<VertexClass> classes_;
    std::size_t ignored_declared_ = 0;
};

}  // namespace scanmill::decimating
