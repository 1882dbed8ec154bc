// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/array.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <limits>
#include <numeric>

namespace scanmill::test {
namespace {

std::size_t misalignment(const void* place, std::size_t alignment) {
    return reinterpret_cast<std::uintptr_t>(place) % alignment;
}

TEST(Block, AnySize_IsAlignedForEveryColumnType) {
    for (const std::size_t bytes : {1u, 7u, 64u, 4095u, 1u << 20}) {
        void* block = allocate_block(bytes);
        EXPECT_EQ(misalignment(block, 64), 0u) << bytes;
        free_block(block, bytes);
    }
}

TEST(Block, LargeOne_BeginsOnAHugePageAndIsWritableToItsEnd) {
    if (watched_memory) GTEST_SKIP() << "AddressSanitizer's heap has it";
    const std::size_t bytes = (std::size_t(4) << 20) + 1;
    auto* block = static_cast<std::byte*>(allocate_block(bytes));
    EXPECT_EQ(misalignment(block, std::size_t(2) << 20), 0u);
    block[0] = block[bytes - 1] = std::byte{1};
    free_block(block, bytes);
}

TEST(Block, MoreThanMemoryCanAddress_Throws) {
    EXPECT_THROW((void)allocate_block(std::numeric_limits<std::size_t>::max()), std::bad_alloc);
    EXPECT_THROW((void)allocate_block(std::size_t(1) << 62), std::bad_alloc);
}

TEST(Block, LargeOneGivenBack_LeavesTheProcess) {
    if (watched_memory) GTEST_SKIP() << "AddressSanitizer's heap has it";
    const auto is_mapped = [](void* place) {
        unsigned char residence = 0;
        return ::mincore(place, 1, &residence) == 0;
    };
    const std::size_t bytes = (std::size_t(6) << 20) + 5;
    auto* block = static_cast<std::byte*>(allocate_block(bytes));
    const std::size_t last = bytes / 4096 * 4096;
    EXPECT_TRUE(is_mapped(block) && is_mapped(block + last));
    free_block(block, bytes);
    EXPECT_FALSE(is_mapped(block) || is_mapped(block + last));
}

TEST(BlockDeathTest, WhatLiesBehindALargeOne_IsWatched) {
    if (!watched_memory) GTEST_SKIP() << "only AddressSanitizer watches memory";
    Array<int> numbers(600'000);
    EXPECT_DEATH(numbers.data()[numbers.size()] = 1, "AddressSanitizer");
}

TEST(Array, MoreElementsThanMemoryCanAddress_Throws) {
    UninitialisedAllocator<double> allocator;
    EXPECT_THROW(allocator.allocate(std::numeric_limits<std::size_t>::max() / 8 + 1), std::bad_array_new_length);
}

TEST(Array, GrowingAcrossTheHugePageBorder_KeepsItsElements) {
    Array<u32> numbers;
    constexpr u32 count = (5u << 20) / sizeof(u32);
    for (u32 i = 0; i < count; ++i) numbers.push_back(i);
    for (u32 i = 0; i < count; ++i) ASSERT_EQ(numbers[i], i);
}

TEST(Array, GivenValue_FillsEveryElement) {
    const Array<double> numbers(1000, 0.5);
    EXPECT_EQ(std::accumulate(numbers.begin(), numbers.end(), 0.0), 500);
}

TEST(Buffer, Default_IsEmpty) {
    const Buffer<double> nothing;
    EXPECT_TRUE(nothing.empty());
    EXPECT_EQ(nothing.size(), 0u);
    EXPECT_EQ(nothing.begin(), nothing.end());
}

TEST(Buffer, Copy_SharesTheElements) {
    const Buffer<u32> numbers{3, 1, 4};
    const Buffer<u32> copy = numbers;
    EXPECT_EQ(copy.data(), numbers.data());
    EXPECT_EQ(copy.size(), 3u);
    EXPECT_EQ(copy[2], 4u);
}

TEST(Buffer, FromAnArray_TakesItsMemory) {
    Array<u32> numbers{3, 1, 4};
    const u32* place = numbers.data();
    EXPECT_EQ(Buffer<u32>(std::move(numbers)).data(), place);
}

TEST(Buffer, View_KeepsItsOwnerAliveAsLongAsAnyCopy) {
    auto owner = std::make_shared<const std::vector<int>>(std::vector<int>{10, 20, 30, 40});
    const std::weak_ptr<const std::vector<int>> watched = owner;
    const int* middle = owner->data() + 1;
    auto view = std::make_unique<Buffer<int>>(std::move(owner), middle, 2);
    const auto copy = std::make_unique<Buffer<int>>(*view);
    view.reset();
    ASSERT_FALSE(watched.expired());
    EXPECT_EQ(std::vector<int>(copy->begin(), copy->end()), (std::vector<int>{20, 30}));
}

TEST(Buffer, LastCopyGone_LetsTheOwnerGo) {
    auto owner = std::make_shared<const int>(7);
    const std::weak_ptr<const int> watched = owner;
    {
        const Buffer<int> view(owner, owner.get(), 1);
        owner.reset();
    }
    EXPECT_TRUE(watched.expired());
}

TEST(Gather, RowsInAnyOrderAndRepeated_GiveThoseElementsInThatOrder) {
    const Buffer<double> source{0.5, 1.5, 2.5};
    const std::vector<u32> rows{2, 0, 2};
    const Buffer<double> picked = gather(source, rows);
    EXPECT_EQ(std::vector<double>(picked.begin(), picked.end()), (std::vector<double>{2.5, 0.5, 2.5}));
}

TEST(Gather, NoRows_GiveNothing) { EXPECT_TRUE(gather(Buffer<double>{1, 2}, {}).empty()); }

}  // namespace
}  // namespace scanmill::test
