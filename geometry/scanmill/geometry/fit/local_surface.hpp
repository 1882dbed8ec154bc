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
        centroid  ///< the point nearest the centroid of the point and its neighbours; the quadric may be inclined
    };
    Origin origin = Origin::centroid;
};

struct LocalSurface {
    /// Unit vector with the sign of with_positive_sign(): the normal of the quadric at its origin. Without a quadric,
    /// it is Scatter::normal of the point and its neighbours.
    Vec3 normal = Vec3::Zero();
    /// Principal curvatures at the quadric's origin, |first| >= |second|; positive towards the normal.
    double first_curvature = 0, second_curvature = 0;
    /// Mean distance between the neighbours and the quadric (or the plane), along the normal of the plane.
    double fit_error = 0;
    /// Distance to the nearest neighbour; infinite without one.
    double spacing = std::numeric_limits<double>::infinity();
    /// Number of neighbours that the fit excludes: their error exceeds three standard deviations.
    u32 outliers = 0;
    /// False if no quadric is determined: there are fewer than 6 neighbours, or all are near one line or conic. The
    /// result is then the plane, with curvature 0.
    bool is_curved = false;
};

/// Fits a surface to `point` and its neighbours. Pre: neighbours ascend by distance; none of them is the point.
/// Scaling point and neighbours by a power of two scales the result exactly.
/// Weights are 1 / (d² + h²): d is the distance to the origin within the plane, h² the mean of d². The fit is repeated
/// once without the neighbours whose error exceeds three standard deviations, if at least 6 remain.
/// Source: Wang 2006, section 3.5; the inclination is an addition.
LocalSurface local_surface(const Vec3& point, std::span<const Vec3> neighbours, LocalSurfaceParams::Origin origin);

/// Fits a surface at every position of the tree; uses all other positions if there are fewer than params.neighbours.
/// The result depends on the positions alone, not on the number of threads. Cost: for 25 neighbours, about twice the
/// cost of finding them. Throws Cancelled.
Array<LocalSurface> local_surfaces(const PointTree& tree, const LocalSurfaceParams& params, const Execution& execution);

}  // namespace scanmill
