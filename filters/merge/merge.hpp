// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Several clouds of one object in one cloud: each moved by its pose, and thinned where they overlap.
///
/// What a scanner sees from ten places is ten clouds, often in ten coordinate systems. Here they become one, in which
/// every point knows where it came from. Points are never averaged or moved against each other: poses must be good.

#include <memory>
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
    /// Of points from different inputs that lie this near to each other one is kept; 0 keeps all.
    Length within;
    /// None, or one for every input: from its world coordinates (frame origin included) to those of the result.
    /// Of unknown unit: in that of the clouds.
    std::vector<RigidTransform> poses;
};

struct MergeResult {
    PointCloud points;
    /// Rows of the kept points in the inputs laid end to end, ascending.
    Array<u32> kept;
    /// kept + dropped = points of all inputs.
    std::size_t dropped = 0;
};

/// The points of all inputs, in input order, less those that give way.
///
/// Giving way: points are looked at in the order of (preference, input, row), where the preference is nothing or the
/// value in the column `uncertainty`, the smaller the earlier. A point is dropped when a point of another input that
/// was kept before lies at most `within` away (its squared distance, in double, is at most within²), in the result's
/// coordinates. So equal uncertainties are settled by the earlier input, then the earlier row; points of one input,
/// duplicates included, never drop each other; every dropped point has a kept one of another input within `within`;
/// and no two kept points of different inputs are that near.
///
/// Columns: those that all inputs have with equal shape are carried; types that differ become float64, and are told.
/// What some input lacks, has as lists of another type or with another number of components is left out, and told.
/// `normal` is turned with the pose (as float64 when it was neither float32 nor float64). A new column `source`, uint32
/// and last, says from which input a point is, counted from 0. An older `source` is carried as `source-of-source`, and
/// an older one of that name as `source-of-source-of-source`, and so on.
///
/// Frame: the inputs' unit. Without poses origin and name of the first input's frame, other names are told. With poses
/// the name that the first pose leads to, and an origin near the points (see distant_origin()).
///
/// Throws Error for no inputs, an input without points, a NaN or infinite coordinate, different units (also known and
/// unknown), more than 2^32 - 1 points, a negative or infinite `within`, another number of poses than of inputs, a
/// pose in a known unit for clouds of an unknown one, and, with lower_uncertainty, an input without a column
/// `uncertainty` of one component, or with a NaN or a negative number in it.
/// Deterministic: one thread does the work, so the same bytes for any number of them.
/// Cost: O(n) time while `within` is a few spacings; beyond, the points along the rim of an overlap cost
/// (within / spacing)² each. Beside the result about its size once more, and some 50 bytes per point when `within` > 0.
/// Metrics: `points`, `dropped`.
MergeResult merge(std::span<const std::shared_ptr<const PointCloud>> inputs, const MergeParams& params,
                  Context& context);

}  // namespace scanmill
