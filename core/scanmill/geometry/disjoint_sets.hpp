// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Disjoint sets of 0 … n − 1 with path halving; near-constant time per operation. The smaller number represents a set.

#include <numeric>
#include <utility>

#include "scanmill/data/array.hpp"

namespace scanmill {

class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

    u32 find(u32 element) {
        while (parent_[element] != element) element = parent_[element] = parent_[parent_[element]];
        return element;
    }
    /// False when they were together already.
    bool unite(u32 a, u32 b) {
        a = find(a);
        b = find(b);
        if (a == b) return false;
        if (b < a) std::swap(a, b);
        parent_[b] = a;
        return true;
    }

private:
    Array<u32> parent_;
};

}  // namespace scanmill
