// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A view reduced to about a thousand points, with what the comparison with other views needs.

#include "scanmill/geometry/registration/consensus.hpp"
#include "scanmill/geometry/registration/descriptors.hpp"
#include "scanmill/geometry/registration/line_of_sight.hpp"
#include "scanmill/geometry/registration/nearest_within.hpp"
#include "scanmill/geometry/registration/pose_graph.hpp"

namespace scanmill::registration {

/// Pairs of reduced points are never farther apart than this many times `resolution`.
inline constexpr double largest_reach = 2;

struct ReducedView {
    double resolution = 0;
    /// Evenly spread means of the view's points, about `resolution` apart. They move with the view, apart from
    /// rounding, and so does all that is derived from them.
    Array<Vec3> points;
    /// Unit vectors, turned to the scanner: the normals of the planes through the neighbours within 2 `resolution`.
    Array<Vec3> normals;
    Array<Descriptor> descriptors;
    ViewExtent extent;
    NearestWithin nearest;
    SightLines sight;

    PointsWithNormals points_with_normals() const { return {points, normals}; }
};

/// Centroid and root mean square distance of the points from it.
ViewExtent extent_of(std::span<const Vec3> points);

/// Reduces a view. `to_scanner` is the unit direction from the view to its scanner; `sees_all` as for SightLines.
/// Pre: finite points, resolution > 0. Cost: about 30 ms for 40,000 points.
ReducedView reduced_view(std::span<const Vec3> points, const Vec3& to_scanner, double resolution, bool sees_all = true);

/// Reduces a surface that no single scanner sees. `outside` has a unit vector from the surface outwards for all points,
/// or one for each. Its lines of sight are empty.
ReducedView reduced_surface(std::span<const Vec3> points, std::span<const Vec3> outside, double resolution);

}  // namespace scanmill::registration
