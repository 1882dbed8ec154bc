// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/search_radii.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scanmill/filter/parallel.hpp"

namespace scanmill::growing {

namespace {

constexpr std::size_t counted_neighbours = 12;
constexpr double cubes_per_squared_bin = 1.5;

/// The bin whose thinning would put the place's last counted neighbour where it is.
double bin_at(const Samples& samples, const Neighbourhoods& neighbourhoods, u32 place) {
    const auto neighbours = neighbourhoods.of(place);
    const std::size_t count = std::min(counted_neighbours, neighbours.size());
    const double distance = (samples.positions[neighbours[count - 1]] - samples.positions[place]).norm();
    return distance * std::sqrt(std::numbers::pi * cubes_per_squared_bin / static_cast<double>(count));
}

}  // namespace

Array<double> density_radii(const Samples& samples, const Neighbourhoods& neighbourhoods, unsigned threads) {
    constexpr std::size_t chunk = 1 << 12;
    Array<double> bins(samples.size()), radii(samples.size());
    for_each_chunk(threads, samples.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t place = begin; place < end; ++place)
            bins[place] = bin_at(samples, neighbourhoods, static_cast<u32>(place));
    });
    for_each_chunk(threads, samples.size(), chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<double> near;
        for (std::size_t place = begin; place < end; ++place) {
            near.clear();
            for (u32 other : neighbourhoods.of(static_cast<u32>(place))) near.push_back(bins[other]);
            const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
            std::nth_element(near.begin(), middle, near.end());
            radii[place] = 2 * std::numbers::sqrt3 * std::min(bins[place], 1.15 * *middle);
        }
    });
    return radii;
}

}  // namespace scanmill::growing
