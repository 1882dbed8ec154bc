// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/parallel.hpp"

#include <gtest/gtest.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "scanmill/filter/context.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using Chunks = std::vector<std::pair<std::size_t, std::size_t>>;

/// The borders of all chunks, sorted.
Chunks chunks_of(unsigned threads, std::size_t count, std::size_t chunk) {
    std::mutex mutex;
    Chunks chunks;
    for_each_chunk(threads, count, chunk, [&](std::size_t begin, std::size_t end) {
        const std::scoped_lock lock(mutex);
        chunks.emplace_back(begin, end);
    });
    std::ranges::sort(chunks);
    return chunks;
}

TEST(ForEachChunk, HandComputedBorders) {
    EXPECT_EQ(chunks_of(1, 10, 4), (Chunks{{0, 4}, {4, 8}, {8, 10}}));
    EXPECT_EQ(chunks_of(1, 8, 4), (Chunks{{0, 4}, {4, 8}}));
    EXPECT_EQ(chunks_of(1, 3, 4), (Chunks{{0, 3}}));
    EXPECT_EQ(chunks_of(1, 0, 4), Chunks{});
}

TEST(ForEachChunk, Borders_DoNotDependOnTheThreads) {
    for (const auto& [count, chunk] :
         {std::pair<std::size_t, std::size_t>{1000, 7}, {64, 64}, {65, 64}, {5, 1}, {0, 3}})
        for (const unsigned threads : {0u, 2u, 3u, 8u})
            EXPECT_EQ(chunks_of(threads, count, chunk), chunks_of(1, count, chunk))
                << count << ' ' << chunk << ' ' << threads;
}

TEST(ForEachChunk, EveryIndex_IsVisitedOnce) {
    for (const unsigned threads : {1u, 2u, 5u}) {
        std::vector<std::atomic<int>> visits(100'003);
        for_each_chunk(threads, visits.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        EXPECT_TRUE(std::ranges::all_of(visits, [](const auto& count) { return count == 1; })) << threads;
    }
}

TEST(ForEachChunk, ChunkOfAnySize_IsOneChunk) {
    EXPECT_EQ(chunks_of(1, 10, std::numeric_limits<std::size_t>::max()), (Chunks{{0, 10}}));
    EXPECT_EQ(chunks_of(2, 10, std::numeric_limits<std::size_t>::max() - 5), (Chunks{{0, 10}}));
}

TEST(ForEachChunk, BudgetOfOne_StaysInTheCallingThreadAndInOrder) {
    std::vector<std::size_t> begins;
    std::set<std::thread::id> threads;
    for_each_chunk(1, 100, 10, [&](std::size_t begin, std::size_t) {
        threads.insert(std::this_thread::get_id());
        begins.push_back(begin);
    });
    EXPECT_TRUE(std::ranges::is_sorted(begins));
    EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(ForEachChunk, NeverMoreThreadsThanTheBudget) {
    std::atomic<int> inside = 0, most = 0;
    for_each_chunk(2, 2000, 1, [&](std::size_t, std::size_t) {
        const int now = ++inside;
        for (int before = most; before < now && !most.compare_exchange_weak(before, now);) {
        }
        std::this_thread::yield();
        --inside;
    });
    EXPECT_LE(most, 2);
    EXPECT_GE(most, 1);
}

TEST(ForEachChunk, ErrorOfTheBody_ReachesTheCallerWhole) {
    for (const unsigned threads : {1u, 4u}) {
        const Error error = error_of([&] {
            for_each_chunk(threads, 100, 1, [](std::size_t begin, std::size_t) {
                if (begin == 57) throw Error("point {} is bad", begin).hint("drop it");
            });
        });
        EXPECT_EQ(error.sentence(), "point 57 is bad") << threads;
        EXPECT_EQ(error.hint(), "drop it");
    }
}

TEST(ForEachChunk, Cancelling_ReachesTheCaller) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    const Context context(std::move(options));
    for (const unsigned threads : {1u, 4u})
        EXPECT_THROW(for_each_chunk(threads, 100, 1, [&](std::size_t, std::size_t) { context.check_cancelled(); }),
                     Cancelled);
}

TEST(ForEachChunk, LoopInALoop_VisitsEveryPairOnce) {
    std::vector<std::atomic<int>> visits(30 * 30);
    for_each_chunk(3, 30, 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            for_each_chunk(3, 30, 7, [&](std::size_t inner_begin, std::size_t inner_end) {
                for (std::size_t j = inner_begin; j < inner_end; ++j) ++visits[i * 30 + j];
            });
    });
    EXPECT_TRUE(std::ranges::all_of(visits, [](const auto& count) { return count == 1; }));
}

TEST(WithinThreadBudget, Body_SeesItsThreadsUpToThoseOfTheMachine) {
    for (const unsigned threads : {1u, 2u, 5u}) {
        int seen = 0;
        within_thread_budget(threads, [&] { seen = tbb::this_task_arena::max_concurrency(); });
        EXPECT_EQ(seen, std::min(static_cast<int>(threads), tbb::info::default_concurrency()));
    }
    int seen = 0;
    within_thread_budget(0, [&] { seen = tbb::this_task_arena::max_concurrency(); });
    EXPECT_EQ(seen, 1) << "nothing is one";
}

TEST(WithinThreadBudget, Exceptions_ReachTheCaller) {
    EXPECT_EQ(sentence_of([] {
                  within_thread_budget(2, [] {
                      tbb::parallel_for(0, 10, [](int i) {
                          if (i == 3) throw Error("inside");
                      });
                  });
              }),
              "inside");
}

}  // namespace
}  // namespace scanmill::test
