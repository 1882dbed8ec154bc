// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Gathers small pieces of output, binary or text, into large ones for a file or memory.
///
/// Binary numbers are little-endian on every machine. Numbers in text are the shortest that read back equal, in any
/// locale.

#include <array>
#include <bit>
#include <charconv>
#include <concepts>
#include <cstring>
#include <functional>
#include <string_view>
#include <vector>

namespace scanmill {

/// The same number with its bytes reversed.
template <class T>
T byte_swapped(T number) {
    std::array<std::byte, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &number, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    std::memcpy(&number, bytes.data(), sizeof(T));
    return number;
}

class OutputBuffer {
public:
    using Sink = std::function<void(std::string_view)>;
    explicit OutputBuffer(Sink sink) : sink_(std::move(sink)), space_(capacity) {}

    void text(std::string_view piece) {
        if (piece.size() < capacity) {
            std::memcpy(room(piece.size()), piece.data(), piece.size());
        } else {
            flush();
            sink_(piece);
        }
    }
    /// A number as text.
    template <class Number>
    void number(Number value) {
        constexpr std::size_t longest = 32;
        char* const begin = room(longest);
        const auto result = std::to_chars(begin, begin + longest, value);
        used_ -= static_cast<std::size_t>(begin + longest - result.ptr);
    }
    /// A number as little-endian bytes.
    template <class Number>
    void binary(Number value) {
        if constexpr (std::endian::native == std::endian::big) value = byte_swapped(value);
        std::memcpy(room(sizeof(Number)), &value, sizeof(Number));
    }
    /// Room for `size` bytes that the caller fills before the next call.
    char* room(std::size_t size) {
        if (space_.size() - used_ < size) make_room(size);
        char* const begin = space_.data() + used_;
        used_ += size;
        return begin;
    }
    void flush() {
        sink_({space_.data(), used_});
        used_ = 0;
    }

private:
    void make_room(std::size_t size) {
        flush();
        if (space_.size() < size) space_ = std::vector<char>(size);
    }

    static constexpr std::size_t capacity = std::size_t(1) << 18;
    Sink sink_;
    std::vector<char> space_;
    std::size_t used_ = 0;
};

/// The number stored as little-endian bytes, on every machine. Pre: `source` has sizeof(T) bytes.
template <class T>
T little_endian(const char* source) {
    T number;
    std::memcpy(&number, source, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) number = byte_swapped(number);
    return number;
}

}  // namespace scanmill
