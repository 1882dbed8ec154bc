// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/canonical_cells.hpp"

#include <algorithm>
#include <atomic>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill {

namespace {

constexpr std::size_t chunk = 1 << 14;
using Row = std::array<u32, 4>;

struct NumberedCell {
    Tetrahedron corners;
    u32 number;
};

}  // namespace

CanonicalCells canonical_cells(Array<Tetrahedron> cells, Array<Row> neighbours, std::size_t vertices,
                               unsigned threads) {
    // Counting sort by first corner: bucket sizes, bucket starts, fill. The order in which threads fill a bucket does
    // not matter, because buckets are sorted afterwards.
    Array<u32> next(vertices + 1);
    std::fill(next.begin(), next.end(), 0);
    const auto claim = [&, is_serial = threads == 1](u32 vertex) {
        return is_serial ? next[vertex]++ : std::atomic_ref(next[vertex]).fetch_add(1, std::memory_order_relaxed);
    };
    for_each_chunk(threads, cells.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) claim(cells[c][0]);
    });
    u32 start = 0;
    for (u32& entry : next) start += std::exchange(entry, start);

    Array<NumberedCell> sorted(cells.size());
    for_each_chunk(threads, cells.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) sorted[claim(cells[c][0])] = {cells[c], static_cast<u32>(c)};
    });

    // Filling has moved every start to that of the next bucket: bucket v is now [next[v - 1], next[v]).
    CanonicalCells result{std::move(cells), {}, {}};
    Array<u32> new_number(sorted.size());
    for_each_chunk(threads, vertices, chunk / 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            const u32 first = vertex == 0 ? 0 : next[vertex - 1], last = next[vertex];
            std::sort(sorted.begin() + first, sorted.begin() + last,
                      [](const NumberedCell& a, const NumberedCell& b) { return a.corners < b.corners; });
            for (u32 c = first; c < last; ++c) {
                result.cells[c] = sorted[c].corners;
                new_number[sorted[c].number] = c;
            }
        }
    });

    // Visits the cells in input order. Neighbours are mostly near each other in this order, so only the writes are
    // scattered.
    sorted = {};
    result.neighbours.resize(neighbours.size());
    for_each_chunk(threads, neighbours.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            Row across = neighbours[c];
            for (u32& neighbour : across)
                if (neighbour != TetMesh::outside_hull) neighbour = new_number[neighbour];
            result.neighbours[new_number[c]] = across;
        }
    });
    result.number = std::move(new_number);
    return result;
}

SpatialTets in_spatial_order(const TetMesh& tets, Execution& execution) {
    const unsigned threads = execution.threads();
    SpatialTets result;
    result.vertices = spatial_order(tets.positions.span());
    const std::size_t count = result.vertices.size();
    Array<u32> number(count);
    Array<Vec3> positions(count);
    for_each_chunk(threads, count, chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t v = begin; v < end; ++v) {
            number[result.vertices[v]] = static_cast<u32>(v);
            positions[v] = tets.positions[result.vertices[v]];
        }
    });
    Array<Tetrahedron> cells(tets.cells.size());
    Array<Row> neighbours(cells.size());
    for_each_chunk(threads, cells.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t c = begin; c < end; ++c) {
            Tetrahedron renumbered;
            for (std::size_t i = 0; i < 4; ++i) renumbered[i] = number[tets.cells[c][i]];
            const std::array<int, 4> order = canonical_corners(renumbered);
            for (std::size_t i = 0; i < 4; ++i) {
                cells[c][i] = renumbered[static_cast<std::size_t>(order[i])];
                neighbours[c][i] = tets.neighbours[c][static_cast<std::size_t>(order[i])];
            }
        }
    });
    CanonicalCells canonical = canonical_cells(std::move(cells), std::move(neighbours), count, threads);
    result.tets.frame = tets.frame;
    result.tets.positions = std::move(positions);
    result.tets.cells = std::move(canonical.cells);
    result.tets.neighbours = std::move(canonical.neighbours);
    result.cells = std::move(canonical.number);
    return result;
}

}  // namespace scanmill
