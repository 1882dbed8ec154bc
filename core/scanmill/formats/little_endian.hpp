// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Numbers in the bytes of little-endian files, on every machine.

#include <bit>
#include <cstring>

#include "scanmill/formats/output_buffer.hpp"

namespace scanmill {

/// Pre: sizeof(T) bytes are there.
template <class T>
T little_endian(const char* source) {
    T number;
    std::memcpy(&number, source, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) number = byte_swapped(number);
    return number;
}

}  // namespace scanmill
