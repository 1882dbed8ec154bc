// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Running a graph in this process: every node at most once, scan after scan, what the cache knows not at all. Values
/// are dropped after their last use, outputs written whole or not at all. A failing node fails the cells that need it;
/// everything else goes on.

#include <functional>
#include <string>
#include <vector>

#include "scanmill/cache/cache.hpp"
#include "scanmill/cache/keep_rule.hpp"
#include "scanmill/engine/foresight.hpp"
#include "scanmill/engine/graph.hpp"

namespace scanmill {

struct RunSettings {
    unsigned threads = 1;  ///< for every filter; results do not depend on it
    std::uint64_t seed = 0;
    std::function<bool()> is_cancelled;
    Cache* cache = nullptr;  ///< none: everything is computed, nothing is kept
    KeepRule::Policy keep = KeepRule::Policy::worth;
    std::vector<NodeForesight> foresight = {};  ///< when it is known already
};

enum class Outcome { done, failed, skipped };  ///< skipped: something it needs failed, or the run was interrupted
std::string_view name_of(Outcome outcome);

/// Where a node's result came from.
enum class Origin {
    ran,
    cached,  ///< known before anything ran, by the plan key
    same_inputs  ///< known when the inputs were, by the run key: something upstream changed and made no difference
};
std::string_view name_of(Origin origin);

struct NodeReport {
    Outcome outcome = Outcome::skipped;
    Origin origin = Origin::ran;
    std::string why;  ///< it ran and was not taken from the cache
    std::string error;  ///< whole text with frames and hint
    double seconds = 0;
    double cpu_seconds = 0;  ///< of all threads
    ParameterSet resolved;  ///< as the filter got them: lengths in the scan's unit
    Metrics metrics;        ///< of the filter, in its declared order
    Metrics facts;  ///< of the primary output, or of the file that was read; only where something asked for them
    std::vector<std::string> warnings;
};

struct OutputReport {
    std::filesystem::path file;
    Outcome outcome = Outcome::skipped;
    Kind kind = Kind::points;
    Metrics facts;
    std::vector<std::string> warnings;
};

struct CellReport {
    Outcome outcome = Outcome::skipped;
    std::string error;  ///< of the first node that failed, or of writing an output
    double seconds = 0;  ///< of its nodes and of writing; nodes that cells share count for each
    std::vector<OutputReport> outputs;
};

struct RunReport {
    std::vector<NodeReport> nodes;  ///< by index into RunGraph::nodes
    std::vector<CellReport> cells;  ///< by index into RunGraph::cells
    bool interrupted = false;

    bool all_done() const;
};

/// Told of what happens while it happens; every call comes from the running thread but progress.
class RunObserver {
public:
    virtual ~RunObserver() = default;
    virtual void node_started(const RunNode&) {}
    virtual void node_progress(const RunNode&, double /*fraction*/) {}
    virtual void node_warning(const RunNode&, std::string_view /*text*/) {}
    virtual void node_ended(const RunNode&, const NodeReport&) {}
    virtual void output_written(const RunCell&, const OutputReport&) {}
    virtual void cell_ended(const RunCell&, const CellReport&) {}
};

RunReport run(const Plan& plan, FilterLibrary& library, const RunGraph& graph, const RunRequest& request,
              const RunSettings& settings, RunObserver& observer);

}  // namespace scanmill
