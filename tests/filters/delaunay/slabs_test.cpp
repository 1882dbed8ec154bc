// SPDX-License-Identifier: GPL-3.0-or-later
// The allocator of the triangulations.

#include <gtest/gtest.h>

#include <cstring>

#include "delaunay/slab_allocator.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

TEST(Slabs, BlocksOfAllSizes_AreAlignedAndShareNothing) {
    Slabs slabs;
    Random random(1);
    std::vector<std::pair<unsigned char*, std::size_t>> blocks;
    for (std::size_t i = 0; i < 500; ++i) {
        // Some are larger than a slab.
        const std::size_t bytes = i % 100 == 99 ? Slabs::largest_slab + i : 1 + random.index(60'000);
        auto* block = static_cast<unsigned char*>(slabs.allocate(bytes));
        ASSERT_EQ(reinterpret_cast<std::uintptr_t>(block) % 64, 0u);
        std::memset(block, static_cast<int>(i % 251), bytes);
        blocks.emplace_back(block, bytes);
    }
    for (std::size_t i = 0; i < blocks.size(); ++i)
        for (std::size_t k = 0; k < blocks[i].second; ++k) ASSERT_EQ(blocks[i].first[k], i % 251) << i;
    for (std::size_t i = 0; i < blocks.size(); ++i) slabs.deallocate();
    EXPECT_EQ(slabs.bytes(), 0u);
}

TEST(Slabs, FreeingTheLastBlock_ReleasesAllMemory) {
    Slabs slabs;
    for (int round = 0; round < 2; ++round) {
        slabs.allocate(1000);
        slabs.allocate(100'000);
        const std::size_t bytes = slabs.bytes();
        EXPECT_GE(bytes, 101'000u);
        slabs.deallocate();
        EXPECT_EQ(slabs.bytes(), bytes);
        slabs.deallocate();
        EXPECT_EQ(slabs.bytes(), 0u);
    }
}

TEST(Slabs, SmallBlocks_TakeNoMoreThanTwiceTheirSizeAndALeastSlab) {
    Slabs slabs;
    std::size_t asked = 0;
    for (int i = 0; i < 3000; ++i, asked += 640) {
        slabs.allocate(640);
        ASSERT_LE(slabs.bytes(), 2 * (asked + 640) + Slabs::least_slab);
    }
    for (int i = 0; i < 3000; ++i) slabs.deallocate();
}

TEST(SlabAllocator, CopiesShareAndOthersDoNot) {
    const SlabAllocator<double> one, other;
    const SlabAllocator<int> copy(one);
    EXPECT_TRUE(copy == one);
    EXPECT_FALSE(other == one);
    std::vector<double, SlabAllocator<double>> numbers(one);
    for (int i = 0; i < 10'000; ++i) numbers.push_back(i);
    for (int i = 0; i < 10'000; ++i) ASSERT_EQ(numbers[static_cast<std::size_t>(i)], i);
    EXPECT_GT(copy.slabs()->bytes(), 0u);
    EXPECT_EQ(other.slabs()->bytes(), 0u);
}

TEST(SlabAllocator, OfAVectorThatWasMovedFrom_StillAllocates) {
    std::vector<double, SlabAllocator<double>> numbers(100, 1.5);
    const auto moved = std::move(numbers);
    EXPECT_EQ(moved.size(), 100u);
    EXPECT_TRUE(numbers.get_allocator() == moved.get_allocator());
    numbers.assign(1000, 2.5);
    EXPECT_EQ(numbers.back(), 2.5);
}

TEST(SlabAllocator, MoreThanMemoryCanAddress_Throws) {
    SlabAllocator<double> allocator;
    EXPECT_THROW((void)allocator.allocate(std::size_t(-1) / 8), std::bad_array_new_length);
}

}  // namespace
}  // namespace scanmill
