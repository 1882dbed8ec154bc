// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fuses registered views: where the surfaces of several views lie a little apart, the views move onto their common
/// mean surface. Every view keeps its own detail and its own noise.
///
/// The weights follow Turk and Levoy 1994 and Curless and Levoy 1996: a view counts less where it sees the surface at a
/// flat angle, and less near its border. They move vertices of meshes and values of a voxel grid; here the points move.

#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill::merging {

/// One view, in the frame that all views share.
struct ViewToFuse {
    std::span<const Vec3> positions;
    /// One normal per position, of any length, which points away from the material; or empty, to estimate normals. A
    /// position with a normal that is zero or not finite stays, and counts for no other position.
    std::span<const Vec3> normals;
    /// Directions to the scanner, of any length above 0: one per position, or one for all. Estimated normals are on
    /// this side.
    std::span<const Vec3> to_scanner;
    /// Whether `to_scanner` weighs the points of the view; if not, its directions only decide the side of normals.
    bool weighs_angle = true;
};

struct Fused {
    /// The new positions of all views, end to end.
    Array<Vec3> positions;
    /// Signed distances that the positions moved along their normals.
    Array<double> moved;
    std::size_t count = 0;  ///< positions that moved
};

/// Moves every point along its normal by the difference between the weighted mean height of all views and the height
/// of its own view. The difference is a smooth function of the place, so the views come to lie on one layer, and the
/// details and the noise of each view move along unchanged.
///
/// Spacing: the median over the views of a view's median distance between nearest distinct positions. `length` may be
/// in spacings. Reach: the median over the views of a view's median distance to the 24th nearest position of the same
/// view; about 3 spacings on a regular grid.
///
/// Partners of a point p with normal n are the points q, of any view, whose offset from p is less than `reach` long
/// across n and at most `length` along n, and whose normal has a product above 0.7 with n. The last condition keeps the
/// two sides of a thin wall apart. Kernel: (1 - (distance across / reach)⁴)². Height of a view at p: that of the plane
/// that fits its partners best with this kernel, at p. It is fitted to each partner's height minus half of what its
/// tangent plane rises between p and the partner. For a quadric, these values are on a plane with the quadric's height
/// at p, so the height is exact even where all partners are on one side. A view with fewer than 3 partners does not
/// count.
///
/// Weight of a view at p: the product of
///  - the mean cosine between the normals of its partners and their directions to the scanner, at least 0.05; 1 for
///    views without `weighs_angle`;
///  - the mean of its partners' distances to the border of the view, as a fraction of 4 reaches, at most 1, plus 0.01;
///  - for other views than that of p: a factor that falls to 0 where the partners are all on one side of p, because
///    the plane would be extrapolated.
/// A point is on the border of its view if its 24 nearest neighbours leave a wedge of more than 150 degrees empty.
///
/// A point with partners in no other view stays, to the last bit. Duplicates within a view have equal results if their
/// normals are equal. All heights use the given positions, so the result does not depend on an order of the views. A
/// chain of layers, each within `length` of the next but not of all, does not become one layer.
///
/// Pre: positions are finite; `length` is 0 or more, in the unit of the positions or in spacings. Bytes do not depend
/// on the number of threads or on the processor. Cost: O(n k) for k partners, which grow with the number of views that
/// overlap and with the square of `length` once it exceeds the reach; about 200 bytes per point, and as much again per
/// point of the largest view. Throws Cancelled.
Fused fuse(std::span<const ViewToFuse> views, const Length& length, Execution& execution);

}  // namespace scanmill::merging
