// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>

namespace scanmill::test {
namespace {

TEST(ForEachInOrder, TakesEveryPieceOnceAndInOrder_InThisThread) {
    for (const unsigned threads : {1u, 2u, 5u})
        for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 100u}) {
            std::vector<std::size_t> taken, expected(count);
            std::iota(expected.begin(), expected.end(), std::size_t(0));
            const auto here = std::this_thread::get_id();
            for_each_in_order<std::size_t>(
                threads, count, [](std::size_t item, std::size_t& buffer) { buffer = item * item; },
                [&](std::size_t item, std::size_t buffer) {
                    EXPECT_EQ(buffer, item * item);
                    EXPECT_EQ(std::this_thread::get_id(), here);
                    taken.push_back(item);
                });
            EXPECT_EQ(taken, expected) << threads << " threads";
        }
}

TEST(ForEachInOrder, OneThread_UsesOneRoom) {
    std::set<const int*> buffers;
    for_each_in_order<int>(
        1, 20, [&](std::size_t, int& buffer) { buffers.insert(&buffer); }, [](std::size_t, int) {});
    EXPECT_EQ(buffers.size(), 1u);
}

TEST(ForEachInOrder, Exceptions_ReachTheCallerAndEndIt) {
    std::atomic<int> made = 0;
    const auto make = [&](std::size_t item, int&) {
        ++made;
        if (item == 10) throw std::runtime_error("ten");
    };
    EXPECT_THROW(for_each_in_order<int>(2, 1000, make, [](std::size_t, int) {}), std::runtime_error);
    EXPECT_LE(made, 16);
    EXPECT_THROW(for_each_in_order<int>(
                     2, 1000, [](std::size_t, int&) {}, [](std::size_t, int) { throw std::runtime_error("first"); }),
                 std::runtime_error);
}

}  // namespace
}  // namespace scanmill::test
