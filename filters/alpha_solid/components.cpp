// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/components.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::alpha {

namespace {

/// Visits every cell connected to `seed` through cells that `enter(cell)` accepts. `enter` must accept each cell once.
template <class Enter, class Visit>
void walk(const TetMesh& tets, std::vector<u32>& stack, u32 seed, const Enter& enter, const Visit& visit) {
    stack.assign(1, seed);
    while (!stack.empty()) {
        const u32 cell = stack.back();
        stack.pop_back();
        visit(cell);
        for (u32 across : tets.neighbours[cell])
            if (across != TetMesh::outside_hull && enter(across)) stack.push_back(across);
    }
}

/// The properties that decide which component is the largest, whatever the order of the points.
struct Component {
    std::size_t points = 0;
    Vec3 lowest = Vec3::Zero(), highest = Vec3::Zero();  // by x, then y, then z

    void add(const Vec3& p) {
        if (points == 0 || is_lower(p, lowest)) lowest = p;
        if (points == 0 || is_lower(highest, p)) highest = p;
        ++points;
    }
    bool is_larger_than(const Component& other) const {
        if (points != other.points || points == 0) return points > other.points;
        return lowest == other.lowest ? is_lower(highest, other.highest) : is_lower(lowest, other.lowest);
    }
};

}  // namespace

void keep_largest_component(const TetMesh& tets, std::span<u8> labels) {
    std::vector<u32> stack;
    Array<u32> last_component(tets.positions.size());
    std::ranges::fill(last_component, 0);
    u32 number = 0, best_seed = 0;
    Component best;
    const auto unseen = [&](u32 cell) { return labels[cell] == solid && (labels[cell] = left_out, true); };
    for (u32 seed = 0; seed < labels.size(); ++seed) {
        if (!unseen(seed)) continue;
        ++number;
        Component found;
        walk(tets, stack, seed, unseen, [&](u32 cell) {
            for (u32 vertex : tets.cells[cell])
                if (std::exchange(last_component[vertex], number) != number) found.add(tets.positions[vertex]);
        });
        if (found.is_larger_than(best)) {
            best = found;
            best_seed = seed;
        }
    }
    if (best.points == 0) return;
    const auto keep = [&](u32 cell) { return labels[cell] == left_out && (labels[cell] = solid, true); };
    keep(best_seed);
    walk(tets, stack, best_seed, keep, [](u32) {});
}

Array<u8> coverage(const TetMesh& tets, std::span<const u8> labels, unsigned threads) {
    Array<u8> covered(tets.positions.size());
    std::ranges::fill(covered, u8(0));
    for_each_chunk(threads, labels.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
            if (labels[c] == solid)
                for (u32 vertex : tets.cells[c]) std::atomic_ref(covered[vertex]).store(1, std::memory_order_relaxed);
    });
    return covered;
}

std::size_t covered_points(const TetMesh& tets, std::span<const u8> labels) {
    return static_cast<std::size_t>(std::ranges::count(coverage(tets, labels, 1), u8(1)));
}

IncrementalComponents::IncrementalComponents(const TetMesh& tets, std::span<const u8> labels)
    : tets_(tets),
      components_(tets.cells.size()),
      is_in_(tets.cells.size(), u8(0)),
      next_(tets.cells.size()),
      cell_count_(tets.cells.size()),
      point_count_(tets.cells.size()),
      cells_at_(tets.positions.size(),
                [&](auto&& add) {
                    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
                        for (const u32 vertex : tets.cells[cell]) add(vertex, cell);
                }),
      components_with_(tets.positions.size() + 1, 0u),
      visited_(tets.positions.size(), 0u) {
    for (u32 cell = 0; cell < labels.size(); ++cell)
        if (labels[cell] != outside) add(cell);
}

void IncrementalComponents::add(std::span<const u32> cells) {
    for (u32 cell : cells) add(cell);
}

void IncrementalComponents::add(u32 cell) {
    is_in_[cell] = 1;
    next_[cell] = cell;
    cell_count_[cell] = 1;
    point_count_[cell] = 4;
    ++components_with_[4];
    most_points_ = std::max<std::size_t>(most_points_, 4);
    for (u32 across : tets_.neighbours[cell])
        if (across != TetMesh::outside_hull && is_in_[across]) join(cell, across);
}

void IncrementalComponents::join(u32 a, u32 b) {
    u32 smaller = components_.find(a), larger = components_.find(b);
    if (smaller == larger) return;
    if (cell_count_[smaller] > cell_count_[larger]) std::swap(smaller, larger);
    const auto points = static_cast<u32>(point_count_[smaller] + point_count_[larger] - common_points(smaller, larger));
    const u32 cells = cell_count_[smaller] + cell_count_[larger];
    --components_with_[point_count_[smaller]];
    --components_with_[point_count_[larger]];
    ++components_with_[points];
    most_points_ = std::max<std::size_t>(most_points_, points);
    std::swap(next_[smaller], next_[larger]);  // two rings become one
    components_.unite(smaller, larger);
    const u32 root = components_.find(smaller);
    cell_count_[root] = cells;
    point_count_[root] = points;
}

std::size_t IncrementalComponents::common_points(u32 smaller, u32 larger) {
    ++pass_;
    std::size_t count = 0;
    u32 cell = smaller;
    do {
        for (u32 vertex : tets_.cells[cell])
            if (std::exchange(visited_[vertex], pass_) != pass_) count += contains(larger, vertex);
        cell = next_[cell];
    } while (cell != smaller);
    return count;
}

bool IncrementalComponents::contains(u32 component, u32 vertex) {
    return std::ranges::any_of(cells_at_[vertex],
                               [&](u32 cell) { return is_in_[cell] && components_.find(cell) == component; });
}

}  // namespace scanmill::alpha
