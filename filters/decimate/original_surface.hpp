// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Paths on the original surface. They give the distance between a new edge and the original surface.

#include "decimate/errors.hpp"
#include "decimate/feature_network.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"

namespace scanmill::decimating {

class OriginalSurface {
public:
    /// Keeps references. `opposite`: half_edges::opposites(mesh); `lowest`: lowest_at_position().
    OriginalSurface(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const u32> lowest,
                    const FeatureNetwork& features)
        : features_(features),
          mesh_(mesh),
          opposite_(opposite),
          lowest_(lowest) {}

    const FeatureNetwork& features() const { return features_; }
    const Vec3& position(u32 vertex) const { return mesh_.positions[vertex]; }
    std::span<const Vec3> positions() const { return mesh_.positions.span(); }
    /// Whether the triangles intersect. As in self_intersections(), vertices at one position count as one vertex.
    bool intersect(const Triangle& one, const Triangle& other) const {
        return triangles_intersect(positions(), lowest(one), lowest(other));
    }

    /// Follows the surface from vertex `from` to vertex `to`, in the plane through both vertices that contains `up`.
    /// Adds the distances of the path to the straight segment. The distance to a segment is convex, so it is largest at
    /// one of the points where the path crosses an edge. Returns false if the path exceeds the limits or crosses a
    /// feature edge.
    bool add_path(u32 from, u32 to, const Vec3& up, const SignedErrors& limits, SignedErrors& errors) const;

private:
    Triangle lowest(const Triangle& triangle) const {
        return {lowest_[triangle[0]], lowest_[triangle[1]], lowest_[triangle[2]]};
    }

    const FeatureNetwork& features_;
    const TriangleMesh& mesh_;
    std::span<const u32> opposite_;
    std::span<const u32> lowest_;
};

}  // namespace scanmill::decimating
