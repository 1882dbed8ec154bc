// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/outliers.hpp"

#include <algorithm>

#include "scanmill/base/statistics.hpp"
#include "scanmill/geometry/spatial/lists.hpp"

namespace scanmill::a_patches {

namespace {

constexpr double outlier = 3;  // times the median

}  // namespace

std::vector<double> outlier_distances(std::span<const double> distances, std::span<const u32> triangle_of_point,
                                      std::span<const std::array<u32, 3>> neighbours) {
    const Lists<double> by_triangle(neighbours.size(), [&](auto&& add) {
        for (std::size_t i = 0; i < distances.size(); ++i)
            if (distances[i] != no_distance) add(triangle_of_point[i], distances[i]);
    });
    std::vector<double> result(neighbours.size(), 0), near;
    for (u32 f = 0; f < neighbours.size(); ++f) {
        near.assign(by_triangle[f].begin(), by_triangle[f].end());
        for (const u32 g : neighbours[f])
            if (g < neighbours.size()) near.insert(near.end(), by_triangle[g].begin(), by_triangle[g].end());
        if (!near.empty()) result[f] = outlier * quantile(near, 0.5);
    }
    return result;
}

}  // namespace scanmill::a_patches
