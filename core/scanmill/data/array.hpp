// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Memory for columns of scan data.
///
/// Array<T>   a std::vector whose new elements are uninitialised and whose large blocks use huge pages: filling 10^7
///            positions then needs no pass of zeros and no page fault per 4 KiB.
/// Buffer<T>  the read-only, shared memory of a finished value: owned, or a view of other memory (a mapped file).
///            Copying a Buffer copies no elements.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <new>
#include <span>
#include <utility>
#include <vector>

namespace scanmill {

using u8 = std::uint8_t;
using u32 = std::uint32_t;
using u64 = std::uint64_t;

/// Raw memory aligned for any column type; throws std::bad_alloc.
void* allocate_block(std::size_t bytes);
void free_block(void* block, std::size_t bytes) noexcept;

template <class T>
struct UninitialisedAllocator {
    using value_type = T;
    UninitialisedAllocator() = default;
    template <class U>
    UninitialisedAllocator(const UninitialisedAllocator<U>&) noexcept {}

    T* allocate(std::size_t count) {
        if (count > std::size_t(-1) / sizeof(T)) throw std::bad_array_new_length();
        return static_cast<T*>(allocate_block(count * sizeof(T)));
    }
    void deallocate(T* block, std::size_t count) noexcept { free_block(block, count * sizeof(T)); }

    template <class U>
    void construct(U* element) noexcept {
        ::new (static_cast<void*>(element)) U;  // no parentheses: leaves plain types uninitialised
    }
    template <class U, class... Arguments>
    void construct(U* element, Arguments&&... arguments) {
        ::new (static_cast<void*>(element)) U(std::forward<Arguments>(arguments)...);
    }
    template <class U>
    bool operator==(const UninitialisedAllocator<U>&) const noexcept {
        return true;
    }
};

template <class T>
using Array = std::vector<T, UninitialisedAllocator<T>>;

template <class T>
class Buffer {
public:
    Buffer() = default;
    Buffer(Array<T> elements) {
        auto owner = std::make_shared<const Array<T>>(std::move(elements));
        data_ = owner->data();
        size_ = owner->size();
        owner_ = std::move(owner);
    }
    Buffer(std::initializer_list<T> elements) : Buffer(Array<T>(elements.begin(), elements.end())) {}
    /// Views `size` elements at `data`, kept alive by `owner`.
    Buffer(std::shared_ptr<const void> owner, const T* data, std::size_t size)
        : owner_(std::move(owner)),
          data_(data),
          size_(size) {}

    const T* data() const { return data_; }
    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }
    const T& operator[](std::size_t index) const { return data_[index]; }
    std::span<const T> span() const { return {data_, size_}; }
    const std::shared_ptr<const void>& owner() const { return owner_; }

private:
    std::shared_ptr<const void> owner_;
    const T* data_ = nullptr;
    std::size_t size_ = 0;
};

/// The elements of `source` at `rows`, in that order.
template <class T>
Buffer<T> gather(const Buffer<T>& source, std::span<const u32> rows) {
    Array<T> picked(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) picked[i] = source[rows[i]];
    return picked;
}

// Whether this build contains AddressSanitizer. It checks only heap memory, so all blocks then come from the heap.

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool watched_memory = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool watched_memory = true;
#else
inline constexpr bool watched_memory = false;
#endif
#else
inline constexpr bool watched_memory = false;
#endif

}  // namespace scanmill
