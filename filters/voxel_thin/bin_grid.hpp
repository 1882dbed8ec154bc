// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The grid of bins over a cloud, and where in it a point lies.

#include "scanmill/data/points.hpp"
#include "voxel_thin/bin_table.hpp"

namespace scanmill::voxel {

/// Bin (i, j, k) holds floor((p - origin) / size); its number is (i, j, k) - first, counted row by row.
struct BinGrid {
    Vec3 origin;
    double size;
    Vec3 first;  // whole numbers
    std::array<u64, 3> bins;

    u64 size_in_bins() const { return bins[0] * bins[1] * bins[2]; }
};

/// The part of the grid that `box` touches. Pre: the box is finite, size above 0. Throws Error for more than 2^21 bins
/// along an axis (naming the smallest size that fits) and for an origin more than 2^31 bins away.
BinGrid grid_over(const BoundingBox& box, const Vec3& origin, double size);

/// The point's bin and its squared distance to the bin's centre. Pre: it lies in the grid's box.
template <class Bin>
Candidate<Bin> located(const Vec3& point, u32 row, const BinGrid& grid) {
    u64 number = 0;
    double distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double quotient = (point[axis] - grid.origin[axis]) / grid.size;
        // Rounding towards zero and correcting below: floor without SSE4's instruction. Fits: see grid_over.
        const double whole = static_cast<double>(static_cast<std::int32_t>(quotient));
        const double bin = whole > quotient ? whole - 1 : whole;
        const double offset = point[axis] - (grid.origin[axis] + (bin + 0.5) * grid.size);
        distance += offset * offset;
        number = number * grid.bins[axis] + static_cast<u64>(static_cast<std::int64_t>(bin - grid.first[axis]));
    }
    return {distance, static_cast<Bin>(number), row};
}

}  // namespace scanmill::voxel
