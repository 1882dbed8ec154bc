// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A growing set of points that answers: is one of another source within a fixed distance of this one?

#include <span>
#include <vector>

#include "scanmill/data/points.hpp"

namespace scanmill::merging {

/// Cubes a little larger than the distance, so that neighbours lie in the same or a touching cube; only occupied ones
/// are stored. The points of a cube are kept apart by source, so that those of the own source cost nothing.
class SourceGrid {
public:
    /// The set is empty. `positions` and `source` must outlive it. Pre: within > 0. Throws Error for
    /// positions farther apart than any number.
    SourceGrid(std::span<const Vec3> positions, std::span<const u32> source, double within);

    void insert(u32 row);
    /// Whether a point in the set of another source than `row` has a squared distance of at most within² to it.
    bool has_foreign_neighbour(u32 row) const;

private:
    static constexpr u32 none = ~u32(0);
    struct Cell {
        u64 key;
        u32 first_group = none;  ///< none: the slot is free
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
    double scale_;  ///< a power of two that brings `within` near 1, so that squares are numbers
    double squared_distance_;  ///< scaled
    double cell_size_;
    Vec3 low_;
    std::vector<u64> neighbours_;  // differences of keys, the cell itself first
    std::vector<Cell> cells_;  // open addressing; the size is a power of two
    std::size_t cells_used_ = 0;
    std::vector<Group> groups_;
    Array<u32> next_row_;
};

}  // namespace scanmill::merging
