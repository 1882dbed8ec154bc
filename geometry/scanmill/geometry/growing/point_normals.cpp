// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/point_normals.hpp"

#include <algorithm>
#include <array>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/fit/covariance.hpp"

namespace scanmill::growing {

namespace {

/// Number of neighbours. At a boundary all neighbours lie on one side; with so few, they still belong to the same
/// sheet.
constexpr std::size_t counted_neighbours = 12;

Scatter scatter_at(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, u32 point) {
    const auto near = neighbourhoods.of(point);
    const std::size_t count = std::min(counted_neighbours, near.size());
    std::array<Vec3, counted_neighbours + 1> offsets;
    offsets[0] = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) offsets[i + 1] = points.positions[near[i]] - points.positions[point];
    return scatter_of(std::span(offsets).first(count + 1));
}

}  // namespace

PointNormals principal_normals(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, unsigned threads) {
    PointNormals normals;
    normals.directions.resize(points.size());
    normals.variation.resize(points.size());
    for_each_chunk(threads, points.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t point = begin; point < end; ++point) {
            const Scatter scatter = scatter_at(points, neighbourhoods, static_cast<u32>(point));
            normals.directions[point] = scatter.normal;
            normals.variation[point] = static_cast<float>(scatter.surface_variation);
        }
    });
    return normals;
}

}  // namespace scanmill::growing
