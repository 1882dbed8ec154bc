// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/parallel.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>

namespace scanmill {

void for_each_chunk(unsigned threads, std::size_t count, std::size_t chunk,
                    const std::function<void(std::size_t begin, std::size_t end)>& body) {
    assert(chunk > 0);
    const std::size_t chunks = count / chunk + (count % chunk == 0 ? 0 : 1);
    const auto run = [&](std::size_t index) {
        const std::size_t begin = index * chunk;
        body(begin, begin + std::min(chunk, count - begin));
    };
    if (threads <= 1 || chunks <= 1) {
        for (std::size_t index = 0; index < chunks; ++index) run(index);
        return;
    }
    within_thread_budget(threads, [&] { tbb::parallel_for(std::size_t(0), chunks, run); });
}

void within_thread_budget(unsigned threads, const std::function<void()>& body) {
    // More threads than the machine has would only make the library complain.
    tbb::task_arena arena(std::clamp(static_cast<int>(threads), 1, tbb::info::default_concurrency()));
    arena.execute(body);
}

}  // namespace scanmill
