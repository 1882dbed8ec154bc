// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The header of a PCD file, and the types of its fields. PCL trusts the header, so it is checked before PCL allocates
/// memory for the points that it declares.

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
    u64 row_bytes = 0;    ///< bytes of one point
    u64 row_numbers = 0;  ///< numbers of one point
    std::size_t body = 0;  ///< byte where the points begin
    std::size_t lines = 0;  ///< lines of the header
    std::vector<std::string> comments;
    std::string viewpoint;  ///< as written; empty when absent
    bool has_viewpoint = false;  ///< whether the VIEWPOINT is not at the origin, or is rotated
    Vec3 sensor = Vec3::Zero();  ///< position of the sensor
    u64 bytes_behind = 0;  ///< bytes after the last point; 0 if all are zero, and for ascii
};

/// Throws Error when the header is malformed, contradicts itself, or declares more than the bytes of the file can hold.
PcdHeader checked_header(std::string_view bytes);

std::string_view name_of(PcdHeader::Encoding encoding);

/// The type with this PCL number; empty for a number that PCL does not define.
std::optional<ScalarType> scalar_type(std::uint8_t datatype);
std::uint8_t datatype(ScalarType type);

}  // namespace scanmill::pcd
