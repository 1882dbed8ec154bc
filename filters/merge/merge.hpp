// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Merges several clouds of one object: each is moved by its pose, and points are dropped where clouds overlap.
///
/// A scanner set up at ten positions gives ten clouds, often in ten coordinate systems. Points are never averaged
/// or moved against each other, so the poses must be accurate.

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
    /// Keeps one of the points of different inputs that lie within this distance of each other; 0 keeps all.
    Length within;
    /// Replaces NaN in the column `uncertainty`, and the column where an input lacks it; 0 or more.
    std::optional<Length> default_uncertainty;
    /// Empty, or one for every input: from its world coordinates (frame origin included) to those of the result. A pose
    /// of unknown unit is in the unit of the clouds.
    std::vector<RigidTransform> poses;
};

struct MergeResult {
    PointCloud points;
    /// Rows of the kept points in the inputs laid end to end, ascending.
    Array<u32> kept;
    /// kept + dropped = points of all inputs.
    std::size_t dropped = 0;
};

/// The points of all inputs, in input order, without the dropped ones.
///
/// Dropping: points are visited in the order of (preference, input, row), where the preference is absent or the value
/// in the column `uncertainty`, the smaller the earlier. A point is dropped when an earlier kept point of another input
/// is at most `within` away (its squared distance, in double, is at most within²), in the coordinates of the result. So
/// ties of uncertainty are decided by the earlier input, then the earlier row; points of one input, duplicates
/// included, never drop each other; every dropped point has a kept one of another input within `within`; and no two
/// kept points of different inputs are that near.
///
/// Columns: those that all inputs have with equal shape are carried; different types become float64, with a warning. A
/// column of floating-point numbers that some inputs lack has NaN in their rows, with a warning. Another column that
/// some input lacks, or that has another type of lists or another number of components, is left out, with a
/// warning. `normal` is rotated with the pose (as float64 when it was neither float32 nor float64). A new column
/// `source`, uint32 and last, contains the number of the point's input, counted from 0. An existing column `source` is
/// renamed `source-of-source`, an existing one of that name `source-of-source-of-source`, and so on. With
/// `default_uncertainty`, the column `uncertainty` is a length and always exists: rows without a number have the
/// default.
///
/// Frame: the inputs' unit. Without poses, the origin and name of the first input's frame, with a warning about other
/// names. With poses, the name that the first pose leads to, and an origin near the points (see distant_origin()).
///
/// Throws Error for no inputs, an input without points, a NaN or infinite coordinate, different units (also known and
/// unknown), more than 2^32 - 1 points, a negative or infinite `within`, another number of poses than of inputs, a
/// pose in a known unit for clouds of an unknown one, moved points whose box is longer than 1e9 u, a negative or
/// infinite default uncertainty, and, with lower_uncertainty, an input without a column `uncertainty` of one component,
/// or with a NaN or a negative number in it; a default replaces missing columns and NaN first. Deterministic: the work
/// is done on one thread, so the bytes are the same for any number of threads. Cost: O(n) time while `within` is a few
/// spacings; beyond, the points along the border of an overlap cost (within / spacing)² each. Beside the result about
/// its size once more, and some 50 bytes per point when `within` > 0. Metrics: `points`, `dropped`.
MergeResult merge(std::span<const std::shared_ptr<const PointCloud>> inputs, const MergeParams& params,
                  Context& context);

}  // namespace scanmill
