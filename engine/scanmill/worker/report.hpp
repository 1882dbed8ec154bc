// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The outcome of a run: of every node, every cell and every output file.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/filter/parameter.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

enum class Outcome {
    ok,
    doubtful,  ///< cells only: complete, but a filter doubts its result
    failed,
    skipped  ///< an input failed, or the run was interrupted
};
constexpr std::array<std::string_view, 4> names_of(const Outcome*) { return {"ok", "doubtful", "failed", "skipped"}; }

/// Origin of a node's result.
enum class Origin {
    ran,
    cached,      ///< found by the plan key, before the run
    same_inputs  ///< found by the run key, during the run: an upstream change did not change the inputs
};
constexpr std::array<std::string_view, 3> names_of(const Origin*) { return {"ran", "cached", "same inputs"}; }

enum class Cause {
    none,
    refused,      ///< the filter or a reader threw an Error
    expectation,  ///< the result does not meet `expect`
    exception,    ///< another exception was thrown
    memory,       ///< the memory limit, or the machine's memory, was exceeded
    time,         ///< the time limit was exceeded
    signal,       ///< a signal ended the worker process
    exit,         ///< the worker process exited
    output,       ///< a file could not be written
    fault         ///< the program's own: a filter broke its declaration
};
constexpr std::array<std::string_view, 10> names_of(const Cause*) {
    return {"", "refused", "expectation", "exception", "memory", "time", "signal", "exit", "output", "fault"};
}

struct Failure {
    Cause cause = Cause::none;
    int number = 0;  ///< the signal, or the exit code
    Error error{std::string()};  ///< with frames up to the step
    std::string scan;  ///< the scan of the cell; empty: the error's sentence names it
    std::string equal_scan;  ///< another scan with the same content, which the step ran on; empty: the scan itself

    explicit operator bool() const { return cause != Cause::none; }
    /// The error with a frame for the scan.
    Error whole() const;
};
constexpr auto fields(const Failure*) {
    using R = Failure;
    return std::tuple{field("cause", &R::cause), field("number", &R::number), field("error", &R::error),
                      field("scan", &R::scan), field("equal-scan", &R::equal_scan)};
}

/// Resources that a job used, and what its process wrote.
struct Effort {
    double seconds = 0, cpu_seconds = 0;
    u64 peak_memory = 0;
    unsigned threads = 0;
    std::vector<std::string> log;
};
constexpr auto fields(const Effort*) {
    using R = Effort;
    return std::tuple{
        field("seconds", &R::seconds, "Wall-clock time."),
        field("cpu-seconds", &R::cpu_seconds, "Processor time of all threads."),
        field("peak-memory", &R::peak_memory, "Largest resident size of the process; 0: unknown.").unit("bytes"),
        field("threads", &R::threads, "Threads that the filter could use."),
        field("log", &R::log, "The last lines on its standard output and error.").optional()};
}

struct NodeReport {
    Outcome outcome = Outcome::skipped;
    Origin origin = Origin::ran;
    std::string why;  ///< why it ran and was not taken from the cache
    Failure failure;
    Effort effort;
    unsigned attempts = 0;
    ParameterSet resolved;  ///< as the filter got them: lengths in the scan's unit
    Metrics metrics;        ///< the filter's metrics, in declared order
    Metrics properties;     ///< of the primary output or of the file read; empty unless requested
    std::vector<std::string> warnings;
    std::vector<Doubt> doubts;
};
constexpr auto fields(const NodeReport*) {
    using R = NodeReport;
    return std::tuple{
        field("outcome", &R::outcome),   field("origin", &R::origin),   field("why", &R::why),
        field("failure", &R::failure),   field("effort", &R::effort),   field("attempts", &R::attempts),
        field("resolved", &R::resolved), field("metrics", &R::metrics), field("properties", &R::properties),
        field("warnings", &R::warnings), field("doubts", &R::doubts)};
}

struct OutputReport {
    std::filesystem::path file;
    Outcome outcome = Outcome::skipped;
    Kind kind = kind_of<PointCloud>();
    Metrics properties;
    std::vector<std::string> warnings;
    std::vector<std::string> doubts;  ///< about the file: it holds less than the value
    std::string sha256;               ///< of the file's bytes; empty: not written
    u64 bytes = 0;                    ///< of the file
    std::filesystem::path moved_to;   ///< where the file of an earlier run was moved; empty: nowhere
    std::string not_moved;            ///< why the file of an earlier run could not be moved; empty: it need not be
};
constexpr auto fields(const OutputReport*) {
    using R = OutputReport;
    return std::tuple{field("file", &R::file),         field("outcome", &R::outcome),
                      field("kind", &R::kind),         field("properties", &R::properties),
                      field("warnings", &R::warnings), field("doubts", &R::doubts),
                      field("sha256", &R::sha256),     field("bytes", &R::bytes)};
}

struct CellReport {
    Outcome outcome = Outcome::skipped;
    Failure failure;     ///< of the first failed node, else of the first failed output
    std::optional<std::size_t> failed_node;  ///< whose failure it is, by index into RunGraph::nodes
    double seconds = 0;  ///< sum over its nodes and outputs; nodes that cells share count for each
    std::vector<OutputReport> outputs;
    std::vector<std::string> doubts;  ///< from doubts_about(), and of its outputs
};

struct RunReport {
    std::vector<NodeReport> nodes;  ///< by index into RunGraph::nodes
    std::vector<CellReport> cells;  ///< by index into RunGraph::cells
    bool interrupted = false;

    /// That of its worst cell; skipped cells count as failed; ok without cells.
    Outcome outcome() const;
    /// Whether a cell failed for a fault of the program.
    bool has_fault() const;
};

/// The doubts about these outputs and about all values that they are made from, each with the label of its step.
/// Pre: `nodes` contains all nodes that the outputs are made from.
std::vector<std::string> doubts_about(const std::vector<RunOutput>& outputs, const std::vector<std::size_t>& nodes,
                                      const RunGraph& graph, const std::vector<NodeReport>& reports);

}  // namespace scanmill
