// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Predicts what a run will do: which nodes the cache has, which will run, and why.

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
    std::string why;  ///< why it will run, as a part of a sentence; empty for a node that will not run
    std::set<std::string> needed;  ///< output ports whose values are needed
};

/// Predicts each node. A node runs if its result is not in the cache, or if a value of it that is needed (for
/// an output, an expectation or a step that runs) is not in the cache. `policy` of this run is part of the reason why a
/// value is missing. `cache` may be null.
std::vector<NodePrediction> predict(const RunGraph& graph, const Cache* cache,
                                    KeepRule::Policy policy = KeepRule::Policy::worth);

}  // namespace scanmill
