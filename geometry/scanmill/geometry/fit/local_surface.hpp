// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Estimates the surface around a point of a scan from the nearest neighbours: a plane, and a quadric over the plane.
///
/// The plane minimises the sum of squared distances to the points. The quadric passes through one of the points and may
/// be inclined to the plane. Which side of the surface is outside is not decided.

#include <limits>
#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/point_tree.hpp"

namespace scanmill {

struct LocalSurfaceParams {
    /// Number of nearest other positions that the fit uses.
    u32 neighbours = 25;
    /// The point that the quadric passes through.
    enum class Origin {
        nearest,  ///< the point itself, where the quadric is tangent to the plane: for neighbours on all sides
        centroid  ///< the one nearest the centroid of the point and its neighbours; may be inclined to the plane
    };
    Origin origin = Origin::centroid;
};

struct LocalSurface {
    /// Unit length, by with_positive_sign(). Normal of the quadric at its origin; without a quadric, Scatter::normal of
    /// the point and its neighbours.
    Vec3 normal = Vec3::Zero();
    /// Principal curvatures at the quadric's origin, |first| >= |second|; positive towards the normal.
    double first_curvature = 0, second_curvature = 0;
    /// Mean distance between the neighbours and the quadric (or the plane), along the normal of the plane.
    double fit_error = 0;
    /// Distance to the nearest neighbour; infinite without one.
    double spacing = std::numeric_limits<double>::infinity();
    /// Neighbours excluded from the fit: more than three standard deviations off.
    u32 outliers = 0;
    /// False if no quadric is determined: fewer than 6 neighbours, or all near one line or conic. The result is then
    /// the plane, with curvature 0.
    bool is_curved = false;
};

/// The surface around `point`. Pre: neighbours ascend by distance; none of them is the point.
/// Scaling point and neighbours by a power of two scales the result exactly.
/// Weights are 1 / (d² + h²): d is the distance to the origin within the plane, h² the mean of d². Neighbours off by
/// more than three standard deviations are excluded once, if at least 6 remain.
/// Source: Wang 2006, section 3.5; the inclination is an addition.
LocalSurface local_surface(const Vec3& point, std::span<const Vec3> neighbours, LocalSurfaceParams::Origin origin);

/// Fits a surface at every position of the tree; uses all other positions if there are fewer than params.neighbours.
/// The result depends on the positions alone, not on threads. Cost: for 25 neighbours about twice that of finding
/// them. Checks for cancellation.
Array<LocalSurface> local_surfaces(const PointTree& tree, const LocalSurfaceParams& params, const Execution& execution);

}  // namespace scanmill
