// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The header of a PCD file, checked before PCL, which trusts it, allocates memory for the points it declares; and the
/// types of its fields.

#include <pcl/PCLPointField.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

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
    std::string viewpoint;  ///< as written; empty when absent
    bool has_viewpoint = false;  ///< not at the origin, or rotated
    Vec3 sensor = Vec3::Zero();  ///< its position
    u64 bytes_behind = 0;  ///< after the last point, unless all are zero; 0 for ascii
};

/// Throws Error when the header is malformed, contradicts itself, or declares more than the bytes of the file can hold.
PcdHeader checked_header(std::string_view bytes);

std::string_view name_of(PcdHeader::Encoding encoding);

/// Empty for a datatype that PCL does not define.
std::optional<ScalarType> scalar_type(std::uint8_t datatype);
std::uint8_t datatype(ScalarType type);

}  // namespace scanmill::pcd
