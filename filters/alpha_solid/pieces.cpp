// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/pieces.hpp"

#include <algorithm>
#include <atomic>
#include <span>

#include "scanmill/base/parallel.hpp"

namespace scanmill::alpha {

namespace {

/// Visits every cell that hangs together with `seed` through cells that `enter(cell)` accepts; it must accept each
/// once.
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

bool is_less(const Vec3& a, const Vec3& b) {
    return std::ranges::lexicographical_compare(std::span(a.data(), 3), std::span(b.data(), 3));
}

/// What decides which piece is the largest; the order of the points does not.
struct Piece {
    std::size_t points = 0;
    Vec3 lowest, highest;  // by x, then y, then z

    void add(const Vec3& p) {
        if (points == 0 || is_less(p, lowest)) lowest = p;
        if (points == 0 || is_less(highest, p)) highest = p;
        ++points;
    }
    bool is_larger_than(const Piece& other) const {
        if (points != other.points || points == 0) return points > other.points;
        return lowest == other.lowest ? is_less(highest, other.highest) : is_less(lowest, other.lowest);
    }
};

}  // namespace

void keep_largest_piece(const TetMesh& tets, std::span<u8> labels) {
    std::vector<u32> stack;
    Array<u32> last_piece(tets.positions.size());
    std::ranges::fill(last_piece, 0);
    u32 piece = 0, best_seed = 0;
    Piece best;
    const auto unseen = [&](u32 cell) { return labels[cell] == solid && (labels[cell] = left_out, true); };
    for (u32 seed = 0; seed < labels.size(); ++seed) {
        if (!unseen(seed)) continue;
        ++piece;
        Piece found;
        walk(tets, stack, seed, unseen, [&](u32 cell) {
            for (u32 vertex : tets.cells[cell])
                if (std::exchange(last_piece[vertex], piece) != piece) found.add(tets.positions[vertex]);
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

void fill_cavities(const TetMesh& tets, std::span<u8> labels) {
    std::vector<u32> stack;
    Array<u8> reached(labels.size());
    std::ranges::fill(reached, u8(0));
    const auto enter = [&](u32 cell) { return labels[cell] != solid && std::exchange(reached[cell], u8(1)) == 0; };
    for (u32 cell = 0; cell < labels.size(); ++cell) {
        const bool at_hull =
            std::ranges::find(tets.neighbours[cell], TetMesh::outside_hull) != tets.neighbours[cell].end();
        if (at_hull && enter(cell)) walk(tets, stack, cell, enter, [](u32) {});
    }
    for (u32 cell = 0; cell < labels.size(); ++cell)
        if (!reached[cell]) labels[cell] = solid;
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

}  // namespace scanmill::alpha
