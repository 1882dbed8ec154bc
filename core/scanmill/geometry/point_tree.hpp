// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Nearest neighbours among points: a kd-tree behind two questions.
///
/// The tree is built over the distinct places of the points in ascending order of x, y and z. So its answers depend on
/// the places alone: neither on the order of the points, nor on how often one is repeated.

#include <memory>
#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

class PointTree {
public:
    /// Pre: finite positions, at least one, fewer than 2^32. Cost: O(n log n) time, about 60 bytes per point.
    explicit PointTree(std::span<const Vec3> positions);
    ~PointTree();

    /// The distinct places, ascending by x, then y, then z; a place's index is its number.
    std::span<const Vec3> places() const;
    /// Per row of the input the number of its place.
    std::span<const u32> place_of_row() const;

    /// Of the places other than number `place` the `count` nearest ones' squared distances, ascending; all there are
    /// when there are fewer. Callable from several threads, as is within().
    std::vector<double> nearest(u32 place, std::size_t count) const;
    /// Numbers of the other places at a squared distance below `squared`, ascending.
    std::vector<u32> within(u32 place, double squared) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace scanmill
