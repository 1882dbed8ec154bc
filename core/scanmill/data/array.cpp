// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/array.hpp"

#include <sys/mman.h>

#include <limits>

namespace scanmill {

namespace {

constexpr std::size_t page = 4096, huge_page = std::size_t(2) << 20;
constexpr std::align_val_t small_alignment{64};

constexpr std::size_t whole_pages(std::size_t bytes) { return (bytes + page - 1) / page * page; }

/// From the kernel, where it begins on a huge page. The heap would keep large blocks that were given back, in pieces
/// that no later one fits into.
void* map_block(std::size_t bytes) {
    if (bytes > std::numeric_limits<std::size_t>::max() - 2 * huge_page) throw std::bad_alloc();
    const std::size_t size = whole_pages(bytes), mapped = size + huge_page;
    void* const all = ::mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED) throw std::bad_alloc();
    const auto begin = reinterpret_cast<std::uintptr_t>(all);
    const std::size_t before = (huge_page - begin % huge_page) % huge_page;
    char* const block = static_cast<char*>(all) + before;
    if (before > 0) ::munmap(all, before);
    if (before < huge_page) ::munmap(block + size, huge_page - before);
    // Advice only: where the kernel refuses, ordinary pages serve.
    ::madvise(block, size, MADV_HUGEPAGE);
    return block;
}

}  // namespace

void* allocate_block(std::size_t bytes) {
    return bytes < huge_page ? ::operator new(bytes, small_alignment) : map_block(bytes);
}

void free_block(void* block, std::size_t bytes) noexcept {
    if (bytes < huge_page)
        ::operator delete(block, small_alignment);
    else
        ::munmap(block, whole_pages(bytes));
}

}  // namespace scanmill
