// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A value taken apart into a small header and its arrays, and put together again.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// Where arrays may begin.
constexpr std::size_t value_alignment = 64;
constexpr std::size_t aligned(std::size_t bytes) {
    return (bytes + value_alignment - 1) / value_alignment * value_alignment;
}

struct ValueFields {
    std::string header;  ///< CBOR
    /// In the order of their places: each begins at the next multiple of value_alignment after the one before.
    std::vector<std::span<const std::byte>> arrays;
};

ValueFields fields_of(const Value& value);

/// `arrays` are the bytes of all arrays, kept alive by `owner`, beginning on a multiple of value_alignment. Throws
/// Error for a header that is none, or with arrays beyond those bytes.
Value value_of(std::string_view header, std::string_view arrays, const std::shared_ptr<const void>& owner);

}  // namespace scanmill
