// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The points that a surface grows over: each position once, numbered so that neighbours in space are neighbours in
/// memory, and their nearest neighbours.

#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/point_tree.hpp"

namespace scanmill::growing {

struct DistinctPoints {
    /// Along the Morton curve through their box, equal codes by x, y, z. The order depends on the positions alone, so
    /// a decision by point number is a decision by position.
    Array<Vec3> positions;
    /// Per point the lowest row of the cloud at that position.
    Array<u32> rows;
    /// All further rows, by point and row.
    struct Repeat {
        u32 point, row;
    };
    std::vector<Repeat> repeats;

    std::size_t size() const { return positions.size(); }
};

/// Pre: finite positions, fewer than 2^32. Cost: O(n log n) at most, 61 bytes per point, 8 more per repeat.
DistinctPoints distinct_points_of(std::span<const Vec3> positions);

/// Throws Error if all points are collinear, to within a billionth of their extent. `rows`: rows of the cloud,
/// for the message.
void require_area(const DistinctPoints& points, std::size_t rows);

/// The nearest neighbours of every point, found once, and a radius search for the few edges that look farther.
class Neighbourhoods {
public:
    /// Pre: at least two points. Cost: O(n log n) time, about 160 bytes per point.
    Neighbourhoods(const DistinctPoints& points, unsigned threads);

    /// The 16 nearest other points (or all), ascending by distance, then by position.
    std::span<const u32> of(u32 point) const { return {nearest_.data() + std::size_t(point) * count_, count_}; }
    /// Squared distance within which of() holds all points.
    double squared_reach(u32 point) const { return squared_reach_[point]; }
    /// Appends the other points at a squared distance below `squared`, in the order of of().
    void within(u32 point, double squared, NeighbourBuffer& buffer, std::vector<u32>& found) const;

private:
    PointTree tree_;
    std::size_t count_;
    /// The tree has its own numbers of the points.
    Array<u32> point_of_tree_index_;
    Array<u32> nearest_;
    Array<double> squared_reach_;
};

}  // namespace scanmill::growing
