// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The normal at every point before there is a surface, by principal component analysis.

#include "scanmill/geometry/growing/distinct_points.hpp"

namespace scanmill::growing {

/// A point with a surface variation above this lies at an edge or a tip. At an edge of 90 degrees it is 0.1; noise of
/// 0.3 spacings makes 0.03.
inline constexpr float sharp_variation = 0.04f;
/// Above this the normal of a point is meaningless: it lies at a tip.
inline constexpr float tip_variation = 0.18f;

struct PointNormals {
    /// Unit length. The sign of principal normals is arbitrary.
    Array<Vec3> directions;
    /// Surface variation (Pauly, Gross, Kobbelt 2002): the variance of the neighbours along the normal over their whole
    /// variance, 0 to 1/3.
    Array<float> variation;
};

/// The direction in which a point and its 12 nearest neighbours vary least, by scatter_of(). Cost: linear.
PointNormals principal_normals(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, unsigned threads);

}  // namespace scanmill::growing
