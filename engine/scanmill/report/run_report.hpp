// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The results of a run as plain records of steps, output files, cells and runs. The tables of the database, the JSON
/// documents and their schemas derive from the fields of these records.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scanmill/worker/report.hpp"

namespace scanmill {

/// Texts by name.
using Texts = std::vector<std::pair<std::string, std::string>>;

struct FailureRecord {
    Cause cause = Cause::none;
    int number = 0;
    std::string error;
    bool is_of_machine = false;

    explicit operator bool() const { return cause != Cause::none; }
};
constexpr auto fields(const FailureRecord*) {
    return std::tuple{
        field("error", &FailureRecord::error, "The error message with its context and its hint.").optional(),
        field("cause", &FailureRecord::cause, "Kind of failure.").optional(),
        field("number", &FailureRecord::number, "Number of the signal, or the exit code.").optional(),
        field("of-machine", &FailureRecord::is_of_machine,
              "Whether another run may succeed with more memory or another disk.")
            .optional()};
}

/// An input of a step. It is the output `output` of the step that has the number `step` in the run; for a step that
/// reads a file, `output` is empty.
struct InputRecord {
    std::string port;
    std::size_t step = 0;
    std::string output;
};
constexpr auto fields(const InputRecord*) {
    using R = InputRecord;
    return std::tuple{
        field("port", &R::port, "Name of the filter's input."),
        field("step", &R::step, "Number of the step whose result it is."),
        field("output", &R::output, "Output of that step; absent for a step that reads a file.").optional()};
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
    std::vector<InputRecord> inputs;
    Texts expected;
    Metrics metrics, properties;
    std::vector<std::string> warnings;
};
constexpr auto fields(const StepRecord*) {
    using R = StepRecord;
    return std::tuple{
        field("node", &R::node, "Number of the step in the run, from 0."),
        field("workflow", &R::workflow),
        field("step", &R::label, "Label of the step in the workflow."),
        field("filter", &R::filter, "Name of the filter; absent for a step that reads a file.").optional(),
        field("version", &R::filter_version, "Version of the filter.").optional(),
        field("build", &R::build, "Identifies the filter's module.").optional(),
        field("file", &R::file, "The file that the step reads.").optional(),
        field("scan", &R::scan),
        field("key", &R::plan_key, "Plan key; equal for equal steps."),
        field("origin", &R::origin),
        field("why", &R::why, "Why the step ran instead of being taken from the cache.").optional(),
        field("outcome", &R::outcome),
        field("failure", &R::failure).flat(),
        field("effort", &R::effort).flat(),
        field("attempts", &R::attempts, "Number of times that the step was started."),
        field("authored", &R::authored, "Parameters as written in the workflow.").optional(),
        field("parameters", &R::resolved, "Parameters as the filter got them, in the scan's unit.").optional(),
        field("inputs", &R::inputs).optional(),
        field("expected", &R::expected, "What the workflow expects of the result, by metric or property.").optional(),
        field("metrics", &R::metrics, "Numbers that the filter reported; null: not finite.").by_name().optional(),
        field("properties", &R::properties, "Properties of the first output, or of the file that was read.")
            .by_name()
            .optional(),
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
    std::string evidence{};
    std::size_t step = 0;
    std::string port{};
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
        field("moved-to", &R::moved_to, "New path of an earlier run's file, moved because the cell failed in this run.")
            .optional(),
        field("not-moved", &R::not_moved, "Why the file of an earlier run could not be moved.").optional(),
        field("evidence", &R::evidence,
              "Path of the whole output below `failed/`, because its cell does not meet an expectation.")
            .optional(),
        field("step", &R::step, "Number of the step whose result the file is."),
        field("port", &R::port, "Output of that step; absent for a file that the workflow reads.").optional()};
}

/// The costs of one pass over a cell. All steps of the cell ran in this pass.
struct CostRecord {
    double seconds = 0, cpu_seconds = 0;
    u64 peak_memory = 0;
};
constexpr auto fields(const CostRecord*) {
    using R = CostRecord;
    return std::tuple{
        field("seconds", &R::seconds, "Wall-clock time, added up over the cell's steps."),
        field("cpu-seconds", &R::cpu_seconds, "Processor time, added up over the cell's steps."),
        field("peak-memory", &R::peak_memory, "Largest resident size during a step; 0: unknown.").unit("bytes")};
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
    std::size_t place = 0;
    std::string machine{};
};
constexpr auto fields(const CellRecord*) {
    using R = CellRecord;
    return std::tuple{
        field("scan", &R::scan),
        field("workflow", &R::workflow),
        field("variant", &R::variant),
        field("outcome", &R::outcome),
        field("failure", &R::failure).flat(),
        field("seconds", &R::seconds, "Time of the cell's steps and outputs; shared steps count for each cell."),
        field("steps", &R::nodes, "Numbers of the cell's steps."),
        field("outputs", &R::outputs),
        field("doubts", &R::doubts).optional(),
        field("costs", &R::costs, "One entry per pass in which all steps of the cell ran.").optional(),
        field("place", &R::place, "In runs of shards: the cell's place among all cells of the batch, from 0.")
            .optional(),
        field("machine", &R::machine, "The machine of the cell, in a run that was merged from several machines.")
            .optional()};
}

struct RunStart {
    std::string workflow, file;
    std::vector<std::string> arguments;
    std::uint64_t seed = 0;
    unsigned threads = 1, jobs = 0;
    std::string version, machine, libraries;
    Texts gate;
    unsigned repeats = 1;
    std::string folder{}, working_folder{};
    std::string shard{}, key_of_cells{};
};
constexpr auto fields(const RunStart*) {
    using R = RunStart;
    return std::tuple{
        field("workflow", &R::workflow, "Name of the workflow or the batch."),
        field("file", &R::file, "File of the workflow or the batch."),
        field("arguments", &R::arguments, "Command line."),
        field("seed", &R::seed),
        field("threads", &R::threads, "Threads inside a filter."),
        field("jobs", &R::jobs, "Worker processes; 0: none."),
        field("version", &R::version, "Version of Scanmill."),
        field("machine", &R::machine),
        field("libraries", &R::libraries),
        field("gate", &R::gate, "Rules of the batch's gate by metric.").optional(),
        field("repeats", &R::repeats, "Number of times that costs are measured."),
        field("folder", &R::folder, "Absolute path of the output folder.").optional(),
        field("working-folder", &R::working_folder, "The folder from which relative paths count.").optional(),
        field("shard", &R::shard, "The part of the batch's cells, as 3/7; absent: all of them.").optional(),
        field("key-of-cells", &R::key_of_cells, "Equal for shards of one batch.").optional()};
}

struct RunSummary {
    std::int64_t id = 0;
    std::string started, workflow;
    std::optional<std::string> outcome;
    std::size_t cells = 0, doubtful = 0, failed = 0;
    std::optional<std::size_t> regressions;
    std::size_t ran = 0, cached = 0;
    double seconds = 0;
};
constexpr auto fields(const RunSummary*) {
    using R = RunSummary;
    return std::tuple{field("id", &R::id),
                      field("started", &R::started),
                      field("workflow", &R::workflow),
                      field("outcome", &R::outcome, "null: the run is not finished, or was killed."),
                      field("cells", &R::cells),
                      field("doubtful", &R::doubtful, "Doubtful cells."),
                      field("failed", &R::failed, "Failed cells."),
                      field("regressions", &R::regressions,
                            "Cells that regressed under the gate of the batch; null: no gate judged the run."),
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

// Making records from the graph and the reports of a run.

FailureRecord record_of(const Failure& failure);
/// The record of a step. `build` identifies the filter's module.
StepRecord step_record(const RunGraph& graph, const RunNode& node, const NodeReport& report, std::string build);
OutputRecord output_record(const RunOutput& output, const OutputReport& report);
CellRecord cell_record(const RunGraph& graph, const RunCell& cell, const CellReport& report);

}  // namespace scanmill
