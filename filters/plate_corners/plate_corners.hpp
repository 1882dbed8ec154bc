// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The four corners of a rectangular base plate in a scan: the points that bring a scanner's frame to a machine's.
///
/// Source: Wang 2006, chapter 5; Fischler and Bolles 1981 for the search for planes and lines among other points.

#include <optional>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct PlateCornersParams {
    /// The two known side lengths of the plate, in any order.
    std::optional<std::vector<Length>> sides;
    /// The largest distance of the plate's points from its plane; above 0.
    Length tolerance = Length::percent_of_diagonal(0.2);
    /// Points away from the upper side of the plate; used if the points have no column `normal`.
    std::vector<double> up = {0, 0, 1};
};

struct PlateCornersResult {
    /// Four points, counter-clockwise seen from the upper side, in the frame of the input. The first is that with the
    /// smallest x + y + z; ties: smallest x, then y. Column `normal`: the upper side's.
    PointCloud corners;
    /// Root of the mean squared distance of the points at the border from the sides between the corners.
    double residual = 0;
    /// The same for the distances of the plate's points from its plane.
    double flatness = 0;
    /// Mean lengths of the found sides from the first to the second corner, and from the second to the third; also
    /// where `sides` are given.
    double first_side = 0, second_side = 0;
    /// On the plane.
    std::size_t points = 0;
};

/// 1. The plane with the most points within `tolerance`, by random samples, then by least squares until its points stay
///    the same.
/// 2. The points on it that belong to a group of at least 2 % of them. The gap between two groups is larger
///    than a hundredth of the extent and than four times the spacing.
/// 3. The rectangle of smallest area around them, only as a start. Each of its sides is cut into strips, without the
///    tenth at either end, and the outermost point of every strip is taken.
/// 4. The line through most of these points within `tolerance` and one spacing, then by least squares. A side is found
///    if at least half of its strips are on the line.
/// 5. The border is beyond the outermost points. The line is moved outwards until the number of points within each
///    depth below it is that of a constant density.
/// 6. Neighbouring sides are intersected. With `sides`, the rectangle of this size that fits the corners best replaces
///    them.
/// If that fails, the points of the plane are left out, and the next plane is tried, at most three in all; the error of
/// the first is then thrown.
///
/// Half a spacing of a grid whose rows are along the border remains unknown; the corners are then at its middle.
///
/// Throws Error for fewer than 4 points, NaN or infinite coordinates, a tolerance that is not above 0, other than two
/// sides or sides that are not above 0; for points of which no plane holds a tenth; for a plane without four sides, or
/// whose sides do not meet at right angles within 5 degrees; for sides of another length than given, by more than two
/// tolerances and two spacings; for an upper side that cannot be decided.
/// Deterministic: the bytes depend on the seed, not on the number of threads. Cost: O(n log n); 50 bytes per point.
/// Metrics: `residual`, `flatness`, `side-1`, `side-2`, `plane-points`.
PlateCornersResult plate_corners(const PointCloud& cloud, const PlateCornersParams& params, Context& context);

}  // namespace scanmill
