// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Keeps the points of a cloud in a region: an axis-parallel box, a ball, or the neighbourhood of other points or of a
/// mesh. It serves to work on a part of a scan, and to remove points that do not belong to the object.

#include <optional>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/point_stream.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// Exactly one region is given: `box`, `centre` with `radius`, or `within`. Coordinates are those of the file: world
/// coordinates frame.origin + p, in the cloud's unit.
struct CropParams {
    /// Six lengths: x, y, z of the low corner, then x, y, z of the high corner. The box is closed; low <= high along
    /// every axis.
    std::optional<std::vector<Length>> box;
    /// Three lengths: x, y, z of the centre of a closed ball.
    std::optional<std::vector<Length>> centre;
    /// Radius of the ball, 0 or more.
    std::optional<Length> radius;
    /// Largest distance from `near` at which points are kept, 0 or more.
    std::optional<Length> within;
};

struct CropResult {
    /// The kept points in input order, with all columns, in the frame of the input.
    PointCloud points;
    /// Rows of the kept points in the input, ascending.
    Array<u32> kept;
    /// Number of points that are not kept.
    std::size_t removed = 0;
};

/// Keeps the points in the box or in the ball. A point on the border stays. Tests compare doubles: low <= frame.origin
/// + p <= high, and |frame.origin + p - centre|² <= radius², with rounded squares. The sum is exact for a scan as it
/// was read, and rounded for a scan that was moved to another origin. Every point is tested independently of the
/// others, also duplicates.
///
/// Throws Error in these cases:
/// - The cloud has no points, more than 2^32 - 1 points, or a NaN or infinite coordinate.
/// - None or several of the regions are given, or `centre` without `radius` or the reverse.
/// - `box` has not six lengths, or `centre` has not three.
/// - A length is not finite, a radius or distance is negative, or the low corner is above the high corner.
/// - `within` is given, because it needs `near`.
/// - No point is in the region. The message contains the distance of the nearest point and the box of the cloud.
///
/// Deterministic: the same bytes for any number of threads. Cost: O(n), about as fast as memory is read; 8 bytes per
/// kept point beside the result. Metrics: `kept`, `removed`.
CropResult crop(const PointCloud& cloud, const CropParams& params, Context& context);

/// Crops a file that is read in chunks and is never in memory as a whole. Result, metrics and errors are those of a
/// cloud in memory, bit for bit. The file is read three times: for its bounds when the stream is opened, for the
/// region, and at the kept rows. Lengths are resolved against scan.robust_box().
CropResult crop(const PointStream& scan, const CropParams& params, Context& context);

/// Keeps the points at a distance of at most `within` from `near`: from its nearest point, or from the nearest point of
/// one of its triangles. Squares of distances are compared. They are computed by TriangleTree, and equal those of an
/// exhaustive search bit for bit. If `near` has another origin than the cloud, its positions are shifted by the
/// difference first.
///
/// Throws Error as above. Throws Error also for a region other than `within`, and for a `near` without points or
/// triangles, with a NaN or infinite coordinate, or in another unit. An unknown unit differs from a known one.
///
/// Cost: O(n log m) for n points and the m points or triangles of `near`, if `within` is small beside the cloud; about
/// 110 bytes per point or triangle of `near`, and 8 per kept point, beside the result.
CropResult crop(const PointCloud& cloud, const PointCloud& near, const CropParams& params, Context& context);
CropResult crop(const PointCloud& cloud, const TriangleMesh& near, const CropParams& params, Context& context);

}  // namespace scanmill
