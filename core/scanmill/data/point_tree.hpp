// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Nearest neighbours among points: a kd-tree with a small interface.
///
/// The tree contains each distinct position once, in ascending order of x, then y, then z; the index of a position is
/// its rank in that order. Results therefore depend on the positions alone: neither on the order of the points, nor on
/// repeats, nor on the shape of the tree. A squared distance is (dx² + dy²) + dz², computed in doubles.

#include <functional>
#include <memory>
#include <span>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// A position near another one: its squared distance and its index. Neighbours are sorted by squared distance; the
/// lower index wins ties.
struct Neighbour {
    double squared;
    u32 index;
    bool operator==(const Neighbour&) const = default;
};

/// The neighbours of some hundred positions that are close together.
struct NeighbourBatch {
    std::span<const u32> indices;
    /// The neighbours of indices[i] are [i * each, (i + 1) * each).
    std::span<const Neighbour> neighbours;
    std::size_t each;

    std::span<const Neighbour> of(std::size_t i) const { return neighbours.subspan(i * each, each); }
};

/// Reusable memory of a search; each thread needs its own.
struct NeighbourBuffer {
    Array<Neighbour> neighbours;
    /// Candidates within a radius. Coordinates are in separate arrays so that the distances are computed in vectors.
    Array<double> x, y, z, squares;
    Array<u32> indices, buckets;
    Array<Neighbour> found, sorted;
    std::size_t candidates = 0;

    void reserve(std::size_t size);
};

class PointTree {
public:
    /// Pre: finite positions, at least one, fewer than 2^32. Cost: O(n log n) time, about 75 bytes per point.
    explicit PointTree(std::span<const Vec3> positions, unsigned threads = 1);

    /// The distinct positions, ascending by x, then y, then z.
    std::span<const Vec3> positions() const;
    /// For every row of the input, the index of its position in positions().
    std::span<const u32> index_of_row() const;

    /// The `count` nearest of the other positions, or all of them if there are fewer. The result is in `buffer` and is
    /// valid until the next search with this buffer. This function and the functions below are safe to call from
    /// several threads.
    std::span<const Neighbour> nearest(u32 index, std::size_t count, NeighbourBuffer& buffer) const;
    /// The `count` positions nearest to any finite point, or all positions if there are fewer. A position equal to
    /// `point` is included.
    std::span<const Neighbour> nearest_to(const Vec3& point, std::size_t count, NeighbourBuffer& buffer) const;
    /// Computes nearest() for every position, several times as fast as one call each. Calls `action` from up to
    /// `threads` threads and in any order. Which positions share a batch depends on the positions alone.
    void for_each_nearest(std::size_t count, unsigned threads,
                          const std::function<void(const NeighbourBatch& batch)>& action) const;
    /// The other positions at a squared distance below `squared`, in the order of neighbours. The result is in
    /// `buffer`, as for nearest().
    std::span<const Neighbour> within(u32 index, double squared, NeighbourBuffer& buffer) const;

private:
    struct Tree;
    std::shared_ptr<const Tree> tree_;
};

}  // namespace scanmill
