// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which nodes of a graph depend on each other, directly or not. Files that are read do not join what reads them: who
/// needs one can read it again.

#include "scanmill/graph/graph.hpp"

namespace scanmill {

struct Components {
    std::vector<std::size_t> of_node;  ///< numbered in the order of their first nodes
    std::size_t count = 0;
};

Components components_of(const RunGraph& graph);

}  // namespace scanmill
