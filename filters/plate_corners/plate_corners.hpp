// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the four corners of a rectangular base plate in a scan. They serve to bring the scanner's frame to a machine's
/// frame.
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
    /// Direction in which the upper side of the plate faces; used if the points have no column `normal`.
    std::vector<double> up = {0, 0, 1};
};

struct PlateCornersResult {
    /// Four points, counter-clockwise seen from the upper side, in the frame of the input. The first one has the
    /// smallest x + y + z; ties: smallest x, then y. The column `normal` holds the normal of the upper side.
    PointCloud corners;
    /// Root of the mean squared distance of the points at the border from the sides between the corners.
    double residual = 0;
    /// Root of the mean squared distance of the plate's points from its plane.
    double flatness = 0;
    /// Measured side lengths, also if `sides` are given: from the first to the second corner, and from the second to
    /// the third. Each is the mean of two opposite sides.
    double first_side = 0, second_side = 0;
    /// Number of points on the plane.
    std::size_t points = 0;
};

/// Finds the corners in six steps:
/// 1. Random samples find the plane with the most points within `tolerance`. Least squares then fits the plane to these
///    points until the set of points stays the same.
/// 2. Points on the plane count only if they belong to a group of at least 2 % of them. The gap between two groups is
///    larger than a hundredth of the extent and than four times the spacing.
/// 3. The rectangle of smallest area around these points is the start. Each of its sides, without the tenth at either
///    end, is cut into strips. The outermost point of every strip is a border point.
/// 4. Random samples find, for each side, the line with the most border points within `tolerance` plus one spacing.
///    Least squares then fits the line to these points. A side is found if at least half of its strips are on the line.
/// 5. The border is beyond the outermost points. The line is moved outwards until the number of points within each
///    depth below it is that of a constant density.
/// 6. Neighbouring sides are intersected. With `sides`, the rectangle of this size that fits the intersections best
///    replaces them.
/// If a step fails, the points of the plane are left out and the next plane is tried, at most three planes in all. If
/// all fail, the error of the first one is thrown.
///
/// If the points form a grid with rows along the border, the border may lie anywhere within one spacing beyond the
/// outermost row. The corners are then half a spacing beyond that row.
///
/// Throws Error for
/// - fewer than 4 points, or NaN or infinite coordinates;
/// - a tolerance that is not above 0, a number of sides other than two, or a side that is not above 0;
/// - points of which no plane holds a tenth;
/// - a plane without four sides, or whose sides do not meet at right angles within 5 degrees;
/// - side lengths that differ from the given ones by more than two tolerances and two spacings;
/// - an upper side that cannot be decided.
///
/// Deterministic: the bytes depend on the seed, not on the number of threads. Cost: O(n log n); 50 bytes per point.
/// Metrics: `residual`, `flatness`, `side-1`, `side-2`, `plane-points`.
PlateCornersResult plate_corners(const PointCloud& cloud, const PlateCornersParams& params, Context& context);

}  // namespace scanmill
