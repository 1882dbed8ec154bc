// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a run will do, known before it begins: which nodes the cache has already, which will run, and why.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scanmill/cache/cache.hpp"
#include "scanmill/cache/keep_rule.hpp"
#include "scanmill/graph/graph.hpp"

namespace scanmill {

struct NodePrediction {
    std::optional<StepResult> known;  ///< what the cache remembers of the node, under its plan key
    bool will_run = true;
    std::string why;  ///< it will run, as a part of a sentence; empty for a node that will not
    std::set<std::string> needed;  ///< output ports whose values somebody needs
};

/// For every node of the graph. Nothing is remembered without a cache. A node runs when the cache does not know it, or
/// when a value of it is needed that was not kept: by an output to be written, an expectation, or a step that runs.
/// `policy` is what this run keeps: where a value is missing, the reason depends on it.
std::vector<NodePrediction> predict(const RunGraph& graph, const Cache* cache,
                                    KeepRule::Policy policy = KeepRule::Policy::worth);

}  // namespace scanmill
