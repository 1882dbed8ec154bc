// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A grid of voxels over a cloud. In each occupied voxel, the point nearest the centre is found. This is the main loop
/// of thinning, for points in memory and for points that are read in chunks.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/data/robust_box.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::voxel {

/// Voxel (i, j, k) holds the points p with (i, j, k) = floor((p - origin) / size). Its number counts (i, j, k) - first
/// row by row.
struct VoxelGrid {
    Vec3 origin;
    double size;
    Vec3 first;  // whole numbers
    std::array<u64, 3> voxels;

    u64 size_in_voxels() const { return voxels[0] * voxels[1] * voxels[2]; }
};

/// Returns the part of the grid that overlaps the box of all points. Pre: the box is finite, size above 0. Throws Error
/// for
/// - more than 2^21 voxels along an axis of the robust box (with the smallest size that fits);
/// - an origin or stray points more than 2^31 voxels away;
/// - stray points that need more than 2^63 voxels in all.
VoxelGrid grid_over(const RobustBox& box, const Vec3& origin, double size);

/// Points in order, in chunks that can be read one by one.
struct PointChunks {
    /// First row of every chunk, and the number of points as last element.
    std::vector<std::size_t> begin;
    /// Returns the points of a chunk. May fill and return `buffer` if they are not in memory. Called from several
    /// threads, each with its own buffer.
    std::function<std::span<const Vec3>(std::size_t chunk, Array<Vec3>& buffer)> read;

    std::size_t size() const { return begin.back(); }
};

struct KeptRows {
    /// Rows of the kept points, ascending.
    Array<u32> kept;
    /// Per kept row the number of points in its voxel; empty if they are not counted.
    Array<u32> members;
    /// Per kept row the edge of its voxel; empty if all are the grid's edge.
    Array<double> edges;
    std::size_t noise = 0;  ///< points in voxels with fewer than min_points
    std::size_t voxels = 0;  ///< number of occupied voxels
};

/// Finds the point nearest the centre of each occupied voxel.
/// Pre:  at least one point, all in the grid's box; fewer than 2^32.
/// Post: among equally near points, the first is kept. The result is the same for any division into chunks and any
///       number of threads.
/// Cost: O(n) time; 24 to 72 bytes per occupied voxel, an eighth of a byte per point (4 bytes more to count members),
///       and 32 bytes (48 if the grid has 2^32 voxels or more) per point of 16 chunks. Points that are read into
///       buffers take 24 bytes more per point of 16 chunks.
KeptRows nearest_to_centres(const PointChunks& points, const VoxelGrid& grid, u32 min_points, Context& context,
                            bool count_members = false);

}  // namespace scanmill::voxel
