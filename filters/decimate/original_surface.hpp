// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The surface that is decimated, as it was: its sharp edges, the classes of its vertices, and paths along it.

#include <span>
#include <vector>

#include "decimate/decimate.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"

namespace scanmill::decimating {

/// Distances of points of the original surface to the new one: above it (on the side of its normals) and below.
struct SignedErrors {
    double outside = 0, inside = 0;

    void add(const SignedErrors& other) {
        outside = std::max(outside, other.outside);
        inside = std::max(inside, other.inside);
    }
    void add(double distance, bool is_outside) {
        double& error = is_outside ? outside : inside;
        error = std::max(error, distance);
    }
};

/// What counts as a feature.
struct FeatureScale {
    double sharp_angle = 0, corner_angle = 0;
    /// A sharp edge also needs this angle between the mean normals of the surface up to this distance on both sides, and
    /// a corner between the directions of the line up to this distance: so roughness within max-error is no feature.
    double reach = 0;
};

class OriginalSurface {
public:
    /// `opposite`: half_edges::opposites(mesh). Keeps references to both.
    OriginalSurface(const TriangleMesh& mesh, std::span<const u32> opposite, const FeatureScale& scale, unsigned threads);

    const Vec3& position(u32 vertex) const { return mesh_.positions[vertex]; }
    VertexClass vertex_class(u32 vertex) const { return classes_[vertex]; }
    /// Whether the edge of the half-edge is sharp or on the boundary.
    bool is_feature(u32 half_edge) const { return features_[half_edge]; }

    /// Follows the surface from vertex `from` to vertex `to`, in the plane through both that contains `up`. Adds the
    /// distances of the path to the segment between them: the largest is at a vertex of the path.
    /// Returns false if the path leaves the limits, crosses a feature edge, or does not arrive.
    bool add_path(u32 from, u32 to, const Vec3& up, const SignedErrors& limits, SignedErrors& errors) const;

    /// The vertices of a feature line from a vertex that is on it but not its end, in both directions: the neighbours.
    /// Pre: class crease or boundary.
    std::array<u32, 2> line_neighbours(u32 vertex) const;

    /// Calls action(half-edge, other end) for every feature edge at the vertex, counter-clockwise.
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

private:
    void find_features(std::span<const Vec3> normals, const FeatureScale& scale, unsigned threads);
    void count_lines();
    bool merge_small_faces(double least_area);
    /// Removes branches with a free end that are shorter than `reach`.
    void prune(double reach);
    void classify(const FeatureScale& scale);
    Vec3 line_point(u32 vertex, u32 next, double distance, bool& is_closed) const;

    const TriangleMesh& mesh_;
    std::span<const u32> opposite_;
    Array<u32> first_;  ///< by vertex: a half-edge from it; on the boundary the first of its fan
    std::vector<bool> features_;
    Array<u8> line_counts_;  ///< by vertex: feature edges at it
    Array<VertexClass> classes_;
};

}  // namespace scanmill::decimating
