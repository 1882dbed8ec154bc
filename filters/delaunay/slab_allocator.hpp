// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Memory for a container that grows by many blocks and frees all of them at its end.
///
/// Blocks are cut from few large slabs. So they lie on huge pages, which saves address translations when pointers
/// through millions of cells are followed. When the last block is freed, all memory returns to the kernel, where a heap
/// would keep most of it.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "scanmill/data/array.hpp"

namespace scanmill {

/// Not thread-safe.
class Slabs {
public:
    static constexpr std::size_t least_slab = std::size_t(1) << 16, largest_slab = std::size_t(8) << 20;

    Slabs() = default;
    Slabs(const Slabs&) = delete;
    Slabs& operator=(const Slabs&) = delete;
    ~Slabs() { release(); }

    /// Aligned for any type; throws std::bad_alloc.
    void* allocate(std::size_t bytes) {
        const std::size_t size = (bytes + alignment - 1) / alignment * alignment;
        if (size > left_ || watched_memory) add_slab(size);
        void* const block = next_;
        next_ += size;
        left_ -= size;
        ++blocks_;
        return block;
    }
    /// The memory is released with the last block.
    void deallocate() noexcept {
        if (--blocks_ == 0) release();
    }

    /// The size of all slabs.
    std::size_t bytes() const { return bytes_; }

private:
    static constexpr std::size_t alignment = 64;

    struct Slab {
        void* block;
        std::size_t bytes;
    };

    /// Abandons the rest of the last slab. A new slab is as large as all earlier ones together, so that a small
    /// container takes little memory.
    void add_slab(std::size_t least) {
        const std::size_t size = watched_memory ? least : std::max(least, std::clamp(bytes_, least_slab, largest_slab));
        slabs_.reserve(slabs_.size() + 1);
        slabs_.push_back({allocate_block(size), size});
        next_ = static_cast<std::byte*>(slabs_.back().block);
        left_ = size;
        bytes_ += size;
    }
    void release() noexcept {
        for (const Slab& slab : slabs_) free_block(slab.block, slab.bytes);
        slabs_.clear();
        left_ = bytes_ = 0;
    }

    std::vector<Slab> slabs_;
    std::byte* next_ = nullptr;
    std::size_t left_ = 0, bytes_ = 0, blocks_ = 0;
};

/// Every default-constructed allocator has its own slabs; copies share them.
template <class T>
class SlabAllocator {
public:
    using value_type = T;

    SlabAllocator() : slabs_(std::make_shared<Slabs>()) {}
    /// Moving copies: an allocator that was moved from allocates as before.
    SlabAllocator(const SlabAllocator&) noexcept = default;
    SlabAllocator& operator=(const SlabAllocator&) noexcept = default;
    template <class Other>
    SlabAllocator(const SlabAllocator<Other>& other) noexcept : slabs_(other.slabs()) {}

    T* allocate(std::size_t count) {
        if (count > std::size_t(-1) / (2 * sizeof(T))) throw std::bad_array_new_length();
        return static_cast<T*>(slabs_->allocate(count * sizeof(T)));
    }
    void deallocate(T*, std::size_t) noexcept { slabs_->deallocate(); }

    const std::shared_ptr<Slabs>& slabs() const { return slabs_; }
    template <class Other>
    bool operator==(const SlabAllocator<Other>& other) const noexcept {
        return slabs_ == other.slabs();
    }

private:
    std::shared_ptr<Slabs> slabs_;
};

}  // namespace scanmill
