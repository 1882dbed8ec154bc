// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Reports of a run about every node, every cell and every output file.

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
    fault         ///< an error of the program: a filter broke its declaration
};
constexpr std::array<std::string_view, 10> names_of(const Cause*) {
    return {"", "refused", "expectation", "exception", "memory", "time", "signal", "exit", "output", "fault"};
}

struct Failure {
    Cause cause = Cause::none;
    int number = 0;  ///< number of the signal, or the exit code
    Error error{std::string()};  ///< with frames up to the step
    std::string scan;  ///< name of the cell's scan; empty: the error's sentence names it
    std::string equal_scan;  ///< another scan of equal content, on which the step ran; empty: it ran on `scan`

    explicit operator bool() const { return cause != Cause::none; }
    /// The error with a frame for the scan.
    Error whole() const;
};
constexpr auto fields(const Failure*) {
    using R = Failure;
    return std::tuple{field("cause", &R::cause), field("number", &R::number), field("error", &R::error),
                      field("scan", &R::scan), field("equal-scan", &R::equal_scan)};
}

/// Whether another run of the same work may succeed on a machine with more memory or another disk. That is so if memory
/// ran out although the step had no limit, if the system killed the worker process, as it does when memory runs out,
/// and if a disk was full or broken.
bool is_of_machine(const Failure& failure);

/// Resources that a job used, and the log of its process.
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
        field("log", &R::log, "Last lines that the process wrote to standard output and standard error.").optional()};
}

struct NodeReport {
    Outcome outcome = Outcome::skipped;
    Origin origin = Origin::ran;
    std::string why;  ///< why the node ran instead of being taken from the cache
    Failure failure;
    Effort effort;
    unsigned attempts = 0;
    ParameterSet resolved;  ///< parameters as the filter got them: lengths in the scan's unit
    Metrics metrics;  ///< the filter's metrics, in declared order
    Metrics properties;  ///< properties of the primary output or the file read; empty unless requested
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
    std::vector<std::string> doubts;  ///< doubts about the file because it holds less than the value
    std::string sha256;  ///< hash of the file's bytes; empty: not written
    u64 bytes = 0;  ///< size of the file
    std::filesystem::path moved_to;  ///< new path of the file of an earlier run; empty: not moved
    std::string not_moved;  ///< why the file of an earlier run could not be moved; empty: no such error
    std::filesystem::path evidence;  ///< failed_of() the file, if it was written there; otherwise empty
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
    Failure failure;  ///< failure of the first failed node, or else of the first failed output
    std::optional<std::size_t> failed_node;  ///< index into RunGraph::nodes of the node with this failure
    double seconds = 0;  ///< sum over the cell's nodes and outputs; shared nodes count in every cell
    std::vector<OutputReport> outputs;
    std::vector<std::string> doubts;  ///< from doubts_about() and from OutputReport::doubts
};

struct RunReport {
    std::vector<NodeReport> nodes;  ///< by index into RunGraph::nodes
    std::vector<CellReport> cells;  ///< by index into RunGraph::cells
    bool interrupted = false;

    /// The outcome of the worst cell. Skipped cells count as failed. A run without cells is ok.
    Outcome outcome() const;
    /// Whether an error of the program (Cause::fault) made a cell fail.
    bool has_fault() const;
    /// Whether is_of_machine() holds for the failure of a cell.
    bool has_machine_failure() const;
};

/// The expectations that the nodes of these cells do not meet, each with the label of its step.
std::vector<std::string> unmet_by(const std::vector<std::size_t>& cells, const RunGraph& graph,
                                  const std::vector<NodeReport>& reports);

/// The doubts about these outputs and about all values that they are made from, each with the label of its step.
/// Pre: `nodes` contains all nodes that the outputs are made from.
std::vector<std::string> doubts_about(const std::vector<RunOutput>& outputs, const std::vector<std::size_t>& nodes,
                                      const RunGraph& graph, const std::vector<NodeReport>& reports);

}  // namespace scanmill
