// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The larger steps of merge(): the columns of the result, the fusing of clouds that lie a little apart, the choice of
/// the points that are kept where clouds overlap, and the check that the clouds lie in one frame. The rules are in
/// merge.hpp.

#include <memory>
#include <span>
#include <string>

#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::merging {

/// The cloud with a column `uncertainty` of lengths. NaN in an existing column becomes `value`. A missing column is
/// added, with `value` in all rows and of type `type` (float32 or float64). A column of lists or of several components
/// stays as it is.
PointCloud with_default_uncertainty(const PointCloud& cloud, ScalarType type, double value);

/// The columns of the clouds, end to end, in the order in which their names first appear, `source` last. Warns about
/// every column that is left out or changed. `numbers`: the number of each cloud, for `source` and messages, ascending;
/// empty: 0, 1, 2, … Pre: at least one cloud; `poses` is empty or as long as `clouds`.
ColumnTable merged_columns(std::span<const std::shared_ptr<const PointCloud>> clouds,
                           std::span<const RigidTransform> poses, std::span<const u32> numbers, Context& context);

/// Rows that are kept, ascending; all rows if `within` is 0. `source`: the number of each row's cloud; rows are ordered
/// by cloud. `preference`: empty, or a number for each row; smaller is better.
Array<u32> without_overlap(std::span<const Vec3> positions, std::span<const u32> source,
                           std::span<const double> preference, double within, Context& context);

/// Moves the points of registered clouds onto one layer where they overlap (see fuse.hpp), and adds the column `moved`:
/// float32, a length, the distance that a point moved. An older column of that name is replaced, with a warning.
/// Returns the number of points that moved.
///
/// Normals are the column `normal` if all clouds have it, with three numbers; otherwise they are estimated and turned
/// to the scanner. Its direction is the column `approach`; where that is missing or not finite, +z of the cloud's own
/// frame, with a warning if it decides the side of normals. Without poses this is +z of the common frame, which does
/// not weigh the points. `all`: the clouds, end to end; `numbers`: as above, one per cloud.
std::size_t fuse_points(PointCloud& all, std::span<const std::shared_ptr<const PointCloud>> clouds,
                        std::span<const RigidTransform> poses, std::span<const u32> numbers, const Length& length,
                        Context& context);

/// Why clouds probably do not lie in one frame, with the worst pairs; empty without such a reason. Arguments as above.
///
/// Where surfaces of two clouds in one frame are near each other, they are the same surface, so they are parallel, or
/// one of them ends there. In different frames they cross. Points of a random sample count where both clouds have a
/// flat patch around the point; see one_frame.cpp for the limits. A cloud is off if it crosses others at more points
/// than it is parallel to them. Clouds that do not meet are not doubted. Cost: about a second for 20 clouds of any
/// size; of more than 64 clouds, 64 are compared.
std::string frames_doubt(std::span<const Vec3> positions, std::span<const u32> source, Context& context);

}  // namespace scanmill::merging
