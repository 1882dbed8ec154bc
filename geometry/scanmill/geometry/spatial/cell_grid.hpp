// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A hash table of the occupied cubic cells of a grid, for searches among points within a fixed distance.

#include <array>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/bounds.hpp"

namespace scanmill {

/// Numbers cells in the order in which they are entered. Callers store the contents of cells under these numbers.
class CellGrid {
public:
    /// Cell (i, j, k) contains the points with floor((p - origin) / edge) = (i, j, k). Pre: edge > 0; i, j and k of all
    /// points are between -2^20 + 1 and 2^20 - 1.
    CellGrid(const Vec3& origin, double edge);
    /// A grid for points in the box: two points that are at most `distance` apart are in one cell or in cells that
    /// touch. Pre: distance > 0.
    CellGrid(const BoundingBox& box, double distance);

    /// Returns the number of the point's cell. The number is new if no earlier point was in the cell.
    u32 enter(const Vec3& point);

    /// Whether is_found(number) is true for the point's cell or for an entered cell that touches it. Calls is_found for
    /// the point's cell first, and stops when it returns true.
    template <class IsFound>
    bool any_near(const Vec3& point, IsFound&& is_found) const {
        const u64 own = key_of(point);
        for (const u64 step : neighbours_)
            if (const Slot& slot = slots_[slot_of(own + step)]; slot.number != none && is_found(slot.number))
                return true;
        return false;
    }

private:
    static constexpr u32 none = ~u32(0);
    struct Slot {
        u64 key;
        u32 number = none;
    };

    u64 key_of(const Vec3& point) const;
    /// The slot of the key or, if it is absent, the free slot for it.
    std::size_t slot_of(u64 key) const;

    Vec3 origin_;
    double edge_;
    std::array<u64, 27> neighbours_;  ///< differences between the keys of a cell and those that touch it
    std::vector<Slot> slots_;  ///< open addressing; the size is a power of two
    u32 cells_ = 0;
};

}  // namespace scanmill
