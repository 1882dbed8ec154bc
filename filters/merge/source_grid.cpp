// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge/source_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "scanmill/geometry/spatial/unit_scale.hpp"
#include "scanmill/geometry/size_limits.hpp"

namespace scanmill::merging {

namespace {

// With an empty layer of cells all around, three such numbers make one of 63 bits.
constexpr int bits_per_axis = 21;
constexpr double most_cells_per_axis = (1 << bits_per_axis) - 4;
// Larger than what rounding can do to a coordinate that is measured in cells.
constexpr double slack = 1 + 0x1p-20;

u64 key(u64 x, u64 y, u64 z) { return (((z << bits_per_axis) + y) << bits_per_axis) + x; }

}  // namespace

SourceGrid::SourceGrid(std::span<const Vec3> positions, std::span<const u32> source, double within)
    : positions_(positions),
      source_(source),
      scale_(unit_scale(within)),
      squared_distance_((within * scale_) * (within * scale_)),
      cells_(1024),
      next_row_(positions.size()) {
    const BoundingBox box = bounding_box(positions);
    require_finite_size(box);
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
                if (((positions_[other] - point) * scale_).squaredNorm() <= squared_distance_) return true;
        }
    return false;
}

}  // namespace scanmill::merging
