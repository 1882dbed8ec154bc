// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The outcome of a run: of every node, every cell and every output file.

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

namespace scanmill {

enum class Outcome {
    ok,
    doubtful,  ///< of a cell: complete, but a filter doubts its result
    failed,
    skipped  ///< an input failed, or the run was interrupted
};
std::string_view name_of(Outcome outcome);

/// Where a node's result came from.
enum class Origin {
    ran,
    cached,      ///< found by the plan key, before the run
    same_inputs  ///< found by the run key, during the run: an upstream change did not change the inputs
};
std::string_view name_of(Origin origin);

enum class Cause {
    none,
    refused,      ///< the filter or a reader threw an Error
    expectation,  ///< the result does not meet `expect`
    exception,    ///< another exception was thrown
    memory,       ///< the memory limit, or the machine's memory, was exceeded
    time,         ///< the time limit was exceeded
    signal,       ///< a signal ended the worker process
    exit,         ///< the worker process exited
    output        ///< a file could not be written
};
std::string_view name_of(Cause cause);

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

/// Resources that a job used, and what its process wrote.
struct Effort {
    double seconds = 0;
    double cpu_seconds = 0;  ///< of all threads
    u64 peak_memory = 0;     ///< largest resident size of the process in bytes; 0: unknown
    unsigned threads = 0;    ///< threads that the filter could use
    std::vector<std::string> log;  ///< the last lines on its standard output and error
};

struct NodeReport {
    Outcome outcome = Outcome::skipped;
    Origin origin = Origin::ran;
    std::string why;  ///< why it ran and was not taken from the cache
    Failure failure;
    Effort effort;
    unsigned attempts = 0;
    ParameterSet resolved;  ///< as the filter got them: lengths in the scan's unit
    Metrics metrics;        ///< of the filter, in its declared order
    Metrics properties;     ///< of the primary output, or of the file that was read; empty unless requested
    std::vector<std::string> warnings;
    std::vector<Doubt> doubts;
};

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

struct CellReport {
    Outcome outcome = Outcome::skipped;
    Failure failure;     ///< of the first node that failed, else of the first output
    std::optional<std::size_t> failed_node;  ///< whose failure it is, by index into RunGraph::nodes
    double seconds = 0;  ///< of its nodes and outputs; nodes that cells share count for each
    std::vector<OutputReport> outputs;
    std::vector<std::string> doubts;  ///< from doubts_about(), and of its outputs
};

struct RunReport {
    std::vector<NodeReport> nodes;  ///< by index into RunGraph::nodes
    std::vector<CellReport> cells;  ///< by index into RunGraph::cells
    bool interrupted = false;

    /// That of its worst cell; skipped cells count as failed; ok without cells.
    Outcome outcome() const;
};

/// The doubts about these outputs and about all values that they are made from, each with the label of its step.
/// Pre: `nodes` contains all nodes that the outputs are made from.
std::vector<std::string> doubts_about(const std::vector<RunOutput>& outputs, const std::vector<std::size_t>& nodes,
                                      const RunGraph& graph, const std::vector<NodeReport>& reports);

}  // namespace scanmill
