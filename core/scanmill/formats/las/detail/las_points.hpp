// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Extra bytes of LAS points: what a file's own description calls them.

#include <array>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/formats/las/detail/las_header.hpp"

namespace scanmill {

struct LasExtra {
    std::string name;
    ScalarType type = ScalarType::uint8;
    u32 components = 1;
    std::size_t offset = 0;  ///< of the first component in a point
    bool is_scaled = false;  ///< by the two below, one for each component
    std::array<double, 3> scale{1, 1, 1};
    std::array<double, 3> shift{0, 0, 0};
};

/// The described extra bytes, in order. Those without a type, without a description or beyond the point's size are left
/// out and told.
std::vector<LasExtra> read_las_extra(const LasHeader& header, const std::vector<LasRecord>& records,
                                     const ReadOptions& options);

/// Whether the record is the description of extra bytes.
bool describes_extra_bytes(const LasRecord& record);

// From the records of LAS points to positions and columns.

/// The points of a file. Pre: require_las_points() passed. What had to be changed is told.
PointCloud read_las_points(const LasHeader& header, const std::vector<LasExtra>& extras, std::string_view bytes,
                           const ReadOptions& options);

}  // namespace scanmill
