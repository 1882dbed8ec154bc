// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Nearest neighbours among points: a kd-tree behind a few questions.
///
/// The tree is built over the distinct places of the points in ascending order of x, y and z. So its answers depend on
/// the places alone: neither on the order of the points, nor on how often one is repeated, nor on the tree's shape.
/// A squared distance is (dx² + dy²) + dz² as doubles round it, whoever asks; one that is too large for a double is
/// infinite, one that is too small is 0, and the places at such a distance are told apart by their numbers only.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Another place, as seen from one. Neighbours ascend by squared distance, equally far ones by number.
struct Neighbour {
    double squared;
    u32 place;
    bool operator==(const Neighbour&) const = default;
};

/// The answers for a few places that lie side by side.
struct NeighbourBatch {
    /// Which places.
    std::span<const u32> places;
    /// For places[i] the neighbours [i * each, (i + 1) * each).
    std::span<const Neighbour> neighbours;
    std::size_t each;

    std::span<const Neighbour> of(std::size_t i) const { return neighbours.subspan(i * each, each); }
};

/// The memory of a search, to be used again by the next one; each thread needs its own.
struct NeighbourBuffer {
    Array<Neighbour> neighbours;
    // All within a radius: their coordinates apart, so that distances are computed side by side; squares of these;
    // those that count, and the same dealt out by size.
    Array<double> x, y, z, squares;
    Array<u32> numbers, piles;
    Array<Neighbour> found, dealt;
    std::size_t candidates = 0, room = 0;

    void make_room(std::size_t size);
};

class PointTree {
public:
    /// Pre: finite positions, at least one, fewer than 2^32. Cost: O(n log n) time, about 75 bytes per point.
    explicit PointTree(std::span<const Vec3> positions, unsigned threads = 1);
    ~PointTree();
    PointTree(PointTree&&) noexcept;
    PointTree& operator=(PointTree&&) noexcept;

    /// The distinct places, ascending by x, then y, then z; a place's index is its number.
    std::span<const Vec3> places() const;
    /// Per row of the input the number of its place.
    std::span<const u32> place_of_row() const;

    /// Of the places other than number `place` the `count` nearest ones; all there are when there are fewer. They lie
    /// in `buffer` until it is used again. Callable from several threads, as are the questions below.
    std::span<const Neighbour> nearest(u32 place, std::size_t count, NeighbourBuffer& buffer) const;
    /// Their squared distances alone.
    std::vector<double> nearest(u32 place, std::size_t count) const;
    /// The same for every place, once each: several times as fast as asking one by one, because those that are asked
    /// together search together. `answer` is called for batches of some hundred places, from up to `threads` threads
    /// and in any order; which places share a batch depends on the places alone.
    void for_each_nearest(std::size_t count, unsigned threads,
                          const std::function<void(const NeighbourBatch& batch)>& answer) const;
    /// Numbers of the other places at a squared distance below `squared`, ascending.
    std::vector<u32> within(u32 place, double squared) const;
    /// The same places as neighbours, in their order.
    std::span<const Neighbour> within(u32 place, double squared, NeighbourBuffer& buffer) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace scanmill
