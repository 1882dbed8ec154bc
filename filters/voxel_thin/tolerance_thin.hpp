// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thinning by bins whose size follows from a tolerance: curvature first, then a grid or an octree.

#include "voxel_thin/nearest_rows.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::voxel {

/// Pre: voxel::require_sound(), and no bin size given; `pieces` and `box` are those of the cloud's positions, finite.
/// Throws Error as voxel_thin() does. Metrics: `smallest-radius`, `flat`, `undetermined` and those of every thinning;
/// of an octree also `smallest-bin` and `largest-bin`.
VoxelThinResult thin_within_tolerance(const PointCloud& cloud, const PointPieces& pieces, const BoundingBox& box,
                                      const VoxelThinParams& params, Context& context);

}  // namespace scanmill::voxel
