// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/flood.hpp"

#include <algorithm>
#include <cmath>

#include "alpha_solid/descending_queue.hpp"

namespace scanmill::alpha {

std::size_t Flood::outside_above(double value) const {
    return std::ranges::upper_bound(values, value, std::greater_equal<>()) - values.begin();
}

std::size_t Flood::group_begin(std::size_t index) const {
    while (index > 0 && values[index - 1] == values[index]) --index;
    return index;
}

namespace {

class Sweep {
public:
    Sweep(std::span<const SweepCell> cells, std::size_t points)
        : cells_(cells),
          seen_(cells.size()),
          cells_left_(points) {
        std::fill(seen_.begin(), seen_.end(), u8(0));
        std::fill(cells_left_.begin(), cells_left_.end(), 0);
        for (u32 c = 0; c < cells_.size(); ++c) {
            for (u32 corner : cells_[c].corners) ++cells_left_[corner];
            for (int i = 0; i < 4; ++i)
                if (cells_[c].neighbours[i] == TetMesh::outside_hull) queue_.push(cells_[c].values[i], c);
        }
    }

    Flood run(const FloodLimits& limits, Context& context) {
        Flood flood;
        flood.cells.reserve(cells_.size());
        flood.values.reserve(cells_.size());
        for (u32 cells : cells_left_) flood.points += cells > 0;
        // A share like 99.9 % of 1000 points is 999, whatever its last bit.
        const double share = limits.coverage * static_cast<double>(flood.points);
        flood.needed = static_cast<std::size_t>(std::max(1.0, std::ceil(share * (1 - 1e-12))));
        std::size_t covered = flood.points;
        const auto unseen = [&](u32 cell) { return std::exchange(seen_[cell], u8(1)) == 0; };
        u32 cell = 0;
        while (queue_.pop(cell, unseen)) {
            const double level = queue_.level();
            if (covered < flood.needed && level < limits.value && level < flood.values.back()) break;
            if (flood.cells.size() % 65536 == 0) context.check_cancelled();
            flood.cells.push_back(cell);
            flood.values.push_back(level);
            const SweepCell& swept = cells_[cell];
            for (u32 corner : swept.corners)
                if (--cells_left_[corner] == 0 && covered-- == flood.needed) flood.cover = level;
            for (int i = 0; i < 4; ++i) {
                const u32 across = swept.neighbours[i];
                if (across == TetMesh::outside_hull || seen_[across]) continue;
                __builtin_prefetch(&cells_[across]);
                queue_.push(std::min(level, swept.values[i]), across);
            }
        }
        return flood;
    }

private:
    std::span<const SweepCell> cells_;
    Array<u8> seen_;
    /// Per point: cells round it that the sweep has not reached.
    Array<u32> cells_left_;
    DescendingQueue queue_;
};

}  // namespace

Flood flood_from_outside(std::span<const SweepCell> cells, std::size_t points, const FloodLimits& limits,
                         Context& context) {
    return Sweep(cells, points).run(limits, context);
}

}  // namespace scanmill::alpha
