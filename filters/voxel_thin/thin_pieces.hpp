// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thinning, wherever the points are: what voxel_thin() does once bounds are known and points come in pieces.

#include "voxel_thin/nearest_rows.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::voxel {

/// Throws Error for what voxel_thin() refuses whatever the coordinates are.
void require_sound(std::size_t points, const VoxelThinParams& params);

/// Pre: sound; `box` are the bounds of all points, finite; `gather` gives the points of ascending rows.
VoxelThinResult thin(const PointPieces& points, const BoundingBox& box, const VoxelThinParams& params,
                     const std::function<PointCloud(std::span<const u32>)>& gather, Context& context);

}  // namespace scanmill::voxel
