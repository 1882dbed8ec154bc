// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thinning by a grid of cubes: of the points in every occupied bin the one nearest the bin's centre stays.
///
/// Unlike centroid filters (which invent points) what is left is a subset of the scan, with every column; unlike a
/// random subset its density is even. Bin (i, j, k) of a grid with origin o and bin size B holds the points p with
/// i = floor((p.x - o.x) / B) and so on, in double arithmetic; its centre is o + ((i, j, k) + 1/2) B.

#include <optional>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/filter/quantity.hpp"

namespace scanmill {

struct VoxelThinParams {
    /// Edge of a bin, above 0; has no default.
    Length bin_size;
    /// Bins with fewer points are noise: none of their points is kept. 1 keeps all bins.
    u32 min_points = 1;
    /// The grid's origin is the bounding box's low corner minus this along every axis; 0 or more.
    Length margin;
    /// For programs: a grid of their own instead, relative to the cloud's frame; then `margin` is not used. Thinning a
    /// result again in the same grid changes nothing.
    std::optional<Vec3> grid_origin;
};

struct VoxelThinResult {
    /// The kept points in input order, every column carried along.
    PointCloud points;
    /// Their rows in the input, ascending.
    Array<u32> kept;
    Vec3 grid_origin;
    /// Points that gave way to another one of their bin, or that were noise: kept + removed = input.
    std::size_t removed = 0;
    /// The removed points whose bins had fewer than min_points.
    std::size_t noise = 0;
};

/// Keeps in every occupied bin the point whose squared distance to the centre, in double, is least; of equal ones that
/// of the lowest row. A duplicate counts as a point of its bin like any other.
///
/// Throws Error for an empty cloud, a NaN or infinite coordinate, a bin size not above 0, a negative margin,
/// min_points 0, more than 2^21 bins along an axis (naming the smallest size that fits), a grid origin more than 2^31
/// bins away, and when every point was noise.
/// Deterministic: the same bytes for any number of threads; without ties, the same set for any order of the input.
/// Cost: O(n) time; beside the result 24 to 72 bytes per occupied bin and at most 50 MB.
/// Metrics: `kept`, `removed`, `noise`.
/// Source: Wang 2006, chapter 3, for the rule of keeping; the bin size is given, not derived from a tolerance.
VoxelThinResult voxel_thin(const PointCloud& cloud, const VoxelThinParams& params, Context& context);

}  // namespace scanmill
