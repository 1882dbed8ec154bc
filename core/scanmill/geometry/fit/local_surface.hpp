// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The surface around a point of a scan, as its nearest neighbours show it: a plane for a start, a quadric over that.
///
/// The plane is the one with the least sum of squared distances to the points (so none is too steep for it); the
/// quadric goes through one of the points and may be inclined to the plane. Nothing here knows which side is outside.

#include <limits>
#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/spatial/point_tree.hpp"

namespace scanmill {

struct LocalSurfaceParams {
    /// How many of the nearest other places show the surface.
    u32 neighbours = 25;
    /// Which point the quadric goes through.
    enum class Origin {
        nearest,  ///< the point itself, with the plane for its tangent: right where neighbours lie all around
        centroid  ///< of it and its neighbours the one nearest their centroid, and it may be inclined to the plane
    };
    Origin origin = Origin::centroid;
};

struct LocalSurface {
    /// Unit length; its coordinate of largest size is positive (of equal ones the first). Where there is no quadric,
    /// the direction in which point and neighbours have least spread about their centroid; some direction across it
    /// when they lie on a line, (0, 0, 1) for one place.
    Vec3 normal = Vec3::Zero();
    /// Principal curvatures at the quadric's origin, |first| >= |second|; positive where it bends towards the normal.
    double first_curvature = 0, second_curvature = 0;
    /// Mean distance, along the normal of the plane, between the neighbours and the quadric (or the plane).
    double fit_error = 0;
    /// Distance to the nearest neighbour; infinite without one.
    double spacing = std::numeric_limits<double>::infinity();
    /// Neighbours that were left out of the fit because they lie more than three standard deviations off.
    u32 outliers = 0;
    /// False where no quadric is determined: fewer than 6 neighbours, or all near one line or conic. Then the plane
    /// stands for it, with curvature 0.
    bool is_curved = false;
};

/// Around `point`, from neighbours that ascend by distance; none of them is the point. Scaling point and neighbours by
/// a power of two scales the result exactly.
/// Weights are 1 / (d² + h²), d the distance to the origin within the plane, h² the mean of d². Neighbours off by more
/// than three standard deviations are left out once, when at least 6 stay.
/// Source: Wang 2006, section 3.5, with an inclination that it lacks; curvature of graphs: any textbook.
LocalSurface local_surface(const Vec3& point, std::span<const Vec3> neighbours, LocalSurfaceParams::Origin origin);

/// For every place of the tree; places with fewer neighbours than asked use all there are.
/// Deterministic: depends on the places alone, not on threads. Cost: for 25 neighbours about twice that of finding
/// them. Checks for cancellation.
Array<LocalSurface> local_surfaces(const PointTree& tree, const LocalSurfaceParams& params, const Execution& execution);

}  // namespace scanmill
