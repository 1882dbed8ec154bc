// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What must be known of a PCD header before PCL, which believes it, takes memory for what it promises.

#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/array.hpp"

namespace scanmill::pcd {

struct PcdHeader {
    enum class Encoding { ascii, binary, compressed };
    Encoding encoding = Encoding::ascii;
    u64 width = 0, height = 1;
    u64 points = 0;       ///< width × height
    u64 row_bytes = 0;    ///< of one point
    u64 row_numbers = 0;  ///< in one point
    std::size_t body = 0;  ///< where the points begin
    std::size_t lines = 0;  ///< of the header
    std::vector<std::string> comments;
    std::string viewpoint;  ///< as written; empty when there is none
    bool has_viewpoint = false;  ///< one that is not at the origin, or turned
    u64 bytes_behind = 0;  ///< the last point, but for zeros; in text there are none
};

/// Throws Error when the header is broken, contradicts itself, or promises more than the file's bytes can hold.
PcdHeader checked_header(std::string_view bytes);

std::string_view name_of(PcdHeader::Encoding encoding);

}  // namespace scanmill::pcd
