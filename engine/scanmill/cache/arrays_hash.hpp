// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The hash of a value's arrays as they lie in its file: one after the other, each followed by zeros up to a multiple
/// of value_alignment. An array may come in one part or in many, so that it never need be in memory as a whole.

#include <array>
#include <cstddef>
#include <memory>
#include <span>

struct XXH3_state_s;

namespace scanmill {

class ArraysHash {
public:
    ArraysHash();
    ArraysHash(ArraysHash&&) = default;
    ArraysHash& operator=(ArraysHash&&) = default;
    ~ArraysHash();

    /// The next bytes of the array that was begun last; the first call begins one.
    void add(std::span<const std::byte> part);
    /// What is added from now on belongs to the next array.
    void end_array();
    /// 128-bit XXH3 of all arrays that were ended, most significant byte first.
    std::array<std::byte, 16> digest() const;

private:
    struct Free {
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> state_;
    std::size_t array_bytes_ = 0;
};

}  // namespace scanmill
