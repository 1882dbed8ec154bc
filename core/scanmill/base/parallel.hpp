// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parallel loops within a thread budget, in chunks whose limits do not depend on the number of threads.
///
/// Code that merges per-chunk results in chunk order produces the same bytes for any budget. With a budget of 1
/// everything runs in the calling thread. Exceptions of the body are rethrown to the caller.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace scanmill {

/// Calls body(begin, end) for [0, chunk), [chunk, 2 chunk) … up to `count`, in any order and on up to `threads`
/// threads.
void for_each_chunk(unsigned threads, std::size_t count, std::size_t chunk,
                    const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Runs `body` in an arena in which oneTBB uses at most `threads` threads, and never more than the machine has. For
/// libraries that start parallel oneTBB tasks themselves.
void within_thread_budget(unsigned threads, const std::function<void()>& body);

/// Produces items in parallel and consumes them in order; only a few items exist at once. For results that depend on
/// the order, such as a hash, or that do not fit into memory together.
/// Calls produce(i, buffer) for 0 … count - 1 on up to `threads` threads, and consume(i, buffer) in this thread in
/// order. Exceptions of both functions are rethrown to the caller.
template <class Item, class Produce, class Consume>
void for_each_in_order(unsigned threads, std::size_t count, Produce&& produce, Consume&& consume) {
    constexpr std::size_t buffers_per_thread = 4;
    std::vector<Item> buffers(std::min(count, threads > 1 ? threads * buffers_per_thread : 1));
    for (std::size_t first = 0; first < count; first += buffers.size()) {
        const std::size_t items = std::min(buffers.size(), count - first);
        for_each_chunk(threads, items, 1, [&](std::size_t i, std::size_t) { produce(first + i, buffers[i]); });
        for (std::size_t i = 0; i < items; ++i) consume(first + i, buffers[i]);
    }
}

}  // namespace scanmill
