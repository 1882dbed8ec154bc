// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Merges several clouds of one object: each is moved by its pose, and points are dropped where clouds overlap.
///
/// A scanner set up at ten positions gives ten clouds, often in ten coordinate systems. Poses that are off by a
/// fraction of the spacing leave several layers of one surface; `fuse` makes them one. Larger errors stay: clouds are
/// never registered here.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct MergeParams {
    enum class Prefer { none, lower_uncertainty };
    Prefer prefer = Prefer::none;
    /// Points of different inputs within this distance of each other overlap, and only one of them is kept; 0 keeps
    /// all.
    Length within;
    /// Clouds whose surfaces are at most this far apart become one layer (see fuse.hpp); 0 or more, in the unit of the
    /// clouds or in spacings (see fuse()). If absent, no point is moved.
    std::optional<Length> fuse;
    /// Uncertainty of points that have NaN in the column `uncertainty`, and of all points of an input without this
    /// column; 0 or more.
    std::optional<Length> default_uncertainty;
    /// Empty, or one pose per input, which maps its world coordinates (frame origin included) to those of the result. A
    /// pose of unknown unit is in the unit of the clouds.
    std::vector<RigidTransform> poses;
    /// Empty, or the number of each input in messages and in the column `source`; ascending. For callers that leave
    /// inputs out.
    std::vector<u32> numbers;
};

struct MergeResult {
    PointCloud points;
    /// Rows of the kept points, ascending. Rows are counted through all inputs, laid end to end.
    Array<u32> kept;
    /// kept + dropped = points of all inputs.
    std::size_t dropped = 0;
    /// Points of all inputs that fusing moved.
    std::size_t fused = 0;
};

/// The points of all inputs, in input order, without the dropped ones.
///
/// Fusing: see fuse.hpp, and fuse_points() in merge_steps.hpp for normals and directions. It comes before dropping, and
/// moves points that are dropped then, too. Columns stay as they are, also `normal` and `uncertainty`; the column
/// `moved` is added. A cloud alone gets a column of zeros.
///
/// Dropping: points are visited in the order of (preference, input, row). With lower_uncertainty, the preference is the
/// value in the column `uncertainty`, smaller values first. A point is dropped if a point of another input is at most
/// `within` away and was kept before. Distances are those in the coordinates of the result; squared distances, in
/// double, are compared with within². This has four consequences:

///  - Points of equal uncertainty are visited by input, then by row.
///  - Points of one input, including duplicates, never drop each other.
///  - Every dropped point has a kept point of another input within `within`.
///  - No two kept points of different inputs are within `within` of each other.
///
/// Columns: a column that all inputs have with equal shape is carried. If its types differ, it becomes float64, with a
/// warning. If some inputs lack a column of floating-point numbers, their rows have NaN, with a warning. A column is
/// left out, with a warning, in two cases: some input lacks it and its numbers are not floating-point; or inputs differ
/// in its number of components or in the type of its lists.
///
/// `normal` is rotated with the pose; it becomes float64 if it is neither float32 nor float64. With
/// `default_uncertainty`, the column `uncertainty` always exists and is a length; rows without a number have the
/// default.
///
/// The last column is the new column `source` (uint32). It contains the number of the point's input, counted from 0, or
/// that of `numbers`. An
/// existing column `source` is renamed `source-of-source`, an existing column `source-of-source` is renamed
/// `source-of-source-of-source`, and so on.
///
/// Frame: the unit is that of the inputs. Without poses, origin and name are those of the first input's frame, with a
/// warning about other names. With poses, the name is the one that the first pose leads to, and the origin is near the
/// points (see distant_origin()).
///
/// Throws Error for
///  - no inputs, an input without points, a NaN or infinite coordinate, more than 2^32 - 1 points;
///  - different units (also known and unknown), a pose in a known unit for clouds of an unknown unit;
///  - a negative or infinite `within`, `fuse` or default uncertainty;
///  - poses or numbers that are not one per input, numbers that do not ascend;
///  - moved points whose box is longer than 1e9 u;
///  - with lower_uncertainty: an input without a column `uncertainty` of one component, or with a NaN or a negative
///    number in it. A default replaces missing columns and NaN before this check.
///
/// Deterministic: the bytes are the same for any number of threads; only fusing uses several. Cost: O(n) time while
/// `within` is a few spacings. With a larger `within`, each point along the border of an overlap takes (within /
/// spacing)² time. Memory: beside the result about its size once more, and about 50 bytes per point if `within` > 0.
/// Metrics: `points`, `dropped`, with `fuse` also `fused`. Doubt: inputs whose surfaces cross others where they meet,
/// see frames_doubt().
MergeResult merge(std::span<const std::shared_ptr<const PointCloud>> inputs, const MergeParams& params,
                  Context& context);

}  // namespace scanmill
