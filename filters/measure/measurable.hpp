// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Preconditions of measuring: parameters, surfaces and frames. Every Error has a hint.

#include <string>
#include <string_view>
#include <vector>

#include "measure/measure.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill::measuring {

/// Requires enough samples, and a gap between 0 % and 100 %.
void require_sound(const MeasureParams& params);

/// The thresholds in the mesh's unit. Throws Error if one is not above 0 or not finite.
std::vector<double> thresholds_for(const TriangleMesh& mesh, const MeasureParams& params);

/// Requires a consistent and finite mesh with at least one triangle that has an area. `name`: "mesh" or "truth".
void require_surface(const TriangleMesh& mesh, std::string_view name);

/// The truth's positions in the mesh's unit, relative to the mesh's origin. Returns the same buffer if the frames are
/// equal. Throws Error if both frames have names and the names differ.
Buffer<Vec3> in_frame_of(const Frame& mesh, const Frame& truth, const Buffer<Vec3>& positions);

/// Throws Error if the sizes or positions of two bounding boxes (in the same frame) show that unit or frame differ:
///  - every extent of one box is k times that of the other, within 5 %. Here k is the ratio of two units (10 for mm and
///    cm, 25.4 for in and mm, 1000 for mm and m …). Extents are compared in ascending order, because a box may be
///    turned. An extent below a tenth of the diagonal in both boxes does not count;
///  - one diagonal is more than 30 times the other. This is allowed if the truth is smaller and `truth_may_be_part`;
///  - the boxes are more than a tenth of the longer diagonal apart.
/// Smaller differences are allowed. Returns warnings: one if a diagonal is more than twice the other, else none.
std::vector<std::string> require_comparable(const BoundingBox& mesh, const BoundingBox& truth, bool truth_may_be_part,
                                            LengthUnit unit);

}  // namespace scanmill::measuring
