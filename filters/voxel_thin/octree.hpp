// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Thins with an octree instead of a grid. Its leaves are as large as all of their points allow.

#include <span>

#include "voxel_thin/voxel_grid.hpp"

namespace scanmill::voxel {

struct OctreeChoice {
    /// The kept rows, with members and edges of the leaves. `voxels` counts the occupied basic voxels. `noise` counts
    /// the points in basic voxels with fewer than min_points.
    KeptRows rows;
    /// Smallest and largest edge of leaves with more than one point, or `base` if there are none.
    double smallest = 0, largest = 0;
};

/// Basic voxels are the cells of edge `base` of the grid from `origin`. The octree joins eight of them into one, and
/// divides one into eight. Noise is decided in basic voxels, as in a grid of that edge: points of basic voxels with
/// fewer than `min_points` points are removed first. So a leaf may hold a single point whatever `min_points` is.
///
/// The root is the smallest cell that holds all points. A cell is divided while it holds more than one point and its
/// edge is above the smallest of its points' sizes, at most 21 times. Throws Error if that is not enough. In a leaf,
/// the point nearest the centre is kept; ties: the lowest row.
///
/// Pre: sizes[size_of_row[row]] is the size that a row allows, above 0.
/// Cost: a sort, and the depth of the tree in passes over the points; 16 bytes per point.
OctreeChoice choose_in_octree(std::span<const Vec3> positions, std::span<const u32> size_of_row,
                              std::span<const double> sizes, const Vec3& origin, double base, u32 min_points,
                              Context& context);

}  // namespace scanmill::voxel
