// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/nearest_rows.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>

#include "scanmill/base/parallel.hpp"

namespace scanmill::voxel {

namespace {

// Points are handled in waves; within a wave, pieces are sorted by partition in parallel, then partitions are filled in
// parallel. A piece's points and a partition's table fit a processor's own cache, a wave the shared one.
constexpr std::size_t partitions = 64;
constexpr std::size_t pieces_per_wave = 16;

std::size_t partition_of(u64 bin) { return hash_of(bin) >> 58; }
static_assert(partitions == 1 << (64 - 58));

/// One piece's candidates, those of a partition together and in input order: [begin[p], begin[p + 1]).
template <class Bin>
struct Slab {
    Array<Vec3> room;
    Array<Candidate<Bin>> unsorted, candidates;
    std::array<u32, partitions + 1> begin;
};

template <class Bin>
void sort_slab(std::span<const Vec3> positions, std::size_t first_row, const BinGrid& grid, Slab<Bin>& slab) {
    slab.unsorted.resize(positions.size());
    slab.candidates.resize(positions.size());
    slab.begin.fill(0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        slab.unsorted[i] = located<Bin>(positions[i], static_cast<u32>(first_row + i), grid);
        ++slab.begin[partition_of(slab.unsorted[i].bin) + 1];
    }
    std::partial_sum(slab.begin.begin(), slab.begin.end(), slab.begin.begin());
    std::array<u32, partitions> next;
    std::copy_n(slab.begin.begin(), partitions, next.begin());
    for (const Candidate<Bin>& candidate : slab.unsorted)
        slab.candidates[next[partition_of(candidate.bin)]++] = candidate;
}

template <class Bin>
void offer_all(std::span<const Candidate<Bin>> candidates, BinTable<Bin>& table) {
    constexpr std::size_t ahead = 16;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        table.prefetch(candidates[std::min(i + ahead, candidates.size() - 1)]);
        table.offer(candidates[i]);
    }
}

/// One table per partition, all points offered in input order, so that the lowest row wins ties.
template <class Bin>
std::vector<BinTable<Bin>> winners_by_partition(const PointPieces& points, const BinGrid& grid, bool counts,
                                                Context& context) {
    std::vector<BinTable<Bin>> tables(partitions, BinTable<Bin>(counts));
    std::vector<Slab<Bin>> slabs(pieces_per_wave);
    const std::size_t pieces = points.begin.size() - 1;
    for (std::size_t first = 0; first < pieces; first += pieces_per_wave) {
        context.check_cancelled();
        context.progress(static_cast<double>(points.begin[first]) / static_cast<double>(points.points()));
        slabs.resize(std::min(pieces_per_wave, pieces - first));
        for_each_chunk(context.threads(), slabs.size(), 1, [&](std::size_t slab, std::size_t) {
            const std::size_t piece = first + slab;
            sort_slab(points.read(piece, slabs[slab].room), points.begin[piece], grid, slabs[slab]);
        });
        for_each_chunk(context.threads(), partitions, 1, [&](std::size_t partition, std::size_t) {
            for (const Slab<Bin>& slab : slabs)
                offer_all(std::span(slab.candidates)
                              .subspan(slab.begin[partition], slab.begin[partition + 1] - slab.begin[partition]),
                          tables[partition]);
        });
    }
    return tables;
}

template <class Bin>
NearestRows choose(const PointPieces& points, const BinGrid& grid, u32 min_points, bool count_members,
                   Context& context) {
    const std::vector<BinTable<Bin>> tables =
        winners_by_partition<Bin>(points, grid, min_points > 1 || count_members, context);
    NearestRows result;
    Array<u32> members_of_row(count_members ? points.points() : 0);
    Array<u64> is_kept(points.points() / 64 + 1, 0);
    std::size_t kept = 0;
    for (const BinTable<Bin>& table : tables) {
        result.bins += table.size();
        table.for_each([&](u32 row, u32 count) {
            if (count < min_points) {
                result.noise += count;
            } else {
                is_kept[row / 64] |= u64(1) << row % 64;
                ++kept;
                if (count_members) members_of_row[row] = count;
            }
        });
    }
    result.kept.reserve(kept);
    for (std::size_t word = 0; word < is_kept.size(); ++word)
        for (u64 bits = is_kept[word]; bits; bits &= bits - 1)
            result.kept.push_back(static_cast<u32>(word * 64 + static_cast<std::size_t>(std::countr_zero(bits))));
    assert(result.kept.size() == kept);
    if (count_members)
        for (const u32 row : result.kept) result.members.push_back(members_of_row[row]);
    return result;
}

}  // namespace

NearestRows nearest_rows(const PointPieces& points, const BinGrid& grid, u32 min_points, Context& context,
                         bool count_members) {
    // Memory touched at random is what thinning costs, and most grids number their bins in 32 bits.
    return grid.size_in_bins() >> 32 == 0 ? choose<u32>(points, grid, min_points, count_members, context)
                                          : choose<u64>(points, grid, min_points, count_members, context);
}

}  // namespace scanmill::voxel
