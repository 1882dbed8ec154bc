// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The overlap facets: facets of the model under the boundary of a cloud. They form a closed barrier under every loop.
///
/// The paper marks facets under boundary points only. A cloud that is sparser than the model leaves gaps between them,
/// so here every boundary edge is followed on the model, from facet to facet across edges.
///
/// Source: Woo, Dey 2005, section 3.3, equations 1 to 3.

#include <optional>
#include <vector>

#include "mesh_update/cloud_surface.hpp"
#include "mesh_update/model.hpp"

namespace scanmill::updating {

/// A point against the plane of a facet.
struct Projection {
    double distance;  ///< D of equation 2, positive on the side that the facet faces
    Vec3 foot;  ///< equation 3
    bool is_inside;  ///< whether the foot is in the facet, border included
};
/// Pre: the facet has an area. Seen from a foot in the facet, the angles between its corners add up to 2π; this is
/// tested with barycentric coordinates, to 1e-9 of them.
Projection project(const Vec3& point, const std::array<Vec3, 3>& facet);

/// A boundary edge of a cloud on the model.
struct EdgeOverlap {
    u32 half_edge;  ///< in the cloud's surface
    /// Facets that connect the one under the edge's start with the one under its end, over edges; ascending. Where
    /// points hang, those up to the next point with a facet belong to the last edge before. Empty if its start hangs.
    std::vector<u32> facets;
    /// Nearest point of the model to the middle of the edge; absent if farther than max_distance.
    std::optional<Vec3> foot;
};

struct LoopOverlap {
    std::vector<EdgeOverlap> edges;  ///< in the order of the loop
    std::vector<u32> facets;  ///< those of all edges, ascending
    std::vector<double> offsets;  ///< |D| of the boundary points with an overlap facet
    std::size_t hanging = 0;  ///< boundary points farther than max_distance from the model
    Vec3 farthest = Vec3::Zero();  ///< the boundary point farthest from the model
    double farthest_distance = 0;
};

/// Counts a boundary point at this distance from the model.
inline void add_distance(LoopOverlap& overlap, const Vec3& point, double distance, double max_distance) {
    if (distance > overlap.farthest_distance) {
        overlap.farthest_distance = distance;
        overlap.farthest = point;
    }
    overlap.hanging += distance > max_distance;
}

/// `max_distance`: boundary points farther from the model have no overlap facet.
/// Ties: of equally near facets, that with the lowest row.
/// Cost: O(log F) per boundary edge, and the facets under it.
LoopOverlap overlap_of(const Model& model, const CloudSurface& cloud, const CloudLoop& loop, double max_distance,
                       Context& context);

/// The paper's thick border: all facets at the model's vertices nearest to boundary points.
class CandidateFacets {
public:
    /// Pre: the model outlives this object. Cost: O(n log n).
    CandidateFacets(const Model& model, unsigned threads);

    /// Adds the facets to those of the loop's edges. Ties: the lowest vertex.
    void add(const CloudSurface& cloud, const CloudLoop& loop, double max_distance, LoopOverlap& overlap) const;

private:
    const Model& model_;
    Array<u32> corners_;  ///< by vertex in a triangle, a half-edge that starts there
    TriangleTree vertices_;  ///< tree over the starts of `corners_`
};

}  // namespace scanmill::updating
