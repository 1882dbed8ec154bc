// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/neighbourhoods.hpp"

#include <algorithm>
#include <limits>

namespace scanmill::growing {

namespace {

constexpr std::size_t most_neighbours = 16;

}  // namespace

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
