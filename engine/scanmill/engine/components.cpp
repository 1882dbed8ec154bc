// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/components.hpp"

#include <numeric>

namespace scanmill {

Components components_of(const RunGraph& graph) {
    const std::size_t size = graph.nodes.size();
    std::vector<std::size_t> parent(size);
    std::iota(parent.begin(), parent.end(), std::size_t(0));
    const auto root = [&](std::size_t node) {
        while (parent[node] != node) node = parent[node] = parent[parent[node]];
        return node;
    };
    std::vector<bool> is_taken(size, false);  // a file belongs to the first that reads it
    for (std::size_t node = 0; node < size; ++node)
        for (const NodeInput& input : graph.nodes[node].inputs) {
            if (!graph.nodes[input.node].step) {
                if (is_taken[input.node]) continue;
                is_taken[input.node] = true;
            }
            // The smaller number leads, so that a root is the first of its component.
            const std::size_t a = root(node), b = root(input.node);
            parent[std::max(a, b)] = std::min(a, b);
        }
    Components found{std::vector<std::size_t>(size), 0};
    for (std::size_t node = 0; node < size; ++node)
        found.of_node[node] = root(node) == node ? found.count++ : found.of_node[root(node)];
    return found;
}

}  // namespace scanmill
