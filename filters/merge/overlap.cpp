// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <numeric>
#include <vector>

#include "merge/merge_steps.hpp"

namespace scanmill::merging {

namespace {

// With an empty layer of cells all around, three such numbers make one of 63 bits.
constexpr int bits_per_axis = 21;
constexpr double most_cells_per_axis = (1 << bits_per_axis) - 4;
// Larger than what rounding can do to a coordinate that is measured in cells.
constexpr double slack = 1 + 0x1p-20;

u64 key(u64 x, u64 y, u64 z) { return (((z << bits_per_axis) + y) << bits_per_axis) + x; }

/// A growing set of points that answers whether one of another source is within a fixed distance.
///
/// A grid of cubes slightly larger than the distance, so that neighbours lie in the same or a touching cube; only
/// occupied cubes are stored. The points of a cube are grouped by source, so that those of the own source cost no time.
class SourceGrid {
public:
    /// The set is empty at first. `positions` and `source` must outlive it. Pre: within > 0.
    SourceGrid(std::span<const Vec3> positions, std::span<const u32> source, double within);

    void insert(u32 row);
    /// Whether a point in the set of another source than `row` has a squared distance of at most within² to it.
    bool has_foreign_neighbour(u32 row) const;

private:
    static constexpr u32 none = ~u32(0);
    struct Cell {
        u64 key;
        u32 first_group = none;  ///< none when the slot is free
    };
    /// The points of one source in one cell, chained through next_row_.
    struct Group {
        u32 source, first_row, next_group;
    };

    u64 key_of(const Vec3& point) const;
    /// The slot of the key, or the free one where it would be.
    std::size_t slot_of(u64 key) const;
    void grow();

    std::span<const Vec3> positions_;
    std::span<const u32> source_;
    double squared_distance_;
    double cell_size_;
    Vec3 low_;
    std::vector<u64> neighbours_;  // differences of keys, the cell itself first
    std::vector<Cell> cells_;  // open addressing; the size is a power of two
    std::size_t cells_used_ = 0;
    std::vector<Group> groups_;
    Array<u32> next_row_;
};

SourceGrid::SourceGrid(std::span<const Vec3> positions, std::span<const u32> source, double within)
    : positions_(positions),
      source_(source),
      squared_distance_(within * within),
      cells_(1024),
      next_row_(positions.size()) {
    const BoundingBox box = bounding_box(positions);
    const double extent = (box.high - box.low).maxCoeff();
    low_ = box.low;
    cell_size_ = std::max(within * slack, extent / most_cells_per_axis);
    for (int z : {0, -1, 1})
        for (int y : {0, -1, 1})
            for (int x : {0, -1, 1})
                neighbours_.push_back(key(static_cast<u64>(x), static_cast<u64>(y), static_cast<u64>(z)));
}

u64 SourceGrid::key_of(const Vec3& point) const {
    u64 cell[3];
    for (int axis = 0; axis < 3; ++axis) cell[axis] = 1 + static_cast<u64>((point[axis] - low_[axis]) / cell_size_);
    return key(cell[0], cell[1], cell[2]);
}

std::size_t SourceGrid::slot_of(u64 key) const {
    // Fibonacci hashing: every bit of the key reaches the product's highest bits.
    std::size_t slot = key * 0x9e3779b97f4a7c15u >> (64 - std::countr_zero(cells_.size()));
    while (cells_[slot].first_group != none && cells_[slot].key != key) slot = (slot + 1) & (cells_.size() - 1);
    return slot;
}

void SourceGrid::grow() {
    std::vector<Cell> old(2 * cells_.size());
    old.swap(cells_);
    for (const Cell& cell : old)
        if (cell.first_group != none) cells_[slot_of(cell.key)] = cell;
}

void SourceGrid::insert(u32 row) {
    if (2 * (cells_used_ + 1) > cells_.size()) grow();
    Cell& cell = cells_[slot_of(key_of(positions_[row]))];
    if (cell.first_group == none) {
        cell.key = key_of(positions_[row]);
        ++cells_used_;
    }
    u32 group = cell.first_group;
    while (group != none && groups_[group].source != source_[row]) group = groups_[group].next_group;
    if (group == none) {
        group = static_cast<u32>(groups_.size());
        groups_.push_back({source_[row], none, cell.first_group});
        cell.first_group = group;
    }
    next_row_[row] = groups_[group].first_row;
    groups_[group].first_row = row;
}

bool SourceGrid::has_foreign_neighbour(u32 row) const {
    const Vec3& point = positions_[row];
    const u64 own_cell = key_of(point);
    for (const u64 step : neighbours_)
        for (u32 group = cells_[slot_of(own_cell + step)].first_group; group != none;
             group = groups_[group].next_group) {
            if (groups_[group].source == source_[row]) continue;
            for (u32 other = groups_[group].first_row; other != none; other = next_row_[other])
                if ((positions_[other] - point).squaredNorm() <= squared_distance_) return true;
        }
    return false;
}

}  // namespace

Array<u32> without_overlap(std::span<const Vec3> positions, std::span<const u32> source,
                           std::span<const double> preference, double within, Context& context) {
    Array<u32> rows(positions.size());
    std::iota(rows.begin(), rows.end(), u32(0));
    if (within == 0) {
        if (!preference.empty()) context.warn("lower-uncertainty has no effect while `within` is 0");
        return rows;
    }
    if (!preference.empty()) std::ranges::stable_sort(rows, {}, [&](u32 row) { return preference[row]; });

    SourceGrid kept(positions, source, within);
    constexpr std::size_t rows_per_report = 1 << 16;
    std::size_t visited = 0;
    std::erase_if(rows, [&](u32 row) {
        if (visited++ % rows_per_report == 0) {
            context.check_cancelled();
            context.progress(static_cast<double>(visited) / static_cast<double>(positions.size()));
        }
        if (kept.has_foreign_neighbour(row)) return true;
        kept.insert(row);
        return false;
    });
    std::ranges::sort(rows);
    return rows;
}

}  // namespace scanmill::merging
