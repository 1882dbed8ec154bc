// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Compares a recorded run with the accepted one under the gate of its batch. Pure functions on records.
///
/// A cell is the same in both runs if workflow, scan and variant are; the scan's name counts from the folder of the
/// batch file, so that the working folder does not matter. Metrics, properties and hashes of outputs are compared
/// whatever the machine and the version, costs with those of earlier runs on the same machine (costs.hpp).

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

/// A cell gets the first verdict that applies. A run gets the first of these that any of its cells has: regressed,
/// missing, failed, doubtful, new (no accepted run), improved, passed.
enum class Verdict {
    failed,     ///< it failed, or a rule cannot be applied to it
    missing,    ///< the accepted run has the cell; in this run it is absent or did not run
    regressed,  ///< a value breaks its rule, or is gone
    doubtful,   ///< a filter doubts its result
    improved,   ///< a value is better by more than its tolerance, or the cell failed in the accepted run
    is_new,     ///< no accepted run has the cell
    passed
};
constexpr std::array<std::string_view, 7> names_of(const Verdict*) {
    return {"failed", "missing", "regressed", "doubtful", "improved", "new", "passed"};
}
/// In the order of the enumeration.
inline constexpr std::array<Verdict, 7> all_verdicts{Verdict::failed,   Verdict::missing,  Verdict::regressed,
                                                     Verdict::doubtful, Verdict::improved, Verdict::is_new,
                                                     Verdict::passed};

/// What a change means for the gate. `listed`: nothing; it is within its rule, or no rule is for it.
enum class Effect { regression, improvement, listed };
constexpr std::array<std::string_view, 3> names_of(const Effect*) { return {"regression", "improvement", "listed"}; }

/// A number that differs between the runs, in this run's unit of lengths.
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
        field("source", &R::source, "A step, or an output's file."),
        field("metric", &R::metric),
        field("unit", &R::unit),
        field("length-unit", &R::lengths),
        field("accepted", &R::accepted, "null: the accepted run has no such value."),
        field("found", &R::found, "null: this run has no such value."),
        field("share", &R::share, "The difference as a share of the accepted value; null: infinite.").nullable(),
        field("rule", &R::rule, "null: there is none.").nullable(),
        field("effect", &R::effect)};
}

/// An output file whose bytes differ, or that only one run wrote.
struct OutputChange {
    std::string file, accepted, found;
    Effect effect = Effect::listed;
};
constexpr auto fields(const OutputChange*) {
    using R = OutputChange;
    return std::tuple{field("file", &R::file, "Without its folder."),
                      field("accepted", &R::accepted, "SHA-256; null: not written.").nullable(),
                      field("found", &R::found, "SHA-256; null: not written.").nullable(), field("effect", &R::effect)};
}

/// Medians over passes: of this run, and of the earlier ones.
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
        field("share", &R::share, "The difference as a share of the median before; null: infinite.").nullable(),
        field("passes-before", &R::passes_before),
        field("passes", &R::passes),
        field("probability", &R::probability, "Probability of the ranks if nothing changed; null: not computed."),
        field("rule", &R::rule, "null: there is none.").nullable(),
        field("effect", &R::effect)};
}

struct CellComparison {
    std::string workflow, scan, variant;  ///< the scan from the batch's folder
    std::string outcome;                  ///< of this run; empty: it does not have the cell
    Verdict verdict = Verdict::passed;
    std::vector<std::string> reasons;  ///< reasons for the verdict, a sentence each
    std::vector<std::string> causes;   ///< what differs in its inputs and steps; only if the verdict is not passed
    std::vector<MetricChange> metrics;  ///< regressions first, then improvements, then the others; the largest first
    std::vector<OutputChange> outputs;
    std::vector<CostChange> costs;  ///< all that could be compared
    std::vector<CellValue> values;  ///< all of this run
    std::vector<CostRecord> passes;  ///< of this run
    std::vector<std::string> moved;  ///< outputs of an earlier run that were moved aside when the cell failed
    double seconds = 0;
    std::string command;  ///< reproduces the cell; empty for cells that passed
};
constexpr auto fields(const CellComparison*) {
    using R = CellComparison;
    return std::tuple{field("workflow", &R::workflow),
                      field("scan", &R::scan, "From the batch's folder."),
                      field("variant", &R::variant),
                      field("verdict", &R::verdict),
                      field("reasons", &R::reasons),
                      field("causes", &R::causes, "What differs in its files and steps."),
                      field("seconds", &R::seconds),
                      field("metrics", &R::metrics),
                      field("outputs", &R::outputs),
                      field("costs", &R::costs),
                      field("moved", &R::moved, "Earlier outputs that were moved aside."),
                      field("command", &R::command, "Reproduces the cell; null: it passed.").nullable(),
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
    std::optional<RunFacts> accepted;      ///< nothing: there is none
    std::optional<Acceptance> acceptance;  ///< empty: the run to compare with was chosen otherwise
    std::string accepted_folder;           ///< empty: the run's own
    Gate gate;
    Verdict verdict = Verdict::passed;
    std::array<std::size_t, all_verdicts.size()> counts{};  ///< of cells, by verdict
    std::vector<std::string> filters;                        ///< changed versions: "decimate 2 → 3"
    std::vector<std::string> notes;                          ///< a sentence each, as "the machine changed: …"
    std::vector<CellComparison> cells;  ///< scan by scan, in each the variants, as planned; then the missing ones

    std::size_t count(Verdict of) const { return counts[static_cast<std::size_t>(of)]; }
    /// A cell regressed or is missing.
    bool tripped() const { return count(Verdict::regressed) + count(Verdict::missing) > 0; }
};

/// The run to compare with.
struct Baseline {
    RunDetails run;
    std::optional<Acceptance> acceptance;
    std::string folder;             ///< empty: the records of the compared run
    std::vector<PastCosts> costs;  ///< costs of the runs since then, before the compared one, on its machine
};

/// The command that runs the cell again; `scan`: its name from the batch's folder.
using CommandFor = std::function<std::string(const RunDetails& run, const CellRecord& cell, const std::string& scan)>;

/// Without a baseline all cells that are not failed or doubtful are new. Throws Error for a recorded gate that cannot
/// be read. `command` is called for the cells that did not pass. Cost: linear in the recorded rows.
Comparison compare(const RunDetails& run, const Baseline* baseline, const CommandFor& command = {});

/// One entry of what changed, over all cells.
struct RankedChange {
    const CellComparison* cell = nullptr;
    const MetricChange* metric = nullptr;  ///< one of these three
    const OutputChange* output = nullptr;
    const CostChange* cost = nullptr;

    Effect effect() const;
    double share() const;       ///< for an output: infinite
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

/// One number of the cell: the value of a metric as rules name it, or the median of a cost. Empty: the cell has none.
std::optional<CellValue> number_of(const CellComparison& cell, std::string_view metric);

}  // namespace scanmill
