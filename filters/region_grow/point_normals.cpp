// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/point_normals.hpp"

#include <algorithm>
#include <array>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/fit/covariance.hpp"

namespace scanmill::growing {

namespace {

/// So few that at a border, where they lie on one side, they still are of the same sheet.
constexpr std::size_t counted_neighbours = 12;

Scatter scatter_at(const Samples& samples, const Neighbourhoods& neighbourhoods, u32 place) {
    const auto near = neighbourhoods.of(place);
    const std::size_t count = std::min(counted_neighbours, near.size());
    std::array<Vec3, counted_neighbours + 1> offsets;
    offsets[0] = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) offsets[i + 1] = samples.positions[near[i]] - samples.positions[place];
    return scatter_of(std::span(offsets).first(count + 1));
}

}  // namespace

PointNormals principal_normals(const Samples& samples, const Neighbourhoods& neighbourhoods, unsigned threads) {
    PointNormals normals;
    normals.directions.resize(samples.size());
    normals.roughness.resize(samples.size());
    for_each_chunk(threads, samples.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t place = begin; place < end; ++place) {
            const Scatter scatter = scatter_at(samples, neighbourhoods, static_cast<u32>(place));
            normals.directions[place] = scatter.normal;
            normals.roughness[place] = static_cast<float>(scatter.roughness);
        }
    });
    return normals;
}

}  // namespace scanmill::growing
