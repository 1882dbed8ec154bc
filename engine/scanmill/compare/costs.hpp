// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether a cell costs more than it did: the passes of a run against those of earlier runs.
///
/// Time and memory vary from pass to pass, so two numbers decide: by how much the medians differ, and how improbable
/// the ranks of the new passes are if nothing changed (Mann and Whitney 1947, one-sided, exact, ties by mid-ranks).

#include <cstdint>
#include <optional>
#include <span>

namespace scanmill {

/// A share of equally probable arrangements, as whole numbers: decisions do not depend on rounding.
struct ExactProbability {
    std::uint64_t favourable = 0, total = 1;

    double value() const { return static_cast<double>(favourable) / static_cast<double>(total); }
    /// Below 1 / `parts`.
    bool is_below_one_in(std::uint64_t parts) const { return favourable * parts < total; }
    bool operator==(const ExactProbability&) const = default;
};

/// Most values on either side of the rank test: with more, the counts would exceed 64 bits.
inline constexpr std::size_t most_ranked = 20;

/// The probability that `larger` has at least its rank sum if the values of both sides are exchangeable.
/// Pre: both sides have 1 to most_ranked values, none of them NaN. Cost: with n the smaller side of N values in all,
/// N n² N additions.
ExactProbability rank_test(std::span<const double> larger, std::span<const double> smaller);

/// For an even number of values, the mean of the two in the middle. Pre: not empty.
double median(std::span<const double> values);

/// Fewer earlier passes than this say too little for ranks: only the sizes decide, at twice the tolerance.
inline constexpr std::size_t least_ranked = 8;
/// A difference counts if its probability is below 1 in `strong`; one of twice the tolerance if it is below 1 in
/// `weak`, because a few slow passes among the earlier ones must not hide it.
inline constexpr std::uint64_t strong = 1000, weak = 50;
/// Other programs on the machine make a step wait, which takes time but no processor time. Time that rises without
/// processor time must therefore rise by this multiple of the tolerance, and by this many seconds: a few time slices.
/// Measured on two cores with 15 other busy programs: of 7,200 comparisons of unchanged cells in 80 runs of three
/// passes, 72 had a false alarm with 1, 66 with 2, 11 with 3, and 4 with 4. Of 480 comparisons of cells that take 4 to
/// 100 ms, 4 had a false alarm without the seconds, for rises up to 10 ms.
inline constexpr double unconfirmed_factor = 4, unconfirmed_seconds = 0.02;
/// Other programs also empty the caches: 0.7 ms of processor time became at least 1 ms in all passes of one such
/// comparison. Any time must rise by this many seconds.
inline constexpr double least_seconds = 0.002;

enum class CostKind {
    time,
    unconfirmed_time,  ///< the processor time did not rise
    other              ///< memory
};

struct CostJudgement {
    double before = 0, now = 0;  ///< medians
    bool is_worse = false, is_better = false;
    /// Result of the rank test in the direction of the difference; empty where the sizes alone decided.
    std::optional<double> probability;
};

/// Judges the passes `now` by the earlier ones, of which the last most_ranked count. Worse: every pass is above the
/// earlier median by more than the tolerance, a share, and the ranks are improbable enough. Where the numbers of passes
/// allow no improbable ranks, the rise of twice the tolerance alone decides. Better is the reverse. That every pass
/// counts makes a blip in some of them harmless; it costs little, because the noise of times only adds.
/// Pre: `before` and `now` are not empty,
/// values positive, `now` has at most most_ranked.
CostJudgement judge_costs(std::span<const double> before, std::span<const double> now, double tolerance,
                          CostKind kind = CostKind::other);

/// Whether every pass is above the earlier median by more than the tolerance. Pre: neither is empty.
bool all_rise(std::span<const double> before, std::span<const double> now, double tolerance);

}  // namespace scanmill
