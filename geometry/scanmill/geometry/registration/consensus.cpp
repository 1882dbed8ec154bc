// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/consensus.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace scanmill {

namespace {

/// Distances below this many tolerances agree by chance.
constexpr double least_distance = 3;
/// The largest difference of the products of two normals: noisy normals of the right partners differ by less.
constexpr double largest_product_difference = 0.35;
constexpr std::size_t most_seeds = 300, group_size = 20;
constexpr int power_iterations = 8;
constexpr double vote_distance = 1.5, different = 2;

/// Rows of bits are padded to a multiple of this many words.
constexpr std::size_t words_per_block = 8;

/// Counts the bits that are set in both rows.
u32 common_bits_anywhere(const u64* a, const u64* b, std::size_t words) {
    u32 count = 0;
    for (std::size_t i = 0; i < words; ++i) count += static_cast<u32>(std::popcount(a[i] & b[i]));
    return count;
}
#if defined(__x86_64__) && defined(__GNUC__)
/// The same with the processor's own instruction, which is about five times as fast.
__attribute__((target("popcnt"))) u32 common_bits_by_instruction(const u64* a, const u64* b, std::size_t words) {
    u32 count = 0;
    for (std::size_t i = 0; i < words; ++i) count += static_cast<u32>(__builtin_popcountll(a[i] & b[i]));
    return count;
}
/// The same for eight words at a time.
__attribute__((target("avx512f,avx512vpopcntdq"))) u32 common_bits_in_blocks(const u64* a, const u64* b,
                                                                             std::size_t words) {
    __m512i counts = _mm512_setzero_si512();
    for (std::size_t i = 0; i < words; i += words_per_block)
        counts = _mm512_add_epi64(
            counts, _mm512_popcnt_epi64(_mm512_and_si512(_mm512_loadu_si512(a + i), _mm512_loadu_si512(b + i))));
    alignas(64) u64 lanes[words_per_block];
    _mm512_store_si512(lanes, counts);
    return static_cast<u32>(std::accumulate(std::begin(lanes), std::end(lanes), u64(0)));
}
auto* common_bits_function() {
    if (__builtin_cpu_supports("avx512vpopcntdq")) return common_bits_in_blocks;
    return __builtin_cpu_supports("popcnt") ? common_bits_by_instruction : common_bits_anywhere;
}
#else
auto* common_bits_function() { return common_bits_anywhere; }
#endif

/// A symmetric relation of the correspondences, one row of bits for each.
class Compatibility {
public:
    explicit Compatibility(std::size_t size)
        : size_(size),
          words_((size / 64 + words_per_block) / words_per_block * words_per_block),
          bits_(size * words_, 0),
          common_bits_(common_bits_function()) {}

    std::size_t size() const { return size_; }
    /// Sets the relation of i and the correspondences 64 word … 64 word + 63, in both rows.
    void set(std::size_t i, std::size_t word, u64 bits) {
        bits_[i * words_ + word] |= bits;
        for (u64 rest = bits; rest; rest &= rest - 1) {
            const std::size_t j = word * 64 + static_cast<std::size_t>(std::countr_zero(rest));
            bits_[j * words_ + i / 64] |= u64(1) << (i % 64);
        }
    }
    bool has(std::size_t i, std::size_t j) const { return bits_[i * words_ + j / 64] >> (j % 64) & 1; }
    /// The number of correspondences that are compatible with both.
    u32 common(std::size_t i, std::size_t j) const {
        return common_bits_(&bits_[i * words_], &bits_[j * words_], words_);
    }
    /// Calls action(j) for the correspondences that are compatible with i, from `from` on, ascending.
    template <class Action>
    void for_each(std::size_t i, std::size_t from, Action&& action) const {
        for (std::size_t word = from / 64; word < words_; ++word) {
            u64 rest = bits_[i * words_ + word];
            if (word == from / 64) rest &= ~u64(0) << (from % 64);
            for (; rest; rest &= rest - 1) action(word * 64 + static_cast<std::size_t>(std::countr_zero(rest)));
        }
    }

private:
    std::size_t size_, words_;
    std::vector<u64> bits_;
    u32 (*common_bits_)(const u64*, const u64*, std::size_t);
};

/// One end of all correspondences: points and normals by coordinate, padded to a multiple of 64.
struct Ends {
    static constexpr std::size_t block = 64;
    std::size_t size;
    Array<double> x, y, z, normal_x, normal_y, normal_z;

    Ends(const PointsWithNormals& all, std::span<const Correspondence> correspondences, u32 Correspondence::*end)
        : size(correspondences.size()) {
        const std::size_t padded = (size + block - 1) / block * block;
        for (auto* column : {&x, &y, &z, &normal_x, &normal_y, &normal_z}) column->assign(padded, 0);
        for (std::size_t i = 0; i < size; ++i) {
            const Vec3 &p = all.points[correspondences[i].*end], &n = all.normals[correspondences[i].*end];
            x[i] = p.x(), y[i] = p.y(), z[i] = p.z();
            normal_x[i] = n.x(), normal_y[i] = n.y(), normal_z[i] = n.z();
        }
    }
    Vec3 point(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// The squared distances of point i from the points of a block, and the products of the normals.
struct Relations {
    double squared[Ends::block], product[Ends::block];

    Relations(const Ends& ends, std::size_t i, std::size_t begin) {
        const double px = ends.x[i], py = ends.y[i], pz = ends.z[i];
        const double nx = ends.normal_x[i], ny = ends.normal_y[i], nz = ends.normal_z[i];
        const double *x = &ends.x[begin], *y = &ends.y[begin], *z = &ends.z[begin];
        const double *normal_x = &ends.normal_x[begin], *normal_y = &ends.normal_y[begin],
                     *normal_z = &ends.normal_z[begin];
        // The number of turns is a constant, so the compiler makes vectors of it.
        for (std::size_t k = 0; k < Ends::block; ++k) {
            const double dx = x[k] - px, dy = y[k] - py, dz = z[k] - pz;
            squared[k] = dx * dx + dy * dy + dz * dz;
            product[k] = normal_x[k] * nx + normal_y[k] * ny + normal_z[k] * nz;
        }
    }
};

Compatibility compatibility_of(const Ends& a, const Ends& b, double tolerance) {
    Compatibility compatible(a.size);
    const double tolerance_squared = tolerance * tolerance;
    const double least_squared = least_distance * least_distance * tolerance_squared;
    for (std::size_t i = 0; i < a.size; ++i)
        for (std::size_t begin = i / Ends::block * Ends::block; begin < a.size; begin += Ends::block) {
            const Relations in_a(a, i, begin), in_b(b, i, begin);
            double excess[Ends::block];  // negative for compatible correspondences
            for (std::size_t k = 0; k < Ends::block; ++k) {
                // |√x - √y| < t without square roots: x + y - t² < 2 √(x y).
                const double x = in_a.squared[k], y = in_b.squared[k], rest = x + y - tolerance_squared;
                const double positive = rest > 0 ? rest : 0, distances = positive * positive - 4 * x * y;
                const double normals = std::abs(in_a.product[k] - in_b.product[k]) - largest_product_difference;
                const double larger = distances > normals ? distances : normals, too_short = least_squared - x;
                excess[k] = larger > too_short ? larger : too_short;
            }
            u64 bits = 0;
            for (std::size_t k = 0; k < Ends::block; ++k) bits |= u64(excess[k] < 0) << k;
            if (begin <= i) bits &= i % 64 == 63 ? 0 : ~u64(0) << (i % 64 + 1);
            if (const std::size_t left = a.size - begin; left < Ends::block) bits &= (u64(1) << left) - 1;
            compatible.set(i, begin / Ends::block, bits);
        }
    return compatible;
}

/// The correspondences with the largest sums of second-order compatibility, the largest first.
std::vector<std::size_t> seeds_of(const Compatibility& compatible) {
    std::vector<u64> sums(compatible.size(), 0);
    for (std::size_t i = 0; i < compatible.size(); ++i)
        compatible.for_each(i, i + 1, [&](std::size_t j) {
            const u32 common = compatible.common(i, j);
            sums[i] += common;
            sums[j] += common;
        });
    std::vector<std::size_t> seeds(compatible.size());
    std::iota(seeds.begin(), seeds.end(), 0);
    std::ranges::stable_sort(seeds, [&](std::size_t i, std::size_t j) { return sums[i] > sums[j]; });
    if (seeds.size() > most_seeds) seeds.resize(most_seeds);
    std::erase_if(seeds, [&](std::size_t i) { return sums[i] == 0; });
    return seeds;
}

/// The seed and the correspondences with the largest second-order compatibility with it.
std::vector<std::size_t> group_of(const Compatibility& compatible, std::size_t seed) {
    struct Member {
        u32 common;
        std::size_t index;
    };
    std::vector<Member> members;
    compatible.for_each(seed, 0, [&](std::size_t j) { members.push_back({compatible.common(seed, j), j}); });
    const std::size_t size = std::min(members.size(), group_size);
    std::ranges::partial_sort(members, members.begin() + static_cast<std::ptrdiff_t>(size),
                              [](const Member& a, const Member& b) {
                                  return a.common != b.common ? a.common > b.common : a.index < b.index;
                              });
    std::vector<std::size_t> group{seed};
    for (std::size_t i = 0; i < size; ++i) group.push_back(members[i].index);
    return group;
}

/// Approximates the principal eigenvector of the group's compatibility: members that agree with many others count more.
std::vector<double> weights_of(const Compatibility& compatible, std::span<const std::size_t> group) {
    std::vector<double> weights(group.size(), 1), next(group.size());
    for (int iteration = 0; iteration < power_iterations; ++iteration) {
        double squares = 0;
        for (std::size_t i = 0; i < group.size(); ++i) {
            next[i] = 0;
            for (std::size_t j = 0; j < group.size(); ++j)
                if (compatible.has(group[i], group[j])) next[i] += weights[j];
            squares += next[i] * next[i];
        }
        const double length = std::sqrt(squares);
        for (std::size_t i = 0; i < group.size(); ++i) weights[i] = next[i] / length;
    }
    return weights;
}

u32 votes_for(const RigidMotion& motion, const Ends& a, const Ends& b, double squared) {
    u32 votes = 0;
    for (std::size_t i = 0; i < a.size; ++i) votes += (motion.apply(a.point(i)) - b.point(i)).squaredNorm() < squared;
    return votes;
}

}  // namespace

std::vector<Hypothesis> consistent_motions(const PointsWithNormals& first, const PointsWithNormals& second,
                                           std::span<const Correspondence> correspondences,
                                           const ConsensusParams& params) {
    const Ends a(first, correspondences, &Correspondence::first), b(second, correspondences, &Correspondence::second);
    const Compatibility compatible = compatibility_of(a, b, params.tolerance);
    const double vote_squared = vote_distance * vote_distance * params.tolerance * params.tolerance;
    std::vector<Hypothesis> found;
    Array<Vec3> from, to;
    for (const std::size_t seed : seeds_of(compatible)) {
        const std::vector<std::size_t> group = group_of(compatible, seed);
        if (group.size() < 3) continue;
        from.clear(), to.clear();
        for (const std::size_t i : group) from.push_back(a.point(i)), to.push_back(b.point(i));
        const RigidMotion motion = fitted_motion(from, to, weights_of(compatible, group));
        found.push_back({motion, votes_for(motion, a, b, vote_squared)});
    }
    std::ranges::stable_sort(found, [](const Hypothesis& x, const Hypothesis& y) { return x.votes > y.votes; });
    std::vector<Hypothesis> chosen;
    for (const Hypothesis& next : found) {
        const bool is_new = std::ranges::all_of(chosen, [&](const Hypothesis& old) {
            return displacement(next.motion, old.motion, params.centre, params.radius) > different * params.tolerance;
        });
        if (!is_new) continue;
        chosen.push_back(next);
        if (chosen.size() == params.most_motions) break;
    }
    return chosen;
}

}  // namespace scanmill
