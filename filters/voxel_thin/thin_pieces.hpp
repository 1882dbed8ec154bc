// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thinning, wherever the points are: what voxel_thin() does once bounds are known and points come in pieces.

#include "voxel_thin/nearest_rows.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::voxel {

/// Throws Error for what voxel_thin() refuses whatever the coordinates are.
void require_sound(std::size_t points, const VoxelThinParams& params);

/// At a given bin size; throws Error when it is to be derived.
/// Pre: sound; `box` are the bounds of all points, finite; `gather` gives the points of ascending rows.
VoxelThinResult thin(const PointPieces& points, const BoundingBox& box, const VoxelThinParams& params,
                     const std::function<PointCloud(std::span<const u32>)>& gather, Context& context);

// What thinning within a tolerance does alike.

Vec3 grid_origin(const BoundingBox& box, const VoxelThinParams& params);
/// Throws Error when all points were noise.
void require_some(const NearestRows& rows, std::size_t points, u32 min_points);
/// Puts the rows into the result and the bins' sizes into its points, and tells the metrics that every thinning has.
void finish(VoxelThinResult& result, NearestRows rows, std::size_t points, Context& context);

}  // namespace scanmill::voxel
