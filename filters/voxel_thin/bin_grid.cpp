// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/bin_grid.hpp"

#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill::voxel {

namespace {

constexpr double most_bins_per_axis = 1 << 21;  // three such numbers make one of 63 bits
constexpr double farthest_bin = 0x1p31;

}  // namespace

BinGrid grid_over(const BoundingBox& box, const Vec3& origin, double size) {
    BinGrid grid{origin, size, Vec3::Zero(), {}};
    for (int axis = 0; axis < 3; ++axis) {
        const double first = std::floor((box.low[axis] - grid.origin[axis]) / size);
        const double last = std::floor((box.high[axis] - grid.origin[axis]) / size);
        if (!(last - first < most_bins_per_axis))
            throw Error(
                "bins of {} u cut the cloud's extent of {:.6g} u along {} into {:.8g}; at most {} bins are possible",
                size, box.high[axis] - box.low[axis], "xyz"[axis], last - first + 1, most_bins_per_axis)
                .hint(fmt::format("bins of {:.6g} u and larger fit this cloud",
                                  (box.high - box.low).maxCoeff() / (most_bins_per_axis - 2)));
        if (!(std::max(std::abs(first), std::abs(last)) < farthest_bin))
            throw Error(
                "the grid's origin lies {:.6g} bins of {} u away from the cloud along {}; at most {} are possible",
                std::max(std::abs(first), std::abs(last)), size, "xyz"[axis], farthest_bin)
                .hint("lessen the margin, or choose a grid origin nearer the cloud");
        grid.first[axis] = first;
        grid.bins[axis] = static_cast<u64>(last - first) + 1;
    }
    return grid;
}

}  // namespace scanmill::voxel
