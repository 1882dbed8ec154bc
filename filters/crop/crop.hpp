// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Keeps the points of a cloud in a region: an axis-parallel box, a ball, or the neighbourhood of other points or of a
/// mesh. For work on a part of a scan, and to remove what a scan shows beside the object.

#include <optional>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/point_stream.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

/// Exactly one region: `box`, `centre` with `radius`, or `within`. Coordinates are those of the file: world coordinates
/// frame.origin + p, in the cloud's unit.
struct CropParams {
    /// Six: x, y, z of the low corner, then x, y, z of the high corner. The box is closed; low <= high along every
    /// axis.
    std::optional<std::vector<Length>> box;
    /// Three: x, y, z of the centre of a closed ball.
    std::optional<std::vector<Length>> centre;
    /// Radius of the ball, 0 or more.
    std::optional<Length> radius;
    /// Largest distance from `near` that is kept, 0 or more.
    std::optional<Length> within;
};

struct CropResult {
    /// The kept points in input order, with all columns, in the frame of the input.
    PointCloud points;
    /// Their rows in the input, ascending.
    Array<u32> kept;
    /// kept + removed = input.
    std::size_t removed = 0;
};

/// Keeps the points in the box or in the ball. A point on the border stays. Tests are exact comparisons of doubles:
/// low <= frame.origin + p <= high, and |frame.origin + p - centre|² <= radius², squares rounded. The sum is exact for
/// a scan as it was read; for one that was moved to another origin it is rounded. A point stays or goes whatever the
/// other points are, and duplicates count as points.
///
/// Throws Error for a cloud without points or with more than 2^32 - 1, a NaN or infinite coordinate; none or several of
/// the regions, a centre without radius or the reverse, another number of lengths than six or three, a length that is
/// not finite, a negative radius or distance, a low corner above the high one, `within`, which needs `near`; and if no
/// point is in the region, with the distance of the nearest one and the box of the cloud.
///
/// Deterministic: the same bytes for any number of threads. Cost: O(n), about as fast as memory is read; 8 bytes per
/// kept point beside the result. Metrics: `kept`, `removed`.
CropResult crop(const PointCloud& cloud, const CropParams& params, Context& context);

/// The same for a file that is read in chunks and never in memory as a whole: same result, bit for bit, same metrics
/// and refusals. The file is read once for its bounds (when the stream is opened), once for the region, and a third
/// time at the kept rows. Lengths are resolved against scan.robust_box().
CropResult crop(const PointStream& scan, const CropParams& params, Context& context);

/// Keeps the points at a distance of at most `within` from `near`: from its nearest point, or from the nearest point of
/// a triangle. Distances are those of TriangleTree, equal to a search over everything, bit for bit; squares are
/// compared. If `near` has another origin than the cloud, it is moved by the difference first.
///
/// Throws Error as above, and for a region other than `within`, a `near` without points or triangles or with a NaN or
/// infinite coordinate, or in another unit (an unknown unit differs from a known one).
///
/// Cost: O(n log m) for n points and the m points or triangles of `near`, if `within` is small beside the cloud; about
/// 110 bytes per point or triangle of `near`, and 8 per kept point, beside the result.
CropResult crop(const PointCloud& cloud, const PointCloud& near, const CropParams& params, Context& context);
CropResult crop(const PointCloud& cloud, const TriangleMesh& near, const CropParams& params, Context& context);

}  // namespace scanmill
