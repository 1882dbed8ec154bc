// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds equal positions. Used to turn a soup of triangles into an indexed mesh and to find positions that rounding
/// makes equal.

#include <bit>
#include <cstring>

#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

/// Gives equal positions one number.
///
/// Positions are equal if their bits are equal; -0 is equal to +0. Positions that are only near each other are not
/// merged. Numbers are in order of first appearance. Cost: one hash-table look-up per position (open addressing, at
/// most half full), about 40 bytes per number.
class PositionMerger {
public:
    /// `expected` is the expected number of different positions. A wrong guess only costs time.
    explicit PositionMerger(std::size_t expected) {
        const std::size_t guess = expected + 16;
        positions.reserve(guess);
        slots_.assign(std::bit_ceil(2 * guess), Slot{});
    }

    /// The number of this position. A position that is new gets the next number.
    u32 add(const Vec3& position) {
        const Vec3 p = position.array() + 0.0;  // -0 + 0 is +0; other numbers do not change
        const auto vertex = static_cast<u32>(positions.size());
        Slot& slot = slot_of(p);
        if (slot.vertex != empty) return slot.vertex;
        slot = {vertex, static_cast<u32>(hash_of(p))};
        positions.push_back(p);
        if (2 * positions.size() > slots_.size()) grow();
        return vertex;
    }

    Array<Vec3> positions;  ///< indexed by number

private:
    static constexpr u32 empty = ~u32(0);
    struct Slot {
        u32 vertex = empty;
        u32 mark = 0;  // the lower half of the hash; differs for most other positions
    };

    static u64 hash_of(const Vec3& p) {
        // Floats that are widened to double have zeros in the low bits. The hash multiplies, then folds the high half
        // down.
        u64 hash = 0;
        for (int axis = 0; axis < 3; ++axis) {
            hash = (hash ^ std::bit_cast<u64>(p[axis])) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 32;
        }
        return hash * 0xD6E8FEB86659FD93u;
    }

    /// The slot that contains this position, or else the empty slot for it.
    Slot& slot_of(const Vec3& p) {
        const u64 hash = hash_of(p);
        const std::size_t mask = slots_.size() - 1;
        for (std::size_t at = (hash >> 32) & mask;; at = (at + 1) & mask) {
            Slot& slot = slots_[at];
            if (slot.vertex == empty) return slot;
            if (slot.mark == static_cast<u32>(hash) &&
                std::memcmp(positions[slot.vertex].data(), p.data(), sizeof(Vec3)) == 0)
                return slot;
        }
    }

    void grow() {
        require_countable(2 * positions.size(), "vertices");
        slots_.assign(2 * slots_.size(), Slot{});
        for (u32 vertex = 0; vertex < positions.size(); ++vertex)
            slot_of(positions[vertex]) = {vertex, static_cast<u32>(hash_of(positions[vertex]))};
    }

    Array<Slot> slots_;
};

}  // namespace scanmill
