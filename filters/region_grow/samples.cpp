// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/samples.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/data/points.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill::growing {

namespace {

bool comes_before(const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// spatial_order() leaves points of one cell of the curve in the order of their rows; here they get one by place.
void order_within_cells(std::span<const Vec3> positions, const BoundingBox& box, Array<u32>& order) {
    constexpr double steps = (1 << 21) - 1;
    const double extent = (box.high - box.low).maxCoeff();
    const auto share_cell = [&](u32 a, u32 b) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto cell = [&](u32 row) {
                return extent > 0 ? std::floor((positions[row][axis] - box.low[axis]) / extent * steps) : 0;
            };
            if (cell(a) != cell(b)) return false;
        }
        return true;
    };
    for (std::size_t begin = 0; begin < order.size();) {
        std::size_t end = begin + 1;
        while (end < order.size() && share_cell(order[begin], order[end])) ++end;
        if (end - begin > 1)
            std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin),
                      order.begin() + static_cast<std::ptrdiff_t>(end), [&](u32 a, u32 b) {
                          return positions[a] != positions[b] ? comes_before(positions[a], positions[b]) : a < b;
                      });
        begin = end;
    }
}

}  // namespace

Samples distinct_samples(std::span<const Vec3> positions) {
    Samples samples;
    Array<u32> order = spatial_order(positions);
    order_within_cells(positions, bounding_box(positions), order);

    samples.positions.reserve(order.size());
    samples.rows.reserve(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && positions[order[i]] == positions[order[i - 1]]) {
            samples.repeats.push_back({static_cast<u32>(samples.rows.size() - 1), order[i]});
            continue;
        }
        samples.positions.push_back(positions[order[i]]);
        samples.rows.push_back(order[i]);
    }
    return samples;
}

}  // namespace scanmill::growing
