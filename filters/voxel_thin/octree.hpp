// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thinning by an octree instead of a grid: bins as large as every point in them allows.

#include <span>

#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::voxel {

struct OctreeChoice {
    /// Ascending rows; how many points the leaf of each has, and its edge.
    Array<u32> kept, members;
    Array<double> edges;
    /// Occupied cells of edge `base`, and the points in those of them that hold fewer than min_points.
    std::size_t basic_voxels = 0, noise = 0;
    double smallest = 0, largest = 0;  ///< edges of leaves with more than one point, or `base` when there are none
};

/// The root is the smallest cell that holds all points of the grids that begin at `origin` and whose edges are `base`
/// times a power of two. A cell is cut into eight while it holds more than one point and its edge is larger than the
/// least of its points' sizes, at most 21 times; throws Error when that does not suffice. Of the points in a leaf the
/// nearest to the leaf's centre stays, ties by row.
/// Noise is decided before any cell is cut, as in a grid of edge `base`: points of cells of that edge that hold fewer
/// than `min_points` are removed first. A leaf may hold a single point however large `min_points` is.
/// Pre: sizes[size_of_row[row]] is what a row allows, above 0; no position below `origin`.
/// Cost: a sort, and the depth of the tree in passes over the points; 16 bytes per point.
OctreeChoice choose_in_octree(std::span<const Vec3> positions, std::span<const u32> size_of_row,
                              std::span<const double> sizes, const Vec3& origin, double base, u32 min_points,
                              Context& context);

}  // namespace scanmill::voxel
