// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Brings a truth into the frame of a mesh, and finds out when the two cannot be compared.

#include <string>
#include <vector>

#include "scanmill/data/frame.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill::measuring {

/// The truth's positions in the mesh's unit, relative to the mesh's origin. The same buffer when nothing differs.
/// Throws Error when both frames have names and these differ, and when a position leaves what double can hold.
Buffer<Vec3> in_frame_of(const Frame& mesh, const Frame& truth, const Buffer<Vec3>& positions);

/// Refuses two bounding boxes (of the same frame) whose sizes or places say that unit or frame differ:
///  - every side of one is k times that of the other, within 5 %, where k is the ratio of two units (10 for mm and cm,
///    25.4 for in and mm, 1000 for mm and m …). Sides count in ascending order, so that turned boxes compare, and those
///    below a tenth of the diagonal on both not at all;
///  - one diagonal is more than 30 times the other, unless the truth is the smaller one and may be a part: some points;
///  - the boxes are more than a tenth of the longer diagonal apart.
/// Smaller differences are what is to be measured. Returns what a user should still know: a sentence when one diagonal
/// is more than twice the other, none otherwise.
std::vector<std::string> require_comparable(const BoundingBox& mesh, const BoundingBox& truth, bool truth_may_be_part,
                                            LengthUnit unit);

}  // namespace scanmill::measuring
