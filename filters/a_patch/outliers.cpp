// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/outliers.hpp"

#include <algorithm>

namespace scanmill::a_patches {

namespace {

constexpr double outlier = 3;  // times the median

/// The lower one of two in the middle; 0 of none.
double median(std::vector<double>& values) {
    std::erase(values, no_distance);
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

}  // namespace

std::vector<double> outlier_distances(std::span<const double> distances, std::span<const u32> triangle_of_point,
                                      std::span<const std::array<u32, 3>> neighbours) {
    std::vector<std::size_t> first(neighbours.size() + 1, 0);
    for (const u32 f : triangle_of_point) ++first[f + 1];
    for (std::size_t f = 0; f < neighbours.size(); ++f) first[f + 1] += first[f];
    std::vector<double> ordered(distances.size()), result(neighbours.size()), near;
    std::vector<std::size_t> next = first;
    for (std::size_t i = 0; i < distances.size(); ++i) ordered[next[triangle_of_point[i]]++] = distances[i];
    for (u32 f = 0; f < neighbours.size(); ++f) {
        near.clear();
        const auto add = [&](u32 of) {
            const auto begin = ordered.begin();
            near.insert(near.end(), begin + static_cast<std::ptrdiff_t>(first[of]),
                        begin + static_cast<std::ptrdiff_t>(first[of + 1]));
        };
        add(f);
        for (const u32 g : neighbours[f])
            if (g < neighbours.size()) add(g);
        result[f] = outlier * median(near);
    }
    return result;
}

}  // namespace scanmill::a_patches
