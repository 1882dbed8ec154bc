// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// An open-addressing table from a bin's number to the best point seen in it: the inner loop of thinning.
///
/// Linear probing, at most two slots of three in use. The slot comes from the hash's low bits, so that doubling the
/// table reads and writes it front to back; partitions are made from the high bits. Callers prefetch() some points
/// ahead of offer().

#include <limits>

#include "scanmill/data/array.hpp"

namespace scanmill::voxel {

/// Multiply and fold: the low half mixes all of the bin's bits, the high half too.
inline u64 hash_of(u64 bin) {
    const u64 product = bin * 0x9e3779b97f4a7c15u;
    return product ^ (product >> 32);
}

/// A point that asks for its bin. Bin is u32 or u64: memory touched at random is what thinning costs, and most grids
/// number their bins in 32 bits.
template <class Bin>
struct Candidate {
    double distance;
    Bin bin;
    u32 row;
};

template <class Bin>
class BinTable {
public:
    static constexpr u32 nobody = ~u32(0);

    /// Counting the points of every bin costs a second array.
    explicit BinTable(bool counts) : counting_(counts), winners_(free_slots(first_size)) {
        if (counting_) counts_.assign(first_size, 0);
    }

    void prefetch(const Candidate<Bin>& point) const { __builtin_prefetch(&winners_[hash_of(point.bin) & mask_], 1); }

    /// Counts the point in; it wins when it is nearer than all earlier ones. Pre: point.row != nobody.
    void offer(const Candidate<Bin>& point) {
        const u64 place = find(winners_, mask_, point.bin);
        Candidate<Bin>& winner = winners_[place];
        const bool first = winner.row == nobody;
        // No branches: whether a point is nearer cannot be predicted.
        const bool wins = first | (point.distance < winner.distance);
        winner.bin = point.bin;
        winner.row = wins ? point.row : winner.row;
        winner.distance = point.distance < winner.distance ? point.distance : winner.distance;
        if (counting_) ++counts_[place];
        used_ += first;
        if (used_ > limit_) grow();
    }

    /// Calls action(row of the winner, number of points) for every occupied bin, in no meaningful order. The number is
    /// 1 when the table does not count.
    template <class Action>
    void for_each(Action&& action) const {
        for (std::size_t place = 0; place < winners_.size(); ++place)
            if (winners_[place].row != nobody) action(winners_[place].row, counting_ ? counts_[place] : 1);
    }
    std::size_t size() const { return used_; }

private:
    static constexpr std::size_t first_size = 64;

    static Array<Candidate<Bin>> free_slots(std::size_t size) {
        return Array<Candidate<Bin>>(size, {std::numeric_limits<double>::infinity(), 0, nobody});
    }
    static u64 find(const Array<Candidate<Bin>>& winners, u64 mask, Bin bin) {
        u64 place = hash_of(bin) & mask;
        while (winners[place].row != nobody && winners[place].bin != bin) place = (place + 1) & mask;
        return place;
    }
    void grow() {
        const u64 mask = 2 * mask_ + 1;
        Array<Candidate<Bin>> winners = free_slots(mask + 1);
        Array<u32> counts;
        if (counting_) counts.assign(mask + 1, 0);
        for (std::size_t place = 0; place < winners_.size(); ++place) {
            const Candidate<Bin>& winner = winners_[place];
            if (winner.row == nobody) continue;
            const u64 moved = find(winners, mask, winner.bin);
            winners[moved] = winner;
            if (counting_) counts[moved] = counts_[place];
        }
        winners_ = std::move(winners);
        counts_ = std::move(counts);
        mask_ = mask;
        limit_ = winners_.size() / 3 * 2;
    }

    bool counting_;
    Array<Candidate<Bin>> winners_;
    Array<u32> counts_;
    u64 mask_ = first_size - 1;
    std::size_t limit_ = first_size / 3 * 2;
    std::size_t used_ = 0;
};

}  // namespace scanmill::voxel
