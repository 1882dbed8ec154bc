// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/cell_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace scanmill {

namespace {

constexpr int bits_per_axis = 21;  // three coordinates make a key of 63 bits
constexpr double middle = 1 << (bits_per_axis - 1), most_cells_per_axis = middle - 4;
// Exceeds 1 by more than the rounding error of a coordinate in units of cells.
constexpr double slack = 1 + 0x1p-20;

u64 key(u64 x, u64 y, u64 z) { return (((z << bits_per_axis) + y) << bits_per_axis) + x; }

}  // namespace

CellGrid::CellGrid(const Vec3& origin, double edge) : origin_(origin), edge_(edge), slots_(1024) {
    std::size_t next = 0;
    for (const int z : {0, -1, 1})
        for (const int y : {0, -1, 1})
            for (const int x : {0, -1, 1})
                neighbours_[next++] = key(static_cast<u64>(x), static_cast<u64>(y), static_cast<u64>(z));
}

CellGrid::CellGrid(const BoundingBox& box, double distance)
    : CellGrid(box.low, std::max(distance * slack, (box.high - box.low).maxCoeff() / most_cells_per_axis)) {}

u64 CellGrid::key_of(const Vec3& point) const {
    std::array<u64, 3> cell;
    for (int axis = 0; axis < 3; ++axis)
        cell[static_cast<std::size_t>(axis)] =
            static_cast<u64>(std::floor((point[axis] - origin_[axis]) / edge_) + middle);
    return key(cell[0], cell[1], cell[2]);
}

std::size_t CellGrid::slot_of(u64 key) const {
    // Fibonacci hashing: every bit of the key reaches the product's highest bits.
    std::size_t slot = key * 0x9e3779b97f4a7c15u >> (64 - std::countr_zero(slots_.size()));
    while (slots_[slot].number != none && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
    return slot;
}

u32 CellGrid::enter(const Vec3& point) {
    const u64 key = key_of(point);
    if (const Slot& slot = slots_[slot_of(key)]; slot.number != none) return slot.number;
    if (2 * (cells_ + std::size_t(1)) > slots_.size()) {
        std::vector<Slot> old(2 * slots_.size());
        old.swap(slots_);
        for (const Slot& slot : old)
            if (slot.number != none) slots_[slot_of(slot.key)] = slot;
    }
    slots_[slot_of(key)] = {key, cells_};
    return cells_++;
}

}  // namespace scanmill
