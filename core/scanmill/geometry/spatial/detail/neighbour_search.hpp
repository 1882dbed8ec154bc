// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The search behind PointTree: all points within a radius that surely holds enough of them, then the nearest of these.
///
/// A radius that holds enough is right whatever it was guessed from, so guesses need no proof, only a count: the points
/// of a leaf are asked together, with the radius that the leaf before them needed, and the few whose count falls short
/// are asked again with a radius that cannot: the distance of the (count + 1)-th point among those of a node around
/// them.

#include "scanmill/geometry/spatial/detail/box_tree.hpp"
#include "scanmill/geometry/spatial/point_tree.hpp"

namespace scanmill {

/// The order of neighbours; a type, so that sorting inlines it.
struct ComesBefore {
    bool operator()(const Neighbour& a, const Neighbour& b) const {
        return a.squared != b.squared ? a.squared < b.squared : a.place < b.place;
    }
};

class NeighbourSearch {
public:
    /// `count` is at least 1 and less than the number of points.
    NeighbourSearch(const BoxTree& tree, std::size_t count, NeighbourBuffer& buffer)
        : tree_(tree),
          count_(count),
          buffer_(buffer) {}

    /// Puts the neighbours of points()[index] into `into`, #count.
    void nearest(std::size_t index, Neighbour* into);
    /// Those of all points of a leaf, one after the other, #points × count.
    void nearest_of_leaf(u64 leaf, Neighbour* into);

private:
    double enough_around(const Vec3& position, u64 leaf);
    double radius_for_leaf(u64 leaf);
    void collect(const BoundingBox& box, double squared);
    bool choose(const BoxTree::Point& from, double squared, Neighbour* into);
    void choose_sorted(std::span<Neighbour> found, double squared, Neighbour* into);

    const BoxTree& tree_;
    std::size_t count_;
    NeighbourBuffer& buffer_;
    /// Square of what the last leaf needed.
    double last_squared_ = std::numeric_limits<double>::infinity();
};

}  // namespace scanmill
