// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/distinct_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

constexpr std::size_t most_neighbours = 16;

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

Neighbourhoods::Neighbourhoods(const Samples& samples, unsigned threads)
    : tree_(samples.positions, threads),
      count_(std::min(most_neighbours, samples.size() - 1)),
      sample_of_place_(samples.size()),
      nearest_(samples.size() * count_),
      squared_reach_(samples.size()) {
    const auto places = tree_.place_of_row();
    for (u32 sample = 0; sample < places.size(); ++sample) sample_of_place_[places[sample]] = sample;
    const bool all = count_ + 1 == samples.size();
    tree_.for_each_nearest(count_, threads, [&](const NeighbourBatch& batch) {
        for (std::size_t i = 0; i < batch.places.size(); ++i) {
            const u32 sample = sample_of_place_[batch.places[i]];
            u32* nearest = nearest_.data() + sample * count_;
            for (const Neighbour& neighbour : batch.of(i)) *nearest++ = sample_of_place_[neighbour.place];
            squared_reach_[sample] = all ? std::numeric_limits<double>::infinity() : batch.of(i).back().squared;
        }
    });
}

void Neighbourhoods::within(u32 place, double squared, NeighbourBuffer& buffer, std::vector<u32>& found) const {
    for (const Neighbour& neighbour : tree_.within(tree_.place_of_row()[place], squared, buffer))
        found.push_back(sample_of_place_[neighbour.place]);
}

}  // namespace scanmill::growing
