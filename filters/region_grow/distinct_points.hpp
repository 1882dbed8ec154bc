// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The places that a surface grows over: each once, numbered so that neighbours in space are neighbours in memory.

#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/geometry/spatial/point_tree.hpp"

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

// Who is near whom: every place's nearest others, found once, and a search for the few edges that need to look
// farther.

class Neighbourhoods {
public:
    /// Pre: at least two samples. Cost: O(n log n) time, about 160 bytes per place.
    Neighbourhoods(const Samples& samples, unsigned threads);

    /// The nearest other places, ascending by distance, equally far ones by place: 16, or all there are.
    std::span<const u32> of(u32 place) const { return {nearest_.data() + std::size_t(place) * count_, count_}; }
    /// Squared distance within which of() holds all places.
    double squared_reach(u32 place) const { return squared_reach_[place]; }
    /// Appends the other places at a squared distance below `squared`, in that same order.
    void within(u32 place, double squared, NeighbourBuffer& buffer, std::vector<u32>& found) const;

private:
    PointTree tree_;
    std::size_t count_;
    /// Per place of the tree the sample there.
    Array<u32> sample_of_place_;
    Array<u32> nearest_;
    Array<double> squared_reach_;
};

}  // namespace scanmill::growing
