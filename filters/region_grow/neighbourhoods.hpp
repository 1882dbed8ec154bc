// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Who is near whom: every place's nearest others, found once, and a search for the few edges that need to look
/// farther.

#include <vector>

#include "region_grow/samples.hpp"
#include "scanmill/geometry/spatial/point_tree.hpp"

namespace scanmill::growing {

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
