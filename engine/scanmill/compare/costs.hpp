// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Decides whether a cell costs more than before, by comparing the passes of a run with those of earlier runs.
///
/// Time and memory vary from pass to pass, so two numbers decide. The first is the difference of the passes from the
/// earlier median. The second is the probability of the ranks of the new passes if nothing changed (Mann and Whitney
/// 1947, one-sided, exact, ties by mid-ranks).

#include <cstdint>
#include <optional>
#include <span>

namespace scanmill {

/// A probability as two numbers of equally probable arrangements. They are whole numbers, so that decisions do not
/// depend on rounding.
struct ExactProbability {
    std::uint64_t favourable = 0, total = 1;

    double value() const { return static_cast<double>(favourable) / static_cast<double>(total); }
    /// Whether the probability is below 1 / `parts`.
    bool is_below_one_in(std::uint64_t parts) const { return favourable * parts < total; }
    bool operator==(const ExactProbability&) const = default;
};

/// The most values on either side of the rank test. With more values, the counts could exceed 64 bits.
inline constexpr std::size_t most_ranked = 20;

/// The probability that `larger` has at least its rank sum if the values of both sides are exchangeable.
/// Pre: both sides have 1 to most_ranked values, none of them NaN. Cost: N² n² additions for N values in total, of
/// which the smaller side has n.
ExactProbability rank_test(std::span<const double> larger, std::span<const double> smaller);

/// The median. For an even number of values, it is the mean of the two values in the middle. Pre: not empty.
double median(std::span<const double> values);

/// The smallest number of earlier passes for which ranks are used. With fewer passes, only the size of the difference
/// decides, at twice the tolerance.
inline constexpr std::size_t least_ranked = 8;
/// A difference counts if its probability is below 1 / `strong`. A difference of more than twice the tolerance counts
/// if its probability is below 1 / `weak`, because a few slow passes among the earlier passes must not hide it.
inline constexpr std::uint64_t strong = 1000, weak = 50;
/// Other programs on the machine make a step wait. Waiting takes time but no processor time. If the time rises and the
/// processor time does not, the time must rise by `unconfirmed_factor` times the tolerance and by
/// `unconfirmed_seconds`, which are a few time slices.
///
/// The values were chosen by measurements on two cores with 15 other busy programs. Unchanged cells were compared 7,200
/// times in 80 runs of three passes. The number of false alarms was 72 with factor 1, 66 with 2, 11 with 3, and 4
/// with 4. Without a least number of seconds, 4 of 480 comparisons of cells that take 4 to 100 ms gave a false alarm,
/// for rises up to 10 ms.
inline constexpr double unconfirmed_factor = 4, unconfirmed_seconds = 0.02;
/// The least rise of any time, in seconds. Other programs also evict data from the processor's caches: in one
/// comparison, 0.7 ms of processor time became at least 1 ms in all passes.
inline constexpr double least_seconds = 0.002;

enum class CostKind {
    time,
    unconfirmed_time,  ///< wall-clock time that rose although the processor time did not
    other  ///< memory
};

struct CostJudgement {
    double before = 0, now = 0;  ///< medians of the passes
    bool is_worse = false, is_better = false;
    /// Result of the rank test in the direction of the difference; empty if the test was not used.
    std::optional<double> probability;
};

/// Compares the passes `now` with the last most_ranked passes of `before`. `tolerance` is a share of the earlier
/// median. Costs are worse if two conditions hold. Every pass must be above the earlier median by more than the
/// tolerance, and the ranks must be improbable enough. If there are too few passes for improbable ranks, a rise of more
/// than twice the tolerance alone decides. Costs are better if the reverse holds.
///
/// Every pass must rise, so that a disturbance of some passes gives no false alarm. This hides few real rises, because
/// noise only adds time.
/// Pre: `before` and `now` are not empty, all values are positive, and `now` has at most most_ranked values.
CostJudgement judge_costs(std::span<const double> before, std::span<const double> now, double tolerance,
                          CostKind kind = CostKind::other);

/// Whether every pass of `now` is above the median of `before` by more than the tolerance. Pre: `before` and `now` are
/// not empty.
bool all_rise(std::span<const double> before, std::span<const double> now, double tolerance);

}  // namespace scanmill
