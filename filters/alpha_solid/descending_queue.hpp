// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A priority queue for values that never rise: no pushed value exceeds the last popped one. It is a radix heap (Ahuja,
/// Mehlhorn, Orlin, Tarjan 1990) over the bits of non-negative doubles. An item takes a few sequential moves on
/// average, whereas a binary heap misses the cache at every level.

#include <array>
#include <bit>
#include <cassert>
#include <limits>

#include "scanmill/data/array.hpp"

namespace scanmill::alpha {

class DescendingQueue {
public:
    /// Pre: 0 ≤ value ≤ level().
    void push(double value, u32 item) {
        const u64 key = key_of(value);
        assert(value >= 0 && key >= level_);
        buckets_[bucket(key)].push_back({key, item});
    }

    /// The value of the last item popped; infinite at first.
    double level() const { return std::bit_cast<double>(~level_); }

    /// Pops the next item that `wanted(item)` accepts, and stores it in `item`. Returns false if no item is left. Items
    /// of equal value are popped last in, first out. `wanted` is called once per push, when the item's value is the
    /// level. `soon(item)` is called for some items shortly before they are popped, to prefetch their data.
    template <class Wanted, class Soon>
    bool pop(u32& item, const Wanted& wanted, const Soon& soon) {
        Array<Entry>& current = buckets_[0];
        while (true) {
            while (!current.empty()) {
                item = current.back().item;
                current.pop_back();
                if (wanted(item)) return true;
            }
            if (!descend(soon)) return false;
        }
    }

    template <class Wanted>
    bool pop(u32& item, const Wanted& wanted) {
        return pop(item, wanted, [](u32) {});
    }

private:
    struct Entry {
        u64 key;
        u32 item;
    };

    // Non-negative doubles compare like their bits; the complement makes the largest value the smallest key.
    static u64 key_of(double value) { return ~std::bit_cast<u64>(value + 0.0); }
    /// 0 for the level itself. Otherwise the position, from 1, of the highest bit in which the key differs from the
    /// level.
    std::size_t bucket(u64 key) const { return static_cast<std::size_t>(std::bit_width(key ^ level_)); }

    /// Lowers the level to the largest value left and redistributes its bucket.
    template <class Soon>
    bool descend(const Soon& soon) {
        std::size_t first = 1;
        while (first < buckets_.size() && buckets_[first].empty()) ++first;
        if (first == buckets_.size()) return false;
        Array<Entry> entries;
        entries.swap(buckets_[first]);
        if (entries.size() <= few)
            for (const Entry& entry : entries) soon(entry.item);
        u64 least = entries.front().key;
        for (const Entry& entry : entries) least = std::min(least, entry.key);
        level_ = least;
        for (const Entry& entry : entries) buckets_[bucket(entry.key)].push_back(entry);
        entries.clear();
        if (entries.capacity() > buckets_[first].capacity()) entries.swap(buckets_[first]);
        return true;
    }

    /// Prefetched data of this many items stays in the cache until they are popped.
    static constexpr std::size_t few = 64;

    u64 level_ = key_of(std::numeric_limits<double>::infinity());
    std::array<Array<Entry>, 65> buckets_;
};

}  // namespace scanmill::alpha
