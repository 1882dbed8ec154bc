// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The header of a PLY file: which elements follow, how many, with which properties.
///
/// Lines may end with LF, CRLF or CR, whichever ends the first. All spellings of the types are known (char and int8 to
/// double and float64, 64-bit integers too). Nothing that a header promises is believed: see require_room().

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/columns.hpp"

namespace scanmill {

struct PlyProperty {
    std::string name;
    ScalarType type;
    /// Of a list: the type of its length, an integer.
    std::optional<ScalarType> count_type;

    bool is_list() const { return count_type.has_value(); }
};

struct PlyElement {
    std::string name;
    u64 count = 0;
    std::vector<PlyProperty> properties;

    /// nullptr when there is none.
    const PlyProperty* find(std::string_view property) const;
    bool has_lists() const;
};

enum class PlyEncoding { ascii, binary_little_endian, binary_big_endian };

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::ascii;
    std::vector<PlyElement> elements;
    /// The text of comment and obj_info lines, in order.
    std::vector<std::string> comments;
    std::size_t size = 0;   ///< bytes, up to the first of the body
    std::size_t lines = 0;  ///< in the header
};

/// Throws Error with the line number of what is wrong.
PlyHeader parse_ply_header(std::string_view file);

/// Throws Error when `left` bytes cannot hold the element's rows, each taken as short as it can be. Call before any
/// memory is taken for the element.
void require_room(const PlyElement& element, PlyEncoding encoding, std::size_t left);

}  // namespace scanmill
