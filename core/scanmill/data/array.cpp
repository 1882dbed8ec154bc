// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/array.hpp"

#include <sys/mman.h>

#include <cassert>

namespace scanmill {

namespace {

constexpr std::size_t huge_page = std::size_t(2) << 20;
constexpr std::align_val_t small_alignment{64};
/// More than any process can address.
constexpr std::size_t most_addressable = std::size_t(1) << 56;

/// A multiple of every page size that kernels use.
constexpr std::size_t largest_page = std::size_t(64) << 10;

constexpr std::size_t whole_pages(std::size_t bytes) {
    return (bytes + largest_page - 1) / largest_page * largest_page;
}

void unmap(void* begin, std::size_t bytes) {
    [[maybe_unused]] const int result = ::munmap(begin, bytes);
    assert(result == 0);
}

/// A block from the kernel, aligned to a huge page. The heap would keep large freed blocks and split them into parts
/// that are too small for later requests.
void* map_block(std::size_t bytes) {
    const std::size_t size = whole_pages(bytes), mapped = size + huge_page;
    void* const all = ::mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED) throw std::bad_alloc();
    const auto begin = reinterpret_cast<std::uintptr_t>(all);
    const std::size_t before = (huge_page - begin % huge_page) % huge_page;
    char* const block = static_cast<char*>(all) + before;
    if (before > 0) unmap(all, before);
    unmap(block + size, huge_page - before);
    // Advice only: if the kernel refuses, ordinary pages are used.
    ::madvise(block, size, MADV_HUGEPAGE);
    return block;
}

}  // namespace

void* allocate_block(std::size_t bytes) {
    if (bytes > most_addressable) throw std::bad_alloc();
    return bytes < huge_page || watched_memory ? ::operator new(bytes, small_alignment) : map_block(bytes);
}

void free_block(void* block, std::size_t bytes) noexcept {
    if (bytes < huge_page || watched_memory)
        ::operator delete(block, small_alignment);
    else
        unmap(block, whole_pages(bytes));
}

}  // namespace scanmill
