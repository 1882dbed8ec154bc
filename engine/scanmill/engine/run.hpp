// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Running a graph: every node at most once, by one or more workers, what the cache knows not at all. Values are
/// dropped after their last use, outputs written whole or not at all. A failing node fails the cells that need it;
/// everything else goes on.

#include <functional>
#include <string>
#include <vector>

#include "scanmill/batch/limits.hpp"
#include "scanmill/cache/cache.hpp"
#include "scanmill/engine/foresight.hpp"
#include "scanmill/engine/graph.hpp"
#include "scanmill/engine/report.hpp"
#include "scanmill/work/workers.hpp"

namespace scanmill {

struct RunSettings {
    unsigned threads = 1;  ///< for every filter; results do not depend on it
    Limits limits;
    bool fail_fast = false;  ///< nothing new is begun once a cell has failed
    std::function<bool()> is_cancelled;
    Cache* cache = nullptr;  ///< none: everything is computed, nothing is kept
    /// Values that several steps wait for are kept whatever that costs: other workers can then help out, and a crash
    /// in one step takes nothing from the others.
    bool shares_values = false;
    std::vector<NodeForesight> foresight = {};  ///< when it is known already
};

/// Told of what happens while it happens. Every call comes from the running thread, but progress and warnings of a
/// worker in this process.
class RunObserver {
public:
    virtual ~RunObserver() = default;
    virtual void node_started(const RunNode&, std::size_t /*worker*/) {}
    virtual void node_progress(const RunNode&, double /*fraction*/) {}
    virtual void node_warning(const RunNode&, std::string_view /*text*/) {}
    virtual void node_ended(const RunNode&, const NodeReport&) {}
    virtual void output_started(const RunCell&, const RunOutput&, std::size_t /*worker*/) {}
    virtual void output_written(const RunCell&, const OutputReport&) {}
    virtual void cell_ended(const RunCell&, const CellReport&) {}
    /// Several times a second while something runs.
    virtual void time_passed() {}
};

/// Outputs and what is said of them do not depend on the number of workers.
RunReport run(FilterLibrary& library, const RunGraph& graph, Workers& workers, const RunSettings& settings,
              RunObserver& observer);

}  // namespace scanmill
