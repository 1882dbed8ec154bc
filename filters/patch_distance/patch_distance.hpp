// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The signed distance of points to a surface of A-patches.

#include "scanmill/data/patches.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct PatchDistanceResult {
    /// All points, with their columns and `distance-to-patches` (double, a length): positive outside the object,
    /// negative inside, NaN where there is none. A column of that name in the input is replaced, with a warning.
    PointCloud points;
    /// Statistics over the points that have a distance.
    double rms = 0, p95 = 0, max = 0;
    /// Points farther away than a tenth of the surface's diagonal, and those nearest to an open surface's boundary.
    std::size_t unlocated = 0;
};

/// The distance to the nearest point of the surface: of a tessellation with 2 segments per edge the nearest point is
/// where Newton's method begins (PatchSurface::foot()). Exact to rounding. Where two parts of the surface are equally
/// near within the error of that tessellation, it may be that of the other one. Near ends of creases, and between faces
/// without tetrahedra between them, it is the distance to the tessellation; its sign is then that of the side of the
/// nearest triangle if the surface is open.
///
/// Pre:  finite points in the patches' frame; another one is refused. Throws Error if `points` or `patches` is empty,
/// if tetrahedra of a
///       triangle are missing, or if every point is far from the surface.
/// p95 is the smallest distance that at least 95 % of the located points do not exceed. Bytes do not depend on the
/// number of threads. Cost: about 7 us per point near the surface, and 20 us per triangle of the mesh.
/// Metrics: `rms`, `p95`, `max`, `unlocated`. Warns of unlocated points.
PatchDistanceResult patch_distance(const PatchComplex& patches, const PointCloud& points, Context& context);

}  // namespace scanmill
