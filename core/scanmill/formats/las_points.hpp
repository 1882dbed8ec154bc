// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// From the records of LAS points to positions and columns.

#include "scanmill/data/points.hpp"
#include "scanmill/formats/las_extra.hpp"

namespace scanmill {

/// The points of a file. Pre: require_las_points() passed. What had to be changed is told.
PointCloud read_las_points(const LasHeader& header, const std::vector<LasExtra>& extras, std::string_view bytes,
                           const ReadOptions& options);

}  // namespace scanmill
