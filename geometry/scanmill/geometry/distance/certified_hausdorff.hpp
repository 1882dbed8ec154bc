// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The Hausdorff distance between two meshes: the largest distance that a short search finds, and certified bounds that
/// hold for every point of both surfaces.

#include <optional>
#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/distance/nearest_distances.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// lower ≤ Hausdorff distance ≤ upper, in the surfaces' unit.
struct CertifiedHausdorff {
    double lower = 0, upper = 0;
    /// The largest distance that was computed at a point of either surface. Not below `lower`; at most the rounding of
    /// positions above the Hausdorff distance.
    double found = 0;
    /// Whether upper - lower is as small as the limits ask, or upper is negligible. Otherwise the cuts were used up, or
    /// `lower` is above the limits' bound.
    bool reached = false;
    /// Parts of triangles that were cut.
    u64 cuts = 0;
};

struct CertifyLimits {
    /// The search ends when upper - lower ≤ gap · upper, or when upper is negligible: below 1e-9 of the diagonal, or
    /// not above gap · bound. In (0, 1).
    double gap = 0.01;
    u64 most_cuts = 10'000'000;
    /// A length that the distance should not exceed. The search then ends when upper ≤ bound as well, which proves it,
    /// or at once when lower > bound, which refutes it. If neither holds in the result, the cuts were used up, or the
    /// distance and the bound differ by no more than the rounding of positions. At least 0.
    std::optional<double> bound{};
};

/// One of the two surfaces. The tree is over exactly these positions and triangles.
struct CertifiedSurface {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
    const TriangleTree& tree;
    /// nearest_of_vertices() on the other surface.
    const NearestDistances& vertices;
    /// Triangles of samples, and their distances to the other surface; may be empty.
    std::span<const u32> sampled_triangles{};
    std::span<const double> sampled_distances{};
};

/// The largest distance from a point of either surface to the other that a search of limited length finds; 0 if it is
/// not above the rounding of positions. The search is that of certified_hausdorff(), but it takes the parts with the
/// largest distances seen first, at vertices and samples for a start, and ends after 15,000 parts. Normally the result
/// is at most `gap` below the Hausdorff distance; on very large meshes of very different triangles the search may end
/// too early for that. It is not above the Hausdorff distance, except for rounding. `gap`: in (0, 1).
/// Cost: about 0.2 µs per triangle, and 0.1 s for the search.
double largest_distance(const CertifiedSurface& one, const CertifiedSurface& other, double gap, Execution& execution);

/// Branch and bound over the triangles of both surfaces. The largest distance over a part of a triangle is at most
///  - the largest of its corners' distances to any one triangle of the other surface, because the distance to a convex
///    set is convex; the triangles nearest to the centre and to the corners are tried;
///  - the distance at its centre plus the distance from there to its farthest corner.
/// The largest distance computed at a corner or centre is the lower bound. The parts with the largest upper bounds are
/// cut, along the edges of the triangle below them, until all are near enough to the lower bound and not above the
/// limits' bound.
///
/// `seen`: a distance known at some point of either surface, of largest_distance() for example. If the cuts are used
/// up, the bounds are wider but hold.
///
/// Both bounds are widened by 2^-46 of the largest coordinate, the rounding of positions; an upper bound not above that
/// is 0: equal surfaces of equal triangles have distance 0. Bytes do not depend on the number of threads.
/// Cost: one to a few cuts per triangle, some microseconds each; more where the surfaces meet at angles. About 150
/// bytes for each triangle whose bound is above the result, for about `most_cuts` of them at most.
/// Source: Guthe, Borodin, Klein 2005; Tang, Lee, Kim 2009.
CertifiedHausdorff certified_hausdorff(const CertifiedSurface& one, const CertifiedSurface& other, double seen,
                                       const CertifyLimits& limits, Execution& execution);

/// The same for two meshes: makes the trees, computes the distances of the vertices, and begins with
/// largest_distance(). Vertices in no triangle are not part of a surface. Positions are compared as they are, whatever
/// the frames. Pre: finite positions and at least one triangle in both. Cost: additionally about 2 µs and 130 bytes per
/// triangle.
CertifiedHausdorff certified_hausdorff(const TriangleMesh& one, const TriangleMesh& other, const CertifyLimits& limits,
                                       Execution& execution);

}  // namespace scanmill
