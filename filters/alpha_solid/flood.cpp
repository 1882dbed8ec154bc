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
        flood.needed = needed_points(limits.coverage, flood.points);
        covered_ = flood.points;
        const auto unseen = [&](u32 cell) { return std::exchange(seen_[cell], u8(1)) == 0; };
        const auto soon = [&](u32 cell) {
            __builtin_prefetch(&seen_[cell], 1);
            __builtin_prefetch(&cells_[cell]);
        };
        u32 cell = 0;
        while (queue_.pop(cell, unseen, soon)) {
            const double level = queue_.level();
            if (is_enough(flood, level, limits)) break;
            if (flood.cells.size() % 65536 == 0) context.check_cancelled();
            flood.cells.push_back(cell);
            flood.values.push_back(level);
            if (flood.cells.size() - counted_ == batch) count_covered(flood);
            const SweepCell& swept = cells_[cell];
            for (int i = 0; i < 4; ++i) {
                const u32 across = swept.neighbours[i];
                if (across == TetMesh::outside_hull || seen_[across]) continue;
                __builtin_prefetch(&cells_[across]);
                queue_.push(std::min(level, swept.values[i]), across);
            }
        }
        count_covered(flood);
        // Cells that came after alpha_cover was reached and before it was noticed.
        while (is_enough(flood, flood.values.back(), limits)) {
            flood.values.pop_back();
            flood.cells.pop_back();
        }
        return flood;
    }

private:
    /// A cell that enters at `level` need not be known.
    bool is_enough(const Flood& flood, double level, const FloodLimits& limits) const {
        return covered_ < flood.needed && level < limits.value && level < flood.cover;
    }

    /// Takes the swept cells from their points, a batch at a time so that the points' counters are fetched together.
    void count_covered(Flood& flood) {
        const std::span<const u32> cells = std::span(flood.cells).subspan(counted_);
        for (u32 cell : cells)
            for (u32 corner : cells_[cell].corners) __builtin_prefetch(&cells_left_[corner], 1);
        for (u32 cell : cells) {
            for (u32 corner : cells_[cell].corners)
                if (--cells_left_[corner] == 0) uncover_one(flood);
            ++counted_;
        }
    }

    /// A point has lost its last cell.
    void uncover_one(Flood& flood) {
        if (covered_ == flood.points) flood.cover_all = flood.values[counted_];
        if (covered_-- == flood.needed) flood.cover = flood.values[counted_];
    }

    static constexpr std::size_t batch = 32;

    std::span<const SweepCell> cells_;
    Array<u8> seen_;
    /// Per point: cells round it that the sweep has not reached.
    Array<u32> cells_left_;
    /// Points that still have cells left, once the first `counted_` cells of the flood are taken from them.
    std::size_t covered_ = 0, counted_ = 0;
    DescendingQueue queue_;
};

}  // namespace

std::size_t needed_points(double coverage, std::size_t points) {
    // A share like 99.9 % of 1000 points is 999, whatever its last bit.
    const double share = coverage * static_cast<double>(points);
    return static_cast<std::size_t>(std::max(1.0, std::ceil(share * (1 - 1e-12))));
}

Flood flood_from_outside(std::span<const SweepCell> cells, std::size_t points, const FloodLimits& limits,
                         Context& context) {
    return Sweep(cells, points).run(limits, context);
}

}  // namespace scanmill::alpha
