// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The segments of measured lines in the growing surface and in the finished mesh.

#include "region_grow/lines.hpp"
#include "region_grow/region_grow.hpp"
#include "scanmill/geometry/growing/finished_mesh.hpp"

namespace scanmill::growing {

/// The segments as pairs of points. Pre: `points` are those of lines.cloud. Cost: linear, and a sort of the segments.
std::vector<std::array<u32, 2>> edges_of(const PreparedLines& lines, const DistinctPoints& points);

/// The fixed edges that are edges of the mesh, sorted.
Array<Edge> segments_in(const FinishedMesh& finished, const Surface& surface);

/// Sets the counts of `result`, reports the metrics, warns of segments that were left out, and doubts the result if
/// segments are missing. Pre: the surface is finished.
void report_lines(const PreparedLines& lines, const Surface& surface, RegionGrowResult& result, Context& context);

}  // namespace scanmill::growing
