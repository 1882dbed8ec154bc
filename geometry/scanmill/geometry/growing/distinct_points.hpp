// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The points that a surface grows over, and their nearest neighbours. Each position occurs once. Points that are close
/// in space have close numbers, so they are close in memory.

#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/point_tree.hpp"

namespace scanmill::growing {

struct DistinctPoints {
    /// Sorted along the Morton curve through their box; points of equal codes by x, y, z. The order depends on the
    /// positions alone, so a decision by point number is a decision by position.
    Array<Vec3> positions;
    /// For each point, the lowest row of the cloud at its position.
    Array<u32> rows;
    /// All further rows of the cloud at the position of a point, sorted by point and row.
    struct Repeat {
        u32 point, row;
    };
    std::vector<Repeat> repeats;

    std::size_t size() const { return positions.size(); }
};

/// Pre: finite positions, fewer than 2^32. Cost: at most O(n log n), 61 bytes per point, 8 more per repeat.
DistinctPoints distinct_points_of(std::span<const Vec3> positions);

/// Throws Error if there are fewer than 3 points, or if all are collinear to within a billionth of their extent.
/// `rows`: number of rows of the cloud, for the message.
void require_area(const DistinctPoints& points, std::size_t rows);

/// The nearest neighbours of every point, computed once, and a radius search for the few queries that need a larger
/// distance.
class Neighbourhoods {
public:
    /// Pre: at least two points. Cost: O(n log n) time, about 160 bytes per point.
    Neighbourhoods(const DistinctPoints& points, unsigned threads);

    /// The 16 nearest other points (or all if there are fewer), sorted by distance, then by position.
    std::span<const u32> of(u32 point) const { return {nearest_.data() + std::size_t(point) * count_, count_}; }
    /// Squared distance within which of() contains all points.
    double squared_reach(u32 point) const { return squared_reach_[point]; }
    /// Appends the other points at a squared distance below `squared`, in the order of of().
    void within(u32 point, double squared, NeighbourBuffer& buffer, std::vector<u32>& found) const;

private:
    PointTree tree_;
    std::size_t count_;
    /// Number of the point for every index in the tree.
    Array<u32> point_of_tree_index_;
    Array<u32> nearest_;
    Array<double> squared_reach_;
};

}  // namespace scanmill::growing
