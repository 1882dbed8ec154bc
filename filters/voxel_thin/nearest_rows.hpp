// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Of the points in every occupied bin the one nearest the centre: the loop of thinning, for points in memory and for
/// points that are read piece by piece.

#include <functional>
#include <span>
#include <vector>

#include "scanmill/filter/context.hpp"
#include "voxel_thin/bin_grid.hpp"

namespace scanmill::voxel {

/// Points in order, cut into pieces that can be had one by one.
struct PointPieces {
    /// Where the pieces begin, and one more: the number of points.
    std::vector<std::size_t> begin;
    /// The points of a piece; `room` is the caller's, to be filled where they are not in memory already. Called from
    /// several threads, each with room of its own.
    std::function<std::span<const Vec3>(std::size_t piece, Array<Vec3>& room)> read;

    std::size_t points() const { return begin.back(); }
};

struct NearestRows {
    /// Ascending.
    Array<u32> kept;
    /// How many points share the bin of each of these; empty unless asked for.
    Array<u32> members;
    /// The edge of the bin of each of these; empty where all are the grid's.
    Array<double> edges;
    std::size_t noise = 0;  ///< points in bins with fewer than min_points
    std::size_t bins = 0;  ///< occupied
};

/// Pre: at least one point, all in the grid's box; fewer than 2^32.
/// Post: of equally near points the first; the same for any cut into pieces and any number of threads.
/// Cost: O(n) time; 24 to 72 bytes per occupied bin, an eighth of a byte per point (4 bytes more to count members), 32
/// bytes (48 where the grid has 2^32 bins or more) per point of 16 pieces, and 24 more when they are read into rooms.
NearestRows nearest_rows(const PointPieces& points, const BinGrid& grid, u32 min_points, Context& context,
                         bool count_members = false);

}  // namespace scanmill::voxel
