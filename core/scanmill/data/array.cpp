// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/array.hpp"

#include <sys/mman.h>

namespace scanmill {

namespace {
constexpr std::size_t huge_page = std::size_t(2) << 20;
constexpr std::size_t large_block = 2 * huge_page;
constexpr std::align_val_t small_alignment{64};
constexpr std::align_val_t large_alignment{huge_page};
}  // namespace

void* allocate_block(std::size_t bytes) {
    if (bytes < large_block) return ::operator new(bytes, small_alignment);
    void* block = ::operator new(bytes, large_alignment);
    // Advice only: where the kernel refuses, ordinary pages serve.
    ::madvise(block, bytes, MADV_HUGEPAGE);
    return block;
}

void free_block(void* block, std::size_t bytes) noexcept {
    if (bytes < large_block)
        ::operator delete(block, small_alignment);
    else
        ::operator delete(block, large_alignment);
}

}  // namespace scanmill
