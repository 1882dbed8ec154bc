// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/canonical_cells.hpp"

#include <algorithm>
#include <atomic>

#include "scanmill/filter/parallel.hpp"

namespace scanmill {

namespace {

constexpr std::size_t chunk = 1 << 14;
using Row = std::array<u32, 4>;

/// Where the corners of `cell` go: the even permutation that is lexicographically smallest.
std::array<int, 4> canonical_corners(const Tetrahedron& cell) {
    static constexpr std::array<std::array<int, 4>, 4> smallest_first{{{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 0, 2, 1}}};
    std::array<int, 4> corners = smallest_first[std::ranges::min_element(cell) - cell.begin()];
    // Rotating the other three is even as well; the smallest of them comes second.
    const u32 b = cell[corners[1]], c = cell[corners[2]], d = cell[corners[3]];
    if (c < b && c < d)
        corners = {corners[0], corners[2], corners[3], corners[1]};
    else if (d < b && d < c)
        corners = {corners[0], corners[3], corners[1], corners[2]};
    return corners;
}

struct NumberedCell {
    Tetrahedron corners;
    u32 number;
};

}  // namespace

CanonicalCells canonical_cells(Array<Tetrahedron> cells, Array<Row> neighbours, std::size_t vertices,
                               unsigned threads) {
    // Counting sort by first corner: bucket sizes, bucket starts, fill. Which thread fills first does not matter, the
    // buckets are sorted afterwards.
    Array<u32> next(vertices + 1);
    std::fill(next.begin(), next.end(), 0);
    const auto claim = [&](u32 vertex) { return std::atomic_ref(next[vertex]).fetch_add(1, std::memory_order_relaxed); };
    for_each_chunk(threads, cells.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            const std::array<int, 4> corners = canonical_corners(cells[c]);
            const Tetrahedron cell = cells[c];
            const Row across = neighbours[c];
            for (int i = 0; i < 4; ++i) {
                cells[c][i] = cell[corners[i]];
                neighbours[c][i] = across[corners[i]];
            }
            claim(cells[c][0]);
        }
    });
    u32 start = 0;
    for (u32& entry : next) start += std::exchange(entry, start);

    Array<NumberedCell> sorted(cells.size());
    for_each_chunk(threads, cells.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) sorted[claim(cells[c][0])] = {cells[c], static_cast<u32>(c)};
    });

    // Filling moved every start to the next bucket's: bucket v is now [next[v - 1], next[v]).
    CanonicalCells result{std::move(cells), {}};
    Array<u32> place(sorted.size());
    for_each_chunk(threads, vertices, chunk / 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            const u32 first = vertex == 0 ? 0 : next[vertex - 1], last = next[vertex];
            std::sort(sorted.begin() + first, sorted.begin() + last,
                      [](const NumberedCell& a, const NumberedCell& b) { return a.corners < b.corners; });
            for (u32 c = first; c < last; ++c) {
                result.cells[c] = sorted[c].corners;
                place[sorted[c].number] = c;
            }
        }
    });

    result.neighbours.resize(sorted.size());
    for_each_chunk(threads, sorted.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            Row across = neighbours[sorted[c].number];
            for (u32& neighbour : across)
                if (neighbour != TetMesh::outside_hull) neighbour = place[neighbour];
            result.neighbours[c] = across;
        }
    });
    return result;
}

}  // namespace scanmill
