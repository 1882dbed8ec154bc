// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/parallel.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#endif

namespace scanmill {

#ifdef __SANITIZE_THREAD__
namespace {

/// ThreadSanitizer does not see the synchronisation inside oneTBB and would report every task. It understands plain
/// threads.
void on_plain_threads(unsigned threads, std::size_t chunks, const std::function<void(std::size_t)>& run) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&] {
        try {
            for (std::size_t index; (index = next++) < chunks;) run(index);
        } catch (...) {
            next = chunks;
            const std::lock_guard lock(mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    std::vector<std::thread> others;
    for (unsigned i = 1; i < std::min<std::size_t>(threads, chunks); ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace
#endif

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
#ifdef __SANITIZE_THREAD__
    on_plain_threads(threads, chunks, run);
#else
    within_thread_budget(threads, [&] { tbb::parallel_for(std::size_t(0), chunks, run); });
#endif
}

void within_thread_budget(unsigned threads, const std::function<void()>& body) {
#ifdef __SANITIZE_THREAD__
    threads = 1;  // ThreadSanitizer would report every task
#endif
    // oneTBB prints a warning if an arena has more threads than the machine.
    tbb::task_arena arena(std::clamp(static_cast<int>(threads), 1, tbb::info::default_concurrency()));
    arena.execute(body);
}

}  // namespace scanmill
