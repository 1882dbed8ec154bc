// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Compares a recorded run with the accepted one under the gate of its batch. Pure functions on records.
///
/// A cell is the same in both runs if workflow, scan and variant are; the scan's name counts from the folder of the
/// batch file, so that the working folder does not matter. Metrics, properties and hashes of outputs are compared
/// whatever the machine and the version, costs with those of earlier runs on the same machine (costs.hpp).

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/compare/values.hpp"
#include "scanmill/gate/gate.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// Of a cell: the first that fits. Of a run: regressed if a cell is, else missing, failed, doubtful, new without an
/// accepted run, improved, passed.
enum class Verdict {
    failed,     ///< it failed, or a rule cannot be applied to it
    missing,    ///< the accepted run has the cell; in this run it is absent or did not run
    regressed,  ///< a value breaks its rule, or is gone
    doubtful,   ///< a filter doubts its result
    improved,   ///< a value is better by more than its tolerance, or the cell failed in the accepted run
    is_new,     ///< no accepted run has the cell
    passed
};
/// In the order of the enumeration.
inline constexpr std::array<Verdict, 7> all_verdicts{Verdict::failed,   Verdict::missing,  Verdict::regressed,
                                                     Verdict::doubtful, Verdict::improved, Verdict::is_new,
                                                     Verdict::passed};
/// "failed", …, "new", "passed".
std::string_view name_of(Verdict verdict);

/// What a change means for the gate. `listed`: nothing; it is within its rule, or no rule is for it.
enum class Effect { regression, improvement, listed };
std::string_view name_of(Effect effect);

/// A number that differs between the runs, in this run's unit of lengths.
struct MetricChange {
    std::string source, metric;  ///< as in CellValue
    Unit unit = Unit::number;
    LengthUnit lengths = LengthUnit::unknown;
    std::optional<double> accepted, found;  ///< nothing: the run has no such value
    std::string rule;                       ///< its text; empty: there is none
    Effect effect = Effect::listed;

    /// The difference as a share of the accepted value; infinite if that is 0 or one is absent.
    double share() const;
};

/// An output file whose bytes differ, or that only one run wrote.
struct OutputChange {
    std::string file;             ///< without its folder
    std::string accepted, found;  ///< SHA-256; empty: not written
    Effect effect = Effect::listed;
};

/// Medians over passes: of this run, and of the earlier ones.
struct CostChange {
    std::string cost;  ///< `seconds`, `cpu-seconds` or `memory` (bytes)
    double before = 0, now = 0;
    std::size_t passes_before = 0, passes = 0;
    std::optional<double> probability;  ///< of the ranks if nothing changed; nothing: not computed
    std::string rule;
    Effect effect = Effect::listed;

    double share() const { return now / before - 1; }
};

struct CellComparison {
    std::string workflow, scan, variant;  ///< the scan from the batch's folder
    Verdict verdict = Verdict::passed;
    std::vector<std::string> reasons;  ///< of the verdict, a sentence each
    std::vector<std::string> causes;   ///< what differs in its inputs and steps; only if the verdict is not passed
    std::vector<MetricChange> metrics;  ///< regressions first, then improvements, then the others; the largest first
    std::vector<OutputChange> outputs;
    std::vector<CostChange> costs;  ///< all that could be compared
    std::vector<CellValue> values;  ///< all of this run
    std::vector<CostRecord> passes;  ///< of this run
    std::vector<std::string> moved;  ///< outputs of an earlier run that were moved aside when the cell failed
    double seconds = 0;
    std::string command;  ///< reproduces the cell in a shell; empty for cells that passed
};

/// What the comparison needs to know of a run.
struct RunFacts {
    std::int64_t id = 0;
    std::string started, outcome, version, machine;
    unsigned threads = 0, jobs = 0;
    double seconds = 0;
};

struct Comparison {
    std::string batch, file;
    RunFacts run;
    std::optional<RunFacts> accepted;      ///< nothing: there is none
    std::optional<Acceptance> acceptance;  ///< nothing: the run to compare with was chosen otherwise
    std::string accepted_folder;           ///< empty: the run's own
    Gate gate;
    Verdict verdict = Verdict::passed;
    std::array<std::size_t, all_verdicts.size()> counts{};  ///< of cells, by verdict
    std::vector<std::string> filters;                        ///< changed versions: "decimate 2 → 3"
    std::vector<std::string> notes;                          ///< a sentence each, as "the machine changed: …"
    std::vector<CellComparison> cells;  ///< in the order of the run, then the missing ones

    std::size_t count(Verdict of) const { return counts[static_cast<std::size_t>(of)]; }
    /// A cell regressed or is missing.
    bool tripped() const { return count(Verdict::regressed) + count(Verdict::missing) > 0; }
};

/// The run to compare with.
struct Baseline {
    RunDetails run;
    std::optional<Acceptance> acceptance;
    std::string folder;             ///< empty: the records of the compared run
    std::vector<PastCosts> costs;  ///< of the runs since then, before the compared one, on its machine
};

/// Without a baseline all cells that are not failed or doubtful are new. Throws Error for a recorded gate that cannot
/// be read. Cost: linear in the recorded rows.
Comparison compare(const RunDetails& run, const Baseline* baseline);

/// One entry of what changed, over all cells.
struct RankedChange {
    const CellComparison* cell = nullptr;
    const MetricChange* metric = nullptr;  ///< one of these three
    const OutputChange* output = nullptr;
    const CostChange* cost = nullptr;

    Effect effect() const;
    double share() const;       ///< of an output: infinite
    double confidence() const;  ///< 1 for metrics and outputs, which have no noise; 1 - probability for costs
};

/// Regressions first, then improvements, then the others; within these by size, then by confidence. Costs within
/// their rules, which always differ, are left out.
std::vector<RankedChange> what_changed(const Comparison& comparison);

/// The metrics that a cell of the comparison has, with costs; for the choice of one.
std::vector<std::string> metric_names(const Comparison& comparison);

/// What the matrix of the comparison shows if nothing was chosen: the first metric with a rule, else the first that was
/// measured, else `seconds`.
std::string default_metric(const Comparison& comparison);

/// One number of the cell: of a metric as a rule means it, or the median of a cost. Nothing: the cell has none.
std::optional<CellValue> number_of(const CellComparison& cell, std::string_view metric);

}  // namespace scanmill
