// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Edges that a grown surface must contain, such as measured edge lines.

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "scanmill/data/array.hpp"

namespace scanmill::growing {

/// Pairs of points. For every point, the other ends of its fixed edges.
class FixedEdges {
public:
    /// No edges.
    FixedEdges() = default;
    /// `edges`: pairs of different points below `points`; repeats count once. Cost: linear, and a sort of the edges.
    FixedEdges(std::span<const std::array<u32, 2>> edges, std::size_t points) : begin_(points + 1, 0) {
        std::vector<std::array<u32, 2>> directed;
        for (const auto& [a, b] : edges) {
            directed.push_back({a, b});
            directed.push_back({b, a});
        }
        std::ranges::sort(directed);
        directed.erase(std::unique(directed.begin(), directed.end()), directed.end());
        for (const auto& [from, to] : directed) {
            ++begin_[from + 1];
            ends_.push_back(to);
        }
        for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    }

    bool empty() const { return ends_.empty(); }
    /// The other ends of the point's edges, ascending.
    std::span<const u32> of(u32 point) const {
        if (empty()) return {};
        return std::span(ends_).subspan(begin_[point], begin_[point + 1] - begin_[point]);
    }
    /// Whether the point is the end of a fixed edge.
    bool at(u32 point) const { return !of(point).empty(); }
    bool contains(u32 a, u32 b) const { return std::ranges::binary_search(of(a), b); }

private:
    std::vector<u32> begin_, ends_;
};

}  // namespace scanmill::growing
