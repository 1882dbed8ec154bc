// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Moves a value of any geometric kind by a rigid motion into another frame.

#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// The value in the frame `transform.to`, moved as placed() moves it (scanmill/kinds/value.hpp): positions are rotated
/// and the frame's origin is translated, so that large coordinates keep their digits; directions, and the columns
/// `normal`, `approach` and `corner-normals`, are rotated. Rows keep their order, nothing else changes.
///
/// Throws Error for a value that is in another frame than `transform.from`, and for one that is already in
/// `transform.to`, if both names are known; so a transform between two named frames cannot be applied twice. Throws
/// Error also for a transform with a unit and a value without, for a rotation or translation that is not a rigid
/// motion, and for kinds without positions. Warns if the transform has no unit but the value has, and if the frame that
/// it leads to has no name. Cost: O(n).
Value apply_transform(const Value& value, const RigidTransform& transform, Context& context);

}  // namespace scanmill
