// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Bounds of the Hausdorff distance between two meshes that hold for every point of both surfaces, not for samples.

#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// lower ≤ Hausdorff distance ≤ upper, in the surfaces' unit.
struct CertifiedHausdorff {
    double lower = 0, upper = 0;
    /// Whether upper - lower is as small as was asked, or upper below 1e-9 of the diagonal; otherwise the work ended.
    bool reached = false;
    /// Pieces that were cut.
    u64 cuts = 0;
};

struct CertifyLimits {
    /// Wanted: upper - lower ≤ gap · upper. In (0, 1).
    double gap = 0.01;
    u64 most_cuts = 10'000'000;
};

/// One of the two surfaces: positions that its triangles use, and the tree over exactly these.
struct CertifiedSurface {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
    const TriangleTree& tree;
};

/// Branch and bound over the triangles of both surfaces. The largest distance over a piece of a triangle is at most
///  - the largest of its corners' distances to any one triangle of the other surface, as the distance to a convex set
///    is convex; tried with the triangles nearest to the centre and to the corners;
///  - the distance at its centre plus the distance from there to its farthest corner.
/// The largest distance seen at a corner or centre is the lower bound. The pieces with the largest upper bounds are
/// cut, along the edges of the triangle under them (see certify_piece.hpp), until all are near enough to the lower
/// bound.
///
/// Both bounds are widened by 2^-46 of the largest coordinate, the rounding of positions; an upper bound not above that
/// is 0: equal surfaces of equal triangles are at 0. Bytes do not depend on the number of threads.
/// Cost: a few cuts per triangle, some microseconds each; more where the surfaces meet at angles.
/// Source: Guthe, Borodin, Klein 2005; Tang, Lee, Kim 2009.
CertifiedHausdorff certified_hausdorff(const CertifiedSurface& one, const CertifiedSurface& other,
                                       const CertifyLimits& limits, Context& context);

namespace measuring {
/// The distance below which positions near `largest_coordinate` cannot be told apart.
constexpr double rounding_of(double largest_coordinate) { return 0x1p-46 * largest_coordinate; }
}  // namespace measuring

}  // namespace scanmill
