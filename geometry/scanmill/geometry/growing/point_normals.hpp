// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Estimates the normal at every point by principal component analysis, before there is a surface.

#include "scanmill/geometry/growing/distinct_points.hpp"

namespace scanmill::growing {

/// A point with a larger surface variation lies at an edge or a tip. At an edge of 90 degrees the variation is 0.1;
/// noise of 0.3 spacings causes 0.03.
inline constexpr float sharp_variation = 0.04f;
/// A point with a larger surface variation lies at a tip; its normal is meaningless.
inline constexpr float tip_variation = 0.18f;

struct PointNormals {
    /// Unit vectors. The sign of principal normals is arbitrary.
    Array<Vec3> directions;
    /// Surface variation (Pauly, Gross, Kobbelt 2002): the variance of the neighbours along the normal divided by their
    /// total variance. 0 to 1/3.
    Array<float> variation;
};

/// The normal is the direction of least variance of a point and its 12 nearest neighbours, by scatter_of(). Cost:
/// linear.
PointNormals principal_normals(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, unsigned threads);

}  // namespace scanmill::growing
