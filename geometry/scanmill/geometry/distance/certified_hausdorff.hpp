// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The Hausdorff distance between two meshes: the largest distance that a short search finds, and certified bounds that
/// are valid for every point of both surfaces.

#include <optional>
#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/distance/nearest_distances.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// lower ≤ Hausdorff distance ≤ upper, in the surfaces' unit.
struct CertifiedHausdorff {
    double lower = 0, upper = 0;
    /// The largest distance that was computed at a point of either surface. It is not below `lower`. It exceeds the
    /// Hausdorff distance by at most the rounding of positions.
    double found = 0;
    /// Whether upper - lower is as small as the limits require, or upper is negligible. Otherwise the search ended
    /// because the cuts were used up or `lower` exceeded the limits' bound.
    bool reached = false;
    /// Number of parts of triangles that were cut.
    u64 cuts = 0;
};

struct CertifyLimits {
    /// The search ends when upper - lower ≤ gap · upper, or when upper is negligible. Negligible is a value below 1e-9
    /// of the diagonal, or at most gap · bound. `gap` is in (0, 1).
    double gap = 0.01;
    u64 most_cuts = 10'000'000;
    /// A length that the distance should not exceed; at least 0. With a bound, the search also needs upper ≤ bound to
    /// end; the bound is then proved. It ends at once when lower > bound; the bound is then refuted. The result may
    /// leave the bound undecided for two reasons: the cuts were used up, or the distance and the bound differ by no
    /// more than the rounding of positions.
    std::optional<double> bound{};
};

/// One of the two surfaces. The tree contains exactly these positions and triangles.
struct CertifiedSurface {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
    const TriangleTree& tree;
    /// Result of nearest_of_vertices() for these vertices and the other surface.
    const NearestDistances& vertices;
    /// Triangles on which samples lie, and the samples' distances to the other surface. Both may be empty.
    std::span<const u32> sampled_triangles{};
    std::span<const double> sampled_distances{};
};

/// A short search for the largest distance from a point of either surface to the other surface. Returns 0 if that is
/// not above the rounding of positions. The search works like certified_hausdorff(), with two differences. It first
/// takes the parts with the largest distances seen so far; at the start these are the distances of vertices and
/// samples. It ends after 15,000 parts.
///
/// Normally the result is at most `gap` below the Hausdorff distance. On very large meshes of very different triangles
/// the search may end too early for that. Except for rounding, the result is not above the Hausdorff distance. `gap`:
/// in (0, 1). Cost: about 0.2 µs per triangle, and 0.1 s for the search.
double largest_distance(const CertifiedSurface& one, const CertifiedSurface& other, double gap, Execution& execution);

/// Branch and bound over the triangles of both surfaces. The largest distance over a part of a triangle is at most the
/// smaller of two bounds:
/// - the largest distance of its corners to any one triangle of the other surface, because the distance to a convex set
///   is convex; the triangles nearest to the centre and to the corners are tried;
/// - the distance at its centre plus the distance from the centre to its farthest corner.
///
/// The largest distance computed at a corner or centre is the lower bound. The parts with the largest upper bounds are
/// cut, along the edges of the triangle below them. The search ends when all upper bounds are near enough to the lower
/// bound and not above the limits' bound.
///
/// `seen`: a distance known at some point of either surface, for example from largest_distance(). If the cuts are used
/// up, the bounds are wider but still valid.
///
/// Both bounds are widened by 2^-46 of the largest coordinate, the rounding of positions. An upper bound not above this
/// rounding is returned as 0, so equal surfaces of equal triangles have distance 0. Bytes do not depend on the number
/// of threads.
/// Cost: one to a few cuts per triangle, some microseconds each; more where the surfaces meet at angles. About 150
/// bytes for each triangle whose bound is above the result, for at most about `most_cuts` of them.
/// Source: Guthe, Borodin, Klein 2005; Tang, Lee, Kim 2009.
CertifiedHausdorff certified_hausdorff(const CertifiedSurface& one, const CertifiedSurface& other, double seen,
                                       const CertifyLimits& limits, Execution& execution);

/// The same for two meshes: makes the trees, computes the distances of the vertices, and starts with
/// largest_distance(). Vertices in no triangle are not part of a surface. Positions are compared as given, without the
/// frames. Pre: finite positions and at least one triangle in both. Cost: additionally about 2 µs and 130 bytes per
/// triangle.
CertifiedHausdorff certified_hausdorff(const TriangleMesh& one, const TriangleMesh& other, const CertifyLimits& limits,
                                       Execution& execution);

}  // namespace scanmill
