// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/memory_need.hpp"

#include <algorithm>

namespace scanmill {

u64 memory_need(const RunGraph& graph) {
    constexpr u64 times_the_file = 100, times_a_streamed_file = 4;
    u64 most = 0;
    for (const RunNode& node : graph.nodes) {
        if (!node.is_scan) continue;
        std::error_code gone;
        const u64 bytes = std::filesystem::file_size(node.leaf.file, gone);
        if (!gone) most = std::max(most, bytes * (node.leaf.is_streamed ? times_a_streamed_file : times_the_file));
    }
    return most;
}

}  // namespace scanmill
