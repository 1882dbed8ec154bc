// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Compares a recorded run with the accepted run under the gate of its batch. The functions use only records.
///
/// A cell is the same in two runs if workflow, scan and variant are the same. The scan's name is relative to the folder
/// of the batch file, so the working folder does not matter. Metrics, properties and hashes of outputs are compared
/// even if the machine or the version changed. Costs are compared only with earlier runs on the same machine
/// (costs.hpp).

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/compare/values.hpp"
#include "scanmill/gate/gate.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// The verdict of a cell is the first that applies. The verdict of a run is the first of these that one of its cells
/// has: regressed, missing, failed, doubtful. If none has, it is new without an accepted run, improved if a cell
/// improved, or passed.
enum class Verdict {
    failed,  ///< the cell failed, or a rule cannot be applied to it
    missing,  ///< the cell did not run, or only the accepted run has it
    regressed,  ///< a value breaks its rule or no longer exists
    doubtful,  ///< a filter doubts its result
    improved,  ///< a value is better by more than its tolerance, or the cell failed in the accepted run
    is_new,  ///< no accepted run has the cell
    passed
};
constexpr std::array<std::string_view, 7> names_of(const Verdict*) {
    return {"failed", "missing", "regressed", "doubtful", "improved", "new", "passed"};
}
/// In the order of the enumeration.
inline constexpr std::array<Verdict, 7> all_verdicts{Verdict::failed,   Verdict::missing,  Verdict::regressed,
                                                     Verdict::doubtful, Verdict::improved, Verdict::is_new,
                                                     Verdict::passed};

/// The effect of a change on the verdict. `listed` means no effect: the change is within its rule, or no rule applies.
enum class Effect { regression, improvement, listed };
constexpr std::array<std::string_view, 3> names_of(const Effect*) { return {"regression", "improvement", "listed"}; }

/// A number that differs between the accepted run and the compared one. Both values are in the unit `lengths`.
struct MetricChange {
    std::string source, metric;
    Unit unit = Unit::number;
    LengthUnit lengths = LengthUnit::unknown;
    std::optional<double> accepted, found;
    double share = 0;
    std::string rule;
    Effect effect = Effect::listed;
};
constexpr auto fields(const MetricChange*) {
    using R = MetricChange;
    return std::tuple{
        field("source", &R::source, "Label of the step, or name of the output's file."),
        field("metric", &R::metric),
        field("unit", &R::unit),
        field("length-unit", &R::lengths),
        field("accepted", &R::accepted, "null: the accepted run has no such value."),
        field("found", &R::found, "null: this run has no such value."),
        field("share", &R::share, "The difference as a share of the accepted value; null: infinite.").nullable(),
        field("rule", &R::rule, "null: no rule applies.").nullable(),
        field("effect", &R::effect)};
}

/// An output file whose bytes differ, or that only one run wrote.
struct OutputChange {
    std::string file, accepted, found;
    Effect effect = Effect::listed;
};
constexpr auto fields(const OutputChange*) {
    using R = OutputChange;
    return std::tuple{field("file", &R::file, "Name of the file without its folder."),
                      field("accepted", &R::accepted, "SHA-256; null: not written.").nullable(),
                      field("found", &R::found, "SHA-256; null: not written.").nullable(), field("effect", &R::effect)};
}

/// A cost of a cell: the medians over the passes of this run and over the earlier passes.
struct CostChange {
    std::string cost;
    double before = 0, now = 0, share = 0;
    std::size_t passes_before = 0, passes = 0;
    std::optional<double> probability;
    std::string rule;
    Effect effect = Effect::listed;
};
constexpr auto fields(const CostChange*) {
    using R = CostChange;
    return std::tuple{
        field("cost", &R::cost, "seconds, cpu-seconds or memory (in bytes)."),
        field("before", &R::before, "The median of the earlier passes."),
        field("now", &R::now, "The median of this run's passes."),
        field("share", &R::share, "The difference as a share of the earlier median; null: infinite.").nullable(),
        field("passes-before", &R::passes_before),
        field("passes", &R::passes),
        field("probability", &R::probability, "Probability of the ranks if nothing changed; null: not computed."),
        field("rule", &R::rule, "null: no rule applies.").nullable(),
        field("effect", &R::effect)};
}

/// Who knows the doubts of a cell, and why they do not count.
struct KnownDoubts {
    std::string who, why, at;
};
constexpr auto fields(const KnownDoubts*) {
    using R = KnownDoubts;
    return std::tuple{field("who", &R::who), field("why", &R::why), field("at", &R::at)};
}

struct CellComparison {
    std::string workflow, scan, variant;  ///< the scan's path is relative to the batch's folder
    std::string outcome;  ///< outcome in this run; empty: only the accepted run has the cell
    Verdict verdict = Verdict::passed;
    std::vector<std::string> reasons;  ///< reasons for the verdict, a sentence each
    std::vector<std::string> doubts;
    std::optional<KnownDoubts> known;  ///< all doubts are acknowledged, so that the cell is not doubtful
    std::vector<std::string> causes;  ///< differences in files and steps; empty for passed and new cells
    std::vector<MetricChange> metrics;  ///< sorted by effect: regressions, improvements, others; then by size
    std::vector<OutputChange> outputs;
    std::vector<CostChange> costs;  ///< all costs that could be compared
    std::vector<CellValue> values;  ///< all values of this run
    std::vector<CostRecord> passes;  ///< costs of the passes of this run
    std::vector<std::string> moved;  ///< outputs of an earlier run that were moved aside when the cell failed
    double seconds = 0;
    std::string command;  ///< command that reproduces the cell; empty for passed and new cells
};
constexpr auto fields(const CellComparison*) {
    using R = CellComparison;
    return std::tuple{
        field("workflow", &R::workflow),
        field("scan", &R::scan, "Path of the scan, relative to the batch's folder."),
        field("variant", &R::variant),
        field("verdict", &R::verdict),
        field("reasons", &R::reasons),
        field("doubts", &R::doubts, "Doubts of filters.").optional(),
        field("known", &R::known, "The last acknowledgement, if all doubts are acknowledged."),
        field("causes", &R::causes, "Differences in the cell's files and steps."),
        field("seconds", &R::seconds),
        field("metrics", &R::metrics),
        field("outputs", &R::outputs),
        field("costs", &R::costs),
        field("moved", &R::moved, "Earlier outputs that were moved aside."),
        field("command", &R::command, "Command that reproduces the cell; null: the cell passed.").nullable(),
        field("values", &R::values, "Numbers by source and name; null: not finite.")};
}

/// The data of a run that the comparison needs.
struct RunFacts {
    std::int64_t id = 0;
    std::string started, outcome, version, machine;
    unsigned threads = 0, jobs = 0;
    double seconds = 0;
};
constexpr auto fields(const RunFacts*) {
    using R = RunFacts;
    return std::tuple{field("id", &R::id),           field("started", &R::started), field("outcome", &R::outcome),
                      field("version", &R::version), field("machine", &R::machine), field("threads", &R::threads),
                      field("jobs", &R::jobs),       field("seconds", &R::seconds)};
}

struct Comparison {
    std::string batch, file;
    RunFacts run;
    std::optional<RunFacts> accepted;  ///< empty: no run to compare with
    std::optional<Acceptance> acceptance;  ///< empty: the run to compare with was not chosen by an acceptance
    std::string accepted_folder;  ///< empty: the folder of this run
    Gate gate;
    Verdict verdict = Verdict::passed;
    std::array<std::size_t, all_verdicts.size()> counts{};  ///< number of cells by verdict
    std::vector<std::string> filters;  ///< changed versions: "decimate 2 → 3"
    std::vector<std::string> notes;  ///< a sentence each, as "the machine changed: …"
    std::vector<CellComparison> cells;  ///< scan by scan, and variant by variant within a scan; absent cells last

    /// Number of cells whose doubts are all acknowledged.
    std::size_t known() const {
        return static_cast<std::size_t>(
            std::ranges::count_if(cells, [](const auto& cell) { return cell.known.has_value(); }));
    }
    std::size_t count(Verdict of) const { return counts[static_cast<std::size_t>(of)]; }
    /// Whether a cell regressed or is missing.
    bool tripped() const { return count(Verdict::regressed) + count(Verdict::missing) > 0; }
};

/// The scan's path relative to the folder of the batch file.
std::string scan_in_batch(const std::string& scan, const std::string& file);

/// The run with which a run is compared.
struct Baseline {
    RunDetails run;
    std::optional<Acceptance> acceptance;
    std::string folder;  ///< empty: the folder of the compared run
    std::vector<PastCosts> costs;  ///< costs of the baseline and of later runs before the compared run, on its machine
};

/// Returns the command that runs the cell again. `scan` is the scan's path relative to the batch's folder.
using CommandFor = std::function<std::string(const RunDetails& run, const CellRecord& cell, const std::string& scan)>;

/// Compares `run` with `baseline`. Without a baseline, cells that are not failed, missing or doubtful are new. A cell
/// is not doubtful if `acknowledged` has all of its doubts. `command` is called for the cells that are neither passed
/// nor new. Throws Error for a recorded rule for costs that cannot be read. Cost: linear in the recorded rows.
Comparison compare(const RunDetails& run, const Baseline* baseline, const CommandFor& command = {},
                   const std::vector<Acknowledgement>& acknowledged = {});

/// A change of one cell, for the list of all changes.
struct RankedChange {
    const CellComparison* cell = nullptr;
    const MetricChange* metric = nullptr;  ///< exactly one of these three pointers is set
    const OutputChange* output = nullptr;
    const CostChange* cost = nullptr;

    Effect effect() const;
    double share() const;  ///< relative size of the change; infinite for an output
    double confidence() const;  ///< 1 for metrics and outputs, which have no noise; 1 - probability for costs
};

/// All changes: regressions first, then improvements, then others; each group is sorted by size, then by confidence.
/// Costs always differ a little, so costs within their rules are left out.
std::vector<RankedChange> what_changed(const Comparison& comparison);

/// The names of all costs and of all metrics of the cells, for the choice of a metric.
std::vector<std::string> metric_names(const Comparison& comparison);

/// The metric that the matrix shows by default: the first metric with a rule, or else the first measured metric, or
/// else `seconds`.
std::string default_metric(const Comparison& comparison);

/// The value of a metric of the cell, named as in a rule, or the median of a cost; empty if the cell has no such
/// number.
std::optional<CellValue> number_of(const CellComparison& cell, std::string_view metric);

}  // namespace scanmill
