// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What became of a run: of every node, every cell and every file that was to be written.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/filter/parameter.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

enum class Outcome { done, failed, skipped };  ///< skipped: something it needs failed, or the run was interrupted
std::string_view name_of(Outcome outcome);

/// Where a node's result came from.
enum class Origin {
    ran,
    cached,  ///< known before anything ran, by the plan key
    same_inputs  ///< known when the inputs were, by the run key: something upstream changed and made no difference
};
std::string_view name_of(Origin origin);

/// What kind of failure it was.
enum class Cause {
    none,
    refused,      ///< the filter, or a reader, said what is wrong
    expectation,  ///< the result is not what `expect` asks for
    exception,    ///< something that is no Error was thrown
    memory,       ///< more memory was asked for than the limit, or the machine, has
    time,         ///< the limit of time passed
    signal,       ///< the worker process was ended by a signal
    exit,         ///< the worker process ended itself
    output        ///< a file could not be written
};
std::string_view name_of(Cause cause);

struct Failure {
    Cause cause = Cause::none;
    int number = 0;  ///< the signal, or the exit code
    std::string text;  ///< whole, with frames and hint

    explicit operator bool() const { return cause != Cause::none; }
};

/// What doing something cost, and what was heard meanwhile.
struct Effort {
    double seconds = 0;
    double cpu_seconds = 0;  ///< of all threads
    u64 peak_memory = 0;  ///< most resident bytes of the process; 0: not known
    unsigned threads = 0;  ///< that it was given
    std::vector<std::string> log;  ///< the last lines on its standard output and error
};

struct NodeReport {
    Outcome outcome = Outcome::skipped;
    Origin origin = Origin::ran;
    std::string why;  ///< it ran and was not taken from the cache
    Failure failure;
    Effort effort;
    unsigned attempts = 0;  ///< times that it was begun
    ParameterSet resolved;  ///< as the filter got them: lengths in the scan's unit
    Metrics metrics;        ///< of the filter, in its declared order
    Metrics properties;  ///< of the primary output, or of the file that was read; only where something asked for them
    std::vector<std::string> warnings;
};

struct OutputReport {
    std::filesystem::path file;
    Outcome outcome = Outcome::skipped;
    Kind kind = kind_of<PointCloud>();
    Metrics properties;
    std::vector<std::string> warnings;
};

struct CellReport {
    Outcome outcome = Outcome::skipped;
    Failure failure;  ///< of the first node that failed, or of writing an output
    double seconds = 0;  ///< of its nodes and of writing; nodes that cells share count for each
    std::vector<OutputReport> outputs;
};

struct RunReport {
    std::vector<NodeReport> nodes;  ///< by index into RunGraph::nodes
    std::vector<CellReport> cells;  ///< by index into RunGraph::cells
    bool interrupted = false;

    bool all_done() const;
};

}  // namespace scanmill
