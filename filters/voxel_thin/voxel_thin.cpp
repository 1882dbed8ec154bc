// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_thin/voxel_thin.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>
#include <vector>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/parallel.hpp"
#include "voxel_thin/bin_table.hpp"

namespace scanmill {

namespace {

constexpr double most_bins_per_axis = 1 << 21;  // three such numbers make one of 63 bits
constexpr double farthest_bin = 0x1p31;

/// Bin (i, j, k) holds floor((p - origin) / size); its number is (i, j, k) - first, counted row by row.
struct BinGrid {
    Vec3 origin;
    double size;
    Vec3 first;  // whole numbers
    std::array<u64, 3> bins;

    u64 size_in_bins() const { return bins[0] * bins[1] * bins[2]; }
};

/// Bounds of all points in one pass that also notices a NaN or an infinity; a second one finds the words for it.
BoundingBox finite_bounds(std::span<const Vec3> positions, Context& context) {
    constexpr std::size_t chunk = 1 << 18;
    std::vector<BoundingBox> boxes((positions.size() + chunk - 1) / chunk);
    std::vector<char> finite(boxes.size());
    for_each_chunk(context.threads(), positions.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        BoundingBox box;
        Vec3 zero = Vec3::Zero();  // unless some x * 0 is NaN
        for (const Vec3& p : positions.subspan(begin, end - begin)) {
            box.low = box.low.cwiseMin(p);
            box.high = box.high.cwiseMax(p);
            zero += p * 0.0;
        }
        boxes[begin / chunk] = box;
        finite[begin / chunk] = zero == Vec3::Zero();
    });
    if (std::ranges::count(finite, 0)) require_finite(positions);
    BoundingBox all;
    for (const BoundingBox& box : boxes) {
        all.low = all.low.cwiseMin(box.low);
        all.high = all.high.cwiseMax(box.high);
    }
    return all;
}

BinGrid grid_over(const BoundingBox& box, const VoxelThinParams& params) {
    const double size = params.bin_size.value();
    BinGrid grid{params.grid_origin.value_or(box.low.array() - params.margin.value()), size, Vec3::Zero(), {}};
    for (int axis = 0; axis < 3; ++axis) {
        const double first = std::floor((box.low[axis] - grid.origin[axis]) / size);
        const double last = std::floor((box.high[axis] - grid.origin[axis]) / size);
        if (!(last - first < most_bins_per_axis))
            throw Error(
                "bins of {} u cut the cloud's extent of {:.6g} u along {} into {:.8g}; at most {} bins are possible",
                size, box.high[axis] - box.low[axis], "xyz"[axis], last - first + 1, most_bins_per_axis)
                .hint(fmt::format("bins of {:.6g} u and larger fit this cloud",
                                  (box.high - box.low).maxCoeff() / (most_bins_per_axis - 2)));
        if (!(std::max(std::abs(first), std::abs(last)) < farthest_bin))
            throw Error(
                "the grid's origin lies {:.6g} bins of {} u away from the cloud along {}; at most {} are possible",
                std::max(std::abs(first), std::abs(last)), size, "xyz"[axis], farthest_bin)
                .hint("choose a grid origin nearer the cloud");
        grid.first[axis] = first;
        grid.bins[axis] = static_cast<u64>(last - first) + 1;
    }
    return grid;
}

// Points are handled in waves; within a wave, slabs are sorted by partition in parallel, then partitions are filled in
// parallel. A slab's points and a partition's table fit a processor's own cache, a wave the shared one.
constexpr std::size_t partitions = 64;
constexpr std::size_t slab_size = std::size_t(1) << 16;
constexpr std::size_t slabs_per_wave = 16;

std::size_t partition_of(u64 bin) { return voxel::hash_of(bin) >> 58; }
static_assert(partitions == 1 << (64 - 58));

/// One slab's candidates, those of a partition together and in input order: [begin[p], begin[p + 1]).
template <class Bin>
struct Slab {
    Array<voxel::Candidate<Bin>> candidates;
    std::array<u32, partitions + 1> begin;
};

template <class Bin>
voxel::Candidate<Bin> located(const Vec3& point, u32 row, const BinGrid& grid) {
    u64 number = 0;
    double distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double quotient = (point[axis] - grid.origin[axis]) / grid.size;
        // Rounding towards zero and correcting below: floor without SSE4's instruction. Fits: see farthest_bin.
        const double whole = static_cast<double>(static_cast<std::int32_t>(quotient));
        const double bin = whole > quotient ? whole - 1 : whole;
        const double offset = point[axis] - (grid.origin[axis] + (bin + 0.5) * grid.size);
        distance += offset * offset;
        number = number * grid.bins[axis] + static_cast<u64>(static_cast<std::int64_t>(bin - grid.first[axis]));
    }
    return {distance, static_cast<Bin>(number), row};
}

template <class Bin>
void sort_slab(std::span<const Vec3> positions, std::size_t first_row, const BinGrid& grid,
               Array<voxel::Candidate<Bin>>& unsorted, Slab<Bin>& slab) {
    unsorted.resize(positions.size());
    slab.candidates.resize(positions.size());
    slab.begin.fill(0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        unsorted[i] = located<Bin>(positions[i], static_cast<u32>(first_row + i), grid);
        ++slab.begin[partition_of(unsorted[i].bin) + 1];
    }
    std::partial_sum(slab.begin.begin(), slab.begin.end(), slab.begin.begin());
    std::array<u32, partitions> next;
    std::copy_n(slab.begin.begin(), partitions, next.begin());
    for (const voxel::Candidate<Bin>& candidate : unsorted)
        slab.candidates[next[partition_of(candidate.bin)]++] = candidate;
}

template <class Bin>
void offer_all(std::span<const voxel::Candidate<Bin>> candidates, voxel::BinTable<Bin>& table) {
    constexpr std::size_t ahead = 16;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        table.prefetch(candidates[std::min(i + ahead, candidates.size() - 1)]);
        table.offer(candidates[i]);
    }
}

/// One table per partition, all points offered in input order, so that the lowest row wins ties.
template <class Bin>
std::vector<voxel::BinTable<Bin>> winners_by_partition(std::span<const Vec3> positions, const BinGrid& grid,
                                                       bool counts, Context& context) {
    std::vector<voxel::BinTable<Bin>> tables(partitions, voxel::BinTable<Bin>(counts));
    std::vector<Slab<Bin>> slabs(slabs_per_wave);
    std::vector<Array<voxel::Candidate<Bin>>> unsorted(slabs_per_wave);
    constexpr std::size_t wave_size = slab_size * slabs_per_wave;
    for (std::size_t begin = 0; begin < positions.size(); begin += wave_size) {
        context.check_cancelled();
        context.progress(static_cast<double>(begin) / static_cast<double>(positions.size()));
        const std::span<const Vec3> wave = positions.subspan(begin, std::min(wave_size, positions.size() - begin));
        for_each_chunk(context.threads(), wave.size(), slab_size, [&](std::size_t first, std::size_t last) {
            const std::size_t slab = first / slab_size;
            sort_slab(wave.subspan(first, last - first), begin + first, grid, unsorted[slab], slabs[slab]);
        });
        slabs.resize((wave.size() + slab_size - 1) / slab_size);
        for_each_chunk(context.threads(), partitions, 1, [&](std::size_t partition, std::size_t) {
            for (const Slab<Bin>& slab : slabs)
                offer_all(std::span(slab.candidates)
                              .subspan(slab.begin[partition], slab.begin[partition + 1] - slab.begin[partition]),
                          tables[partition]);
        });
    }
    return tables;
}

/// Fills result.kept and result.noise; returns the number of occupied bins.
template <class Bin>
std::size_t choose(std::span<const Vec3> positions, const BinGrid& grid, u32 min_points, VoxelThinResult& result,
                   Context& context) {
    const std::vector<voxel::BinTable<Bin>> tables =
        winners_by_partition<Bin>(positions, grid, min_points > 1, context);
    Array<u64> is_kept(positions.size() / 64 + 1, 0);
    std::size_t bins = 0, kept = 0;
    for (const voxel::BinTable<Bin>& table : tables) {
        bins += table.size();
        table.for_each([&](u32 row, u32 count) {
            if (count < min_points) {
                result.noise += count;
            } else {
                is_kept[row / 64] |= u64(1) << row % 64;
                ++kept;
            }
        });
    }
    result.kept.reserve(kept);
    for (std::size_t word = 0; word < is_kept.size(); ++word)
        for (u64 bits = is_kept[word]; bits; bits &= bits - 1)
            result.kept.push_back(static_cast<u32>(word * 64 + static_cast<std::size_t>(std::countr_zero(bits))));
    assert(result.kept.size() == kept);
    return bins;
}

void require_sound(const PointCloud& cloud, const VoxelThinParams& params) {
    if (cloud.size() == 0) throw Error("the cloud has no points; thinning needs at least one");
    if (cloud.size() > ~u32(0))
        throw Error("the cloud has {} points; at most {} can be numbered", cloud.size(), ~u32(0));
    const double size = params.bin_size.value();
    if (!(size > 0) || !std::isfinite(size)) throw Error("the bin size is {} u; it must be above 0", size);
    const double margin = params.margin.value();
    if (!(margin >= 0) || !std::isfinite(margin)) throw Error("the margin is {} u; it must be 0 or more", margin);
    if (params.min_points == 0) throw Error("min-points is 0; an occupied bin has at least 1 point");
    if (params.grid_origin && !params.grid_origin->allFinite()) throw Error("the grid's origin is not finite");
}

}  // namespace

VoxelThinResult voxel_thin(const PointCloud& cloud, const VoxelThinParams& params, Context& context) {
    require_sound(cloud, params);
    const std::span<const Vec3> positions = cloud.positions.span();
    const BinGrid grid = grid_over(finite_bounds(positions, context), params);

    VoxelThinResult result;
    result.grid_origin = grid.origin;
    const std::size_t bins = grid.size_in_bins() >> 32 == 0
                                 ? choose<u32>(positions, grid, params.min_points, result, context)
                                 : choose<u64>(positions, grid, params.min_points, result, context);
    if (result.kept.empty())
        throw Error("all {} points lie in {} bins with fewer than {} points each; nothing would be left", cloud.size(),
                    bins, params.min_points)
            .hint("lower min-points or enlarge the bins");
    result.removed = cloud.size() - result.kept.size();
    result.points = gather(cloud, result.kept);

    context.metric("kept", static_cast<double>(result.kept.size()));
    context.metric("removed", static_cast<double>(result.removed));
    context.metric("noise", static_cast<double>(result.noise));
    context.progress(1);
    return result;
}

}  // namespace scanmill
