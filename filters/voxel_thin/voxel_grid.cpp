// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/voxel_grid.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"

namespace scanmill::voxel {

namespace {

constexpr double most_voxels_per_axis = 1 << 21;  // the product of three of them has 63 bits
constexpr double farthest_voxel = 0x1p31;
constexpr double most_voxels = 0x1p63;
constexpr u32 invalid_row = ~u32(0);

/// Hashes by multiplying and folding: both halves of the result depend on all bits of the voxel's number.
u64 hash_of(u64 voxel) {
    const u64 product = voxel * 0x9e3779b97f4a7c15u;
    return product ^ (product >> 32);
}

/// A point as a candidate of its voxel. Number is u32 or u64: random memory access dominates the cost of thinning, and
/// most grids number their voxels in 32 bits.
template <class Number>
struct Candidate {
    double distance;
    Number voxel;
    u32 row;
};

/// An open-addressing hash table from a voxel's number to the best point found in it: the inner loop of thinning.
///
/// Linear probing, at most two thirds of the slots in use. The slot is taken from the low bits of the hash, so growing
/// reads and writes the table front to back; partitions are taken from the high bits. Callers prefetch() some points
/// ahead of offer().
template <class Number>
class VoxelTable {
public:
    /// Counting the points of every voxel costs a second array.
    explicit VoxelTable(bool counts) : counting_(counts), winners_(free_slots(first_size)) {
        if (counting_) counts_.assign(first_size, 0);
    }

    void prefetch(const Candidate<Number>& point) const {
        __builtin_prefetch(&winners_[hash_of(point.voxel) & mask_], 1);
    }

    /// Counts the point; it becomes the winner if it is nearer than all earlier ones. Pre: point.row != invalid_row.
    void offer(const Candidate<Number>& point) {
        const u64 slot = find(winners_, mask_, point.voxel);
        Candidate<Number>& winner = winners_[slot];
        const bool first = winner.row == invalid_row;
        // Without branches: whether a point is nearer cannot be predicted.
        const bool wins = first | (point.distance < winner.distance);
        winner.voxel = point.voxel;
        winner.row = wins ? point.row : winner.row;
        winner.distance = point.distance < winner.distance ? point.distance : winner.distance;
        if (counting_) ++counts_[slot];
        used_ += first;
        if (used_ > limit_) grow();
    }

    /// Calls action(row of the winner, number of points) for every occupied voxel, in no particular order. The number
    /// is 1 when the table does not count.
    template <class Action>
    void for_each(Action&& action) const {
        for (std::size_t slot = 0; slot < winners_.size(); ++slot)
            if (winners_[slot].row != invalid_row) action(winners_[slot].row, counting_ ? counts_[slot] : 1);
    }
    std::size_t size() const { return used_; }

private:
    static constexpr std::size_t first_size = 64;

    static Array<Candidate<Number>> free_slots(std::size_t size) {
        return Array<Candidate<Number>>(size, {std::numeric_limits<double>::infinity(), 0, invalid_row});
    }
    static u64 find(const Array<Candidate<Number>>& winners, u64 mask, Number voxel) {
        u64 slot = hash_of(voxel) & mask;
        while (winners[slot].row != invalid_row && winners[slot].voxel != voxel) slot = (slot + 1) & mask;
        return slot;
    }
    void grow() {
        const u64 mask = 2 * mask_ + 1;
        Array<Candidate<Number>> winners = free_slots(mask + 1);
        Array<u32> counts;
        if (counting_) counts.assign(mask + 1, 0);
        for (std::size_t slot = 0; slot < winners_.size(); ++slot) {
            const Candidate<Number>& winner = winners_[slot];
            if (winner.row == invalid_row) continue;
            const u64 new_slot = find(winners, mask, winner.voxel);
            winners[new_slot] = winner;
            if (counting_) counts[new_slot] = counts_[slot];
        }
        winners_ = std::move(winners);
        counts_ = std::move(counts);
        mask_ = mask;
        limit_ = winners_.size() / 3 * 2;
    }

    bool counting_;
    Array<Candidate<Number>> winners_;
    Array<u32> counts_;
    u64 mask_ = first_size - 1;
    std::size_t limit_ = first_size / 3 * 2;
    std::size_t used_ = 0;
};

/// The point's voxel and its squared distance to the voxel's centre. Pre: it lies in the grid's box.
template <class Number>
Candidate<Number> located(const Vec3& point, u32 row, const VoxelGrid& grid) {
    u64 number = 0;
    double distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double quotient = (point[axis] - grid.origin[axis]) / grid.size;
        // This is floor() without SSE4's instruction: it truncates and corrects negative numbers. grid_over() limits
        // the range.
        const double whole = static_cast<double>(static_cast<std::int32_t>(quotient));
        const double voxel = whole > quotient ? whole - 1 : whole;
        const double offset = point[axis] - (grid.origin[axis] + (voxel + 0.5) * grid.size);
        distance += offset * offset;
        number = number * grid.voxels[axis] + static_cast<u64>(static_cast<std::int64_t>(voxel - grid.first[axis]));
    }
    return {distance, static_cast<Number>(number), row};
}

// Points are processed in blocks. In a block, chunks are sorted by partition in parallel, then partitions are filled in
// parallel. A chunk and the table of a partition fit the cache of one core, a block fits the shared cache.
constexpr std::size_t partitions = 64;
constexpr std::size_t chunks_per_block = 16;

std::size_t partition_of(u64 voxel) { return hash_of(voxel) >> 58; }
static_assert(partitions == 1 << (64 - 58));

/// The candidates of one chunk, grouped by partition, in input order: [begin[p], begin[p + 1]).
template <class Number>
struct SortedChunk {
    Array<Vec3> buffer;
    Array<Candidate<Number>> unsorted, candidates;
    std::array<u32, partitions + 1> begin;
};

template <class Number>
void sort_chunk(std::span<const Vec3> positions, std::size_t first_row, const VoxelGrid& grid,
                SortedChunk<Number>& chunk) {
    chunk.unsorted.resize(positions.size());
    chunk.candidates.resize(positions.size());
    chunk.begin.fill(0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        chunk.unsorted[i] = located<Number>(positions[i], static_cast<u32>(first_row + i), grid);
        ++chunk.begin[partition_of(chunk.unsorted[i].voxel) + 1];
    }
    std::partial_sum(chunk.begin.begin(), chunk.begin.end(), chunk.begin.begin());
    std::array<u32, partitions> next;
    std::copy_n(chunk.begin.begin(), partitions, next.begin());
    for (const Candidate<Number>& candidate : chunk.unsorted)
        chunk.candidates[next[partition_of(candidate.voxel)]++] = candidate;
}

template <class Number>
void offer_all(std::span<const Candidate<Number>> candidates, VoxelTable<Number>& table) {
    constexpr std::size_t ahead = 16;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        table.prefetch(candidates[std::min(i + ahead, candidates.size() - 1)]);
        table.offer(candidates[i]);
    }
}

/// One table per partition. Points are offered in input order, so the lowest row wins ties.
template <class Number>
std::vector<VoxelTable<Number>> winners_by_partition(const PointChunks& points, const VoxelGrid& grid, bool counts,
                                                     Context& context) {
    std::vector<VoxelTable<Number>> tables(partitions, VoxelTable<Number>(counts));
    std::vector<SortedChunk<Number>> block(chunks_per_block);
    const std::size_t chunks = points.begin.size() - 1;
    for (std::size_t first = 0; first < chunks; first += chunks_per_block) {
        context.check_cancelled();
        context.progress(static_cast<double>(points.begin[first]) / static_cast<double>(points.size()));
        block.resize(std::min(chunks_per_block, chunks - first));
        for_each_chunk(context.threads(), block.size(), 1, [&](std::size_t i, std::size_t) {
            const std::size_t chunk = first + i;
            sort_chunk(points.read(chunk, block[i].buffer), points.begin[chunk], grid, block[i]);
        });
        for_each_chunk(context.threads(), partitions, 1, [&](std::size_t partition, std::size_t) {
            for (const SortedChunk<Number>& chunk : block)
                offer_all(std::span(chunk.candidates)
                              .subspan(chunk.begin[partition], chunk.begin[partition + 1] - chunk.begin[partition]),
                          tables[partition]);
        });
    }
    return tables;
}

template <class Number>
KeptRows choose(const PointChunks& points, const VoxelGrid& grid, u32 min_points, bool count_members,
                Context& context) {
    const std::vector<VoxelTable<Number>> tables =
        winners_by_partition<Number>(points, grid, min_points > 1 || count_members, context);
    KeptRows result;
    Array<u32> members_of_row(count_members ? points.size() : 0);
    Array<u64> is_kept(points.size() / 64 + 1, 0);
    std::size_t kept = 0;
    for (const VoxelTable<Number>& table : tables) {
        result.voxels += table.size();
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

VoxelGrid grid_over(const RobustBox& box, const Vec3& origin, double size) {
    const auto voxel_of = [&](const Vec3& point, int axis) { return std::floor((point[axis] - origin[axis]) / size); };
    VoxelGrid grid{origin, size, Vec3::Zero(), {}};
    double voxels = 1, farthest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const BoundingBox& robust = box.robust;
        const double first = voxel_of(robust.low, axis), last = voxel_of(robust.high, axis);
        if (!(last - first < most_voxels_per_axis))
            throw Error(
                "voxels of {} u divide the cloud's extent of {:.6g} u along {} into {:.8g}; at most {} are supported",
                size, robust.high[axis] - robust.low[axis], "xyz"[axis], last - first + 1, most_voxels_per_axis)
                .hint(fmt::format("a bin-size of at least {:.6g} u fits this cloud",
                                  (robust.high - robust.low).maxCoeff() / (most_voxels_per_axis - 2)));
        if (!(std::max(std::abs(first), std::abs(last)) < farthest_voxel))
            throw Error(
                "the grid's origin lies {:.6g} voxels of {} u away from the cloud along {}; at most {} are supported",
                std::max(std::abs(first), std::abs(last)), size, "xyz"[axis], farthest_voxel)
                .hint("lessen the margin, or choose a grid origin nearer the cloud");
        const double lowest = voxel_of(box.all.low, axis), highest = voxel_of(box.all.high, axis);
        grid.first[axis] = lowest;
        grid.voxels[axis] = static_cast<u64>(std::min(highest - lowest, farthest_voxel)) + 1;
        voxels *= highest - lowest + 1;
        farthest = std::max({farthest, std::abs(lowest), std::abs(highest)});
    }
    if (!(farthest < farthest_voxel && voxels <= most_voxels))
        throw Error(
            "a stray point lies {:.6g} voxels of {} u away from the grid's origin; at most {} along an axis and "
            "{:.3g} voxels in all are supported",
            farthest, size, farthest_voxel, most_voxels)
            .hint("remove the stray points, or give a larger bin-size");
    return grid;
}

KeptRows nearest_to_centres(const PointChunks& points, const VoxelGrid& grid, u32 min_points, Context& context,
                            bool count_members) {
    return grid.size_in_voxels() >> 32 == 0 ? choose<u32>(points, grid, min_points, count_members, context)
                                            : choose<u64>(points, grid, min_points, count_members, context);
}

}  // namespace scanmill::voxel
