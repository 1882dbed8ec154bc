// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Measures the signed distance of points to a surface of A-patches.

#include <span>

#include "scanmill/data/patches.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct PatchDistanceResult {
    /// All points, with their columns and the column `distance-to-patches` (double, a length). It is positive outside
    /// the object and negative inside. It is NaN for a point without a distance. It replaces a column of that name in
    /// the input, with a warning.
    PointCloud points;
    /// Statistics over the points that have a distance.
    double rms = 0, p95 = 0, max = 0;
    /// Number of points without a distance. They are farther away than a tenth of the surface's diagonal, or nearest to
    /// an open surface's boundary.
    std::size_t unlocated = 0;
};

struct PatchDistances {
    Array<double> of_points;  ///< positive outside, negative inside; NaN for a point without a distance
    double limit = 0;  ///< points farther away have no distance: a tenth of the surface's diagonal
};

/// Measures the signed distance of every point to the nearest point of the surface, exact to rounding.
///
/// Newton's method (PatchSurface::foot()) starts at the nearest point of a tessellation with 2 segments per edge. If
/// two parts of the surface are equally near within the error of that tessellation, the result may be the distance to
/// either of them. Near ends of creases, and between faces that have no tetrahedra between them, the result is the
/// distance to the tessellation. On an open surface, such a distance has the sign of the nearest triangle's side.
///
/// Pre: finite points in the frame of the patches, and at least one tetrahedron. Throws Error if tetrahedra of a
/// triangle are missing. Bytes do not depend on the number of threads. Cost: about 7 us per point near the surface, and
/// 20 us per triangle of the mesh.
PatchDistances distances_to_patches(const PatchComplex& patches, std::span<const Vec3> points, Execution& execution);

/// Measures the signed distance of every point to the surface; see distances_to_patches().
///
/// Pre:  finite points in the frame of the patches. Throws Error otherwise, if `points` or `patches` is empty, if
///       tetrahedra of a triangle are missing, or if every point is far from the surface.
/// Post: p95 is the smallest unsigned distance that at least 95 % of the located points do not exceed. Bytes do not
///       depend on the number of threads. Warns of unlocated points.
/// Metrics: `rms`, `p95`, `max`, `unlocated`.
PatchDistanceResult patch_distance(const PatchComplex& patches, const PointCloud& points, Context& context);

}  // namespace scanmill
