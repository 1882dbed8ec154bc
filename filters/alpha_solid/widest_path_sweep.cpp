// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/widest_path_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "alpha_solid/descending_queue.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/tets/circumspheres.hpp"

namespace scanmill::alpha {

std::size_t SweepResult::outside_above(double value) const {
    return std::ranges::upper_bound(values, value, std::greater_equal<>()) - values.begin();
}

std::size_t SweepResult::group_begin(std::size_t index) const {
    while (index > 0 && values[index - 1] == values[index]) --index;
    return index;
}

namespace {

/// `spheres(cell, facets)` returns a cell's CellSpheres. For facets outside the mask, the cell's contribution suffices.
template <class Spheres>
Array<SweepCell> sweep_cells_with(const TetMesh& tets, const Spheres& spheres, Context& context) {
    constexpr std::size_t chunk = 1 << 13;
    const std::size_t count = tets.cells.size();
    Array<SweepCell> cells(count);
    // If one of its two cells attaches a facet, that cell's contribution is the larger one.
    const auto join = [&](std::size_t c, int corner, u32 across) {
        SweepCell& other = cells[across];
        const auto back = std::ranges::find(other.neighbours, static_cast<u32>(c)) - other.neighbours.begin();
        double &mine = cells[c].values[corner], &its = other.values[back];
        mine = its = std::max(mine, its);
    };
    const bool is_serial = context.threads() <= 1;
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        const std::size_t first_known = is_serial ? 0 : begin;
        for (std::size_t c = begin; c < end; ++c) {
            const auto is_known = [&](int corner) {
                return tets.neighbours[c][corner] >= first_known && tets.neighbours[c][corner] < c;
            };
            unsigned unknown = 0;
            for (int corner = 0; corner < 4; ++corner) unknown |= unsigned(!is_known(corner)) << corner;
            cells[c] = {spheres(tets.cells[c], unknown).values, tets.cells[c], tets.neighbours[c]};
            for (int corner = 0; corner < 4; ++corner)
                if (is_known(corner)) join(c, corner, tets.neighbours[c][corner]);
        }
    });
    if (is_serial) return cells;
    // Joins facets between cells of different chunks, now that both cells are computed.
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t c = begin; c < end; ++c)
            for (int corner = 0; corner < 4; ++corner)
                if (const u32 across = tets.neighbours[c][corner]; across >= end && across != TetMesh::outside_hull)
                    join(c, corner, across);
    });
    return cells;
}

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

    SweepResult run(const SweepLimits& limits, Context& context) {
        SweepResult result;
        result.cells.reserve(cells_.size());
        result.values.reserve(cells_.size());
        for (u32 cells : cells_left_) result.points += cells > 0;
        result.needed = needed_points(limits.coverage, result.points);
        covered_ = result.points;
        const auto unseen = [&](u32 cell) { return std::exchange(seen_[cell], u8(1)) == 0; };
        const auto soon = [&](u32 cell) {
            __builtin_prefetch(&seen_[cell], 1);
            __builtin_prefetch(&cells_[cell]);
        };
        u32 cell = 0;
        while (queue_.pop(cell, unseen, soon)) {
            const double level = queue_.level();
            if (is_enough(result, level, limits)) break;
            if (result.cells.size() % 65536 == 0) context.check_cancelled();
            result.cells.push_back(cell);
            result.values.push_back(level);
            if (result.cells.size() - counted_ == batch) count_covered(result);
            const SweepCell& swept = cells_[cell];
            for (int i = 0; i < 4; ++i) {
                const u32 across = swept.neighbours[i];
                if (across == TetMesh::outside_hull || seen_[across]) continue;
                __builtin_prefetch(&cells_[across]);
                queue_.push(std::min(level, swept.values[i]), across);
            }
        }
        count_covered(result);
        // Removes the cells that were swept between reaching alpha_cover and the next count.
        while (is_enough(result, result.values.back(), limits)) {
            result.values.pop_back();
            result.cells.pop_back();
        }
        return result;
    }

private:
    /// Whether the sweep can end before the cells that enter at `level`.
    bool is_enough(const SweepResult& result, double level, const SweepLimits& limits) const {
        return covered_ < result.needed && level < limits.value && level < result.cover;
    }

    /// Subtracts the swept cells from their points' counts, a batch at a time so that the counts are fetched together.
    void count_covered(SweepResult& result) {
        const std::span<const u32> cells = std::span(result.cells).subspan(counted_);
        for (u32 cell : cells)
            for (u32 corner : cells_[cell].corners) __builtin_prefetch(&cells_left_[corner], 1);
        for (u32 cell : cells) {
            for (u32 corner : cells_[cell].corners)
                if (--cells_left_[corner] == 0) uncover_one(result);
            ++counted_;
        }
    }

    /// Must be called when a point has lost its last cell.
    void uncover_one(SweepResult& result) {
        if (covered_ == result.points) result.cover_all = result.values[counted_];
        if (covered_-- == result.needed) result.cover = result.values[counted_];
    }

    static constexpr std::size_t batch = 32;

    std::span<const SweepCell> cells_;
    Array<u8> seen_;
    /// Per point: the number of its cells that are not subtracted yet.
    Array<u32> cells_left_;
    /// Number of points that still have cells after the first `counted_` cells of the result were subtracted.
    std::size_t covered_ = 0, counted_ = 0;
    DescendingQueue queue_;
};

}  // namespace

Array<SweepCell> sweep_cells(const TetMesh& tets, Context& context) {
    const auto unweighted = [&](const Tetrahedron& cell, unsigned) {
        const auto& [i, j, k, l] = cell;
        return cell_spheres(tets.positions[i], tets.positions[j], tets.positions[k], tets.positions[l]);
    };
    if (tets.weights.empty()) return sweep_cells_with(tets, unweighted, context);
    if (tets.weights.size() != tets.positions.size())
        throw Error("needs a weight for each of {} vertices, or no weights; there are {}", tets.positions.size(),
                    tets.weights.size())
            .hint("'delaunay: {weights: …}' gives every vertex a weight");
    const auto [least, largest] = std::ranges::minmax(tets.weights);
    if (!(least < largest)) return sweep_cells_with(tets, unweighted, context);
    const auto weighted = [&tets, largest = largest](const Tetrahedron& cell, unsigned facets) {
        std::array<WeightedPoint, 4> corners;
        for (int i = 0; i < 4; ++i) corners[i] = {&tets.positions[cell[i]], tets.weights[cell[i]]};
        return weighted_cell_spheres(corners, largest, facets);
    };
    return sweep_cells_with(tets, weighted, context);
}

std::size_t needed_points(double coverage, std::size_t points) {
    // Rounding errors must not turn a share like 99.9 % of 1000 points into more than 999.
    const double share = coverage * static_cast<double>(points);
    return static_cast<std::size_t>(std::max(1.0, std::ceil(share * (1 - 1e-12))));
}

SweepResult sweep_from_outside(std::span<const SweepCell> cells, std::size_t points, const SweepLimits& limits,
                               Context& context) {
    return Sweep(cells, points).run(limits, context);
}

}  // namespace scanmill::alpha
