// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/spacing_weights.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/point_tree.hpp"

namespace scanmill {

namespace {

constexpr std::size_t chunk = 1 << 12;
/// Of d²: at 1 a point may lie just at the border of its own power cell.
constexpr double most_of_distance = 0.9;

double mean_distance(const std::vector<double>& squares) {
    double sum = 0;
    for (double square : squares) sum += std::sqrt(square);
    return sum / static_cast<double>(squares.size());
}

/// Per place, the others that may forbid its weight.
using Pairs = std::vector<std::vector<u32>>;

/// One round of lowering: every weight to what the others' present weights allow. False when nothing changed.
bool lower_once(std::span<const Vec3> places, const Pairs& pairs, const Array<double>& weights, Array<double>& lowered,
                unsigned threads) {
    std::atomic<bool> changed = false;
    for_each_chunk(threads, places.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t place = begin; place < end; ++place) {
            double weight = weights[place];
            for (u32 other : pairs[place])
                weight =
                    std::min(weight, weights[other] + most_of_distance * (places[other] - places[place]).squaredNorm());
            lowered[place] = weight;
            if (weight < weights[place]) changed.store(true, std::memory_order_relaxed);
        }
    });
    return changed;
}

}  // namespace

Array<double> spacing_weights(std::span<const Vec3> positions, double factor, Context& context) {
    const PointTree tree(positions);
    const std::span<const Vec3> places = tree.places();
    context.progress(0.05);

    Array<double> weights(places.size());
    Pairs pairs(places.size());
    for_each_chunk(context.threads(), places.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
            const u32 place = static_cast<u32>(i);
            const double spacing = mean_distance(tree.nearest(place, spacing_neighbours));
            weights[place] = factor * (spacing * spacing);
            // Farther ones forbid nothing: no weight is below 0.
            pairs[place] = tree.within(place, weights[place] / most_of_distance);
        }
    });
    context.progress(0.2);

    // Weights only fall, and no order of lowering them leads elsewhere.
    Array<double> lowered(places.size());
    while (lower_once(places, pairs, weights, lowered, context.threads())) {
        context.check_cancelled();
        std::swap(weights, lowered);
    }
    context.progress(0.25);

    Array<double> per_row(positions.size());
    for (std::size_t row = 0; row < per_row.size(); ++row) per_row[row] = weights[tree.place_of_row()[row]];
    return per_row;
}

}  // namespace scanmill
