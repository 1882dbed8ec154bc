// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Predicts which nodes of a graph will run, which the cache already has, and why.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scanmill/cache/cache.hpp"
#include "scanmill/graph/graph.hpp"

namespace scanmill {

struct NodePrediction {
    std::optional<StepResult> cached;  ///< the node's result in the cache, found by its plan key
    bool will_run = true;
    std::string why;  ///< reason why the node will run, for the end of a sentence; empty if it will not run
    std::set<std::string> needed;  ///< output ports whose values are needed
};

/// Predicts each node. A node runs if its result or a needed value of it is not in the cache. A value is needed for an
/// output, for an expectation, and for a step that runs. The `policy` of this run helps to explain why a value is
/// missing. `cache` may be null.
std::vector<NodePrediction> predict(const RunGraph& graph, const Cache* cache,
                                    KeepRule::Policy policy = KeepRule::Policy::worth);

}  // namespace scanmill
