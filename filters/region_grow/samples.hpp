// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The places that a surface grows over: each once, numbered so that neighbours in space are neighbours in memory.

#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill::growing {

struct Samples {
    /// Distinct, along the Morton curve through their box, equal codes by x, y, z: the order depends on the places
    /// alone, so whatever is decided by number is decided by place.
    Array<Vec3> positions;
    /// Per place the lowest row of the cloud that lies there.
    Array<u32> rows;
    /// All further rows, by place and row.
    struct Repeat {
        u32 place, row;
    };
    std::vector<Repeat> repeats;

    std::size_t size() const { return positions.size(); }
};

/// Pre: finite positions, fewer than 2^32. Cost: O(n log n) at most, 61 bytes per point, 8 more per repeat.
Samples distinct_samples(std::span<const Vec3> positions);

}  // namespace scanmill::growing
