// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The results of a run as plain records: steps, output files, cells, runs. The database, JSON and its schemas derive
/// from their fields.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scanmill/worker/report.hpp"

namespace scanmill {

/// Names and values.
using Texts = std::vector<std::pair<std::string, std::string>>;

struct FailureRecord {
    Cause cause = Cause::none;
    int number = 0;
    std::string error;

    explicit operator bool() const { return cause != Cause::none; }
};
constexpr auto fields(const FailureRecord*) {
    return std::tuple{field("error", &FailureRecord::error, "The sentence, its frames and the hint.").optional(),
                      field("cause", &FailureRecord::cause, "What kind of failure it is.").optional(),
                      field("number", &FailureRecord::number, "The signal, or the exit code.").optional()};
}

struct StepRecord {
    std::size_t node = 0;
    std::string workflow, label, filter;
    int filter_version = 0;
    std::string build, file, scan, plan_key;
    Origin origin = Origin::ran;
    std::string why;
    Outcome outcome = Outcome::skipped;
    FailureRecord failure;
    Effort effort;
    unsigned attempts = 0;
    Texts authored, resolved;
    Metrics metrics, properties;
    std::vector<std::string> warnings;
};
constexpr auto fields(const StepRecord*) {
    using R = StepRecord;
    return std::tuple{
        field("node", &R::node, "Number of the step in the run, from 0."),
        field("workflow", &R::workflow),
        field("step", &R::label, "Its label in the workflow."),
        field("filter", &R::filter, "Absent for a step that reads a file.").optional(),
        field("version", &R::filter_version, "Version of the filter.").optional(),
        field("build", &R::build, "Identifies the filter's module.").optional(),
        field("file", &R::file, "The file that it reads.").optional(),
        field("scan", &R::scan),
        field("key", &R::plan_key, "Equal for equal steps."),
        field("origin", &R::origin),
        field("why", &R::why, "Why it ran and was not taken from the cache.").optional(),
        field("outcome", &R::outcome),
        field("failure", &R::failure).flat(),
        field("effort", &R::effort).flat(),
        field("attempts", &R::attempts, "How often it was started."),
        field("authored", &R::authored, "Parameters as the workflow has them.").optional(),
        field("parameters", &R::resolved, "Parameters as the filter got them, in the scan's unit.").optional(),
        field("metrics", &R::metrics, "Numbers that the filter reported; null: not finite.").by_name().optional(),
        field("properties", &R::properties, "Of its first output, or of the file that it read.").by_name().optional(),
        field("warnings", &R::warnings).optional()};
}

struct OutputRecord {
    std::string file, kind;
    Outcome outcome = Outcome::skipped;
    Metrics properties;
    std::string sha256{};
    u64 bytes = 0;
    std::string moved_to{}, not_moved{};
    std::vector<std::string> warnings{};
};
constexpr auto fields(const OutputRecord*) {
    using R = OutputRecord;
    return std::tuple{
        field("file", &R::file),
        field("kind", &R::kind),
        field("outcome", &R::outcome),
        field("properties", &R::properties, "Properties of the value; null: not finite.").by_name(),
        field("warnings", &R::warnings).optional(),
        field("sha256", &R::sha256, "Hash of the written file.").optional(),
        field("bytes", &R::bytes, "Size of the written file.").optional(),
        field("moved-to", &R::moved_to, "Where the file of an earlier run is, whose cell failed now.").optional(),
        field("not-moved", &R::not_moved, "Why the file of an earlier run is still there.").optional()};
}

/// What one pass over a cell cost, all of whose steps ran in it.
struct CostRecord {
    double seconds = 0, cpu_seconds = 0;
    u64 peak_memory = 0;
};
constexpr auto fields(const CostRecord*) {
    using R = CostRecord;
    return std::tuple{field("seconds", &R::seconds, "Wall-clock time of its steps, added up."),
                      field("cpu-seconds", &R::cpu_seconds, "Processor time of its steps, added up."),
                      field("peak-memory", &R::peak_memory, "The largest of its steps; 0: unknown.").unit("bytes")};
}

struct CellRecord {
    std::string workflow, scan, variant;
    Outcome outcome = Outcome::skipped;
    FailureRecord failure;
    double seconds = 0;
    std::vector<std::size_t> nodes;
    std::vector<OutputRecord> outputs;
    std::vector<std::string> doubts;
    std::vector<CostRecord> costs;
};
constexpr auto fields(const CellRecord*) {
    using R = CellRecord;
    return std::tuple{field("scan", &R::scan),
                      field("workflow", &R::workflow),
                      field("variant", &R::variant),
                      field("outcome", &R::outcome),
                      field("failure", &R::failure).flat(),
                      field("seconds", &R::seconds, "Of its steps and outputs; shared steps count for each cell."),
                      field("steps", &R::nodes, "Numbers of its steps."),
                      field("outputs", &R::outputs),
                      field("doubts", &R::doubts).optional(),
                      field("costs", &R::costs, "One per pass in which all of its steps ran.").optional()};
}

struct RunStart {
    std::string workflow, file;
    std::vector<std::string> arguments;
    std::uint64_t seed = 0;
    unsigned threads = 1, jobs = 0;
    std::string version, machine, libraries;
    Texts gate;
    unsigned repeats = 1;
};
constexpr auto fields(const RunStart*) {
    using R = RunStart;
    return std::tuple{field("workflow", &R::workflow, "Name of the workflow or the batch."),
                      field("file", &R::file, "Its file."),
                      field("arguments", &R::arguments, "The command."),
                      field("seed", &R::seed),
                      field("threads", &R::threads, "Inside a filter."),
                      field("jobs", &R::jobs, "Worker processes; 0: none."),
                      field("version", &R::version, "Of Scanmill."),
                      field("machine", &R::machine),
                      field("libraries", &R::libraries),
                      field("gate", &R::gate, "Rules of the batch's gate by metric.").optional(),
                      field("repeats", &R::repeats, "How often costs are measured.")};
}

struct RunSummary {
    std::int64_t id = 0;
    std::string started, workflow;
    std::optional<std::string> outcome;
    std::size_t cells = 0, doubtful = 0, failed = 0, ran = 0, cached = 0;
    double seconds = 0;
};
constexpr auto fields(const RunSummary*) {
    using R = RunSummary;
    return std::tuple{field("id", &R::id),
                      field("started", &R::started),
                      field("workflow", &R::workflow),
                      field("outcome", &R::outcome, "null: it goes on, or was killed."),
                      field("cells", &R::cells),
                      field("doubtful", &R::doubtful, "Doubtful cells."),
                      field("failed", &R::failed, "Failed cells."),
                      field("ran", &R::ran, "Steps that were computed."),
                      field("cached", &R::cached, "Steps whose result was in the cache."),
                      field("seconds", &R::seconds)};
}

struct RunDetails {
    RunSummary summary;
    RunStart start;
    std::vector<CellRecord> cells;
    std::vector<StepRecord> steps;
};

// Records of a run that has its graph.

FailureRecord record_of(const Failure& failure);
/// `build`: identifies the filter's module.
StepRecord step_record(const RunGraph& graph, const RunNode& node, const NodeReport& report, std::string build);
OutputRecord output_record(const OutputReport& report);
CellRecord cell_record(const RunGraph& graph, const RunCell& cell, const CellReport& report);

}  // namespace scanmill
