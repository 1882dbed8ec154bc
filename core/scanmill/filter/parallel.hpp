// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parallel loops within a thread budget, cut into chunks whose borders do not depend on the number of threads.
///
/// Work that merges per-chunk results in chunk order gives the same bytes for any budget. With a budget of 1 everything
/// runs in the calling thread. Exceptions of the body reach the caller.

#include <cstddef>
#include <functional>

namespace scanmill {

/// Calls body(begin, end) for [0, chunk), [chunk, 2 chunk) … up to `count`, in any order and on up to `threads`
/// threads.
void for_each_chunk(unsigned threads, std::size_t count, std::size_t chunk,
                    const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Runs `body` where oneTBB sees `threads` threads (never more than the machine has): for libraries that parallelise
/// themselves.
void within_thread_budget(unsigned threads, const std::function<void()>& body);

}  // namespace scanmill
