// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Moves a value of any geometric kind by a rigid motion into another frame.

#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// Moves the value by the motion that starts from its frame (Transforms::motion_from()) into the frame `to` of all
/// motions, by placed() (scanmill/kinds/value.hpp). Positions are rotated, and the frame's origin is translated, so
/// that large coordinates keep their digits. Directions and the columns `normal`, `approach` and `corner-normals` are
/// rotated. Rows keep their order, and nothing else changes.
///
/// Throws Error in these cases:
/// - The value is in another frame than those from which motions start, or already in `to`, if the names are known.
///   Therefore a transform between two named frames cannot be applied twice.
/// - The value's frame was refused, or has no name and there are several motions, or several motions start from it.
/// - The transform has a unit and the value has none.
/// - The rotation or the translation is not a rigid motion.
/// - The value has no positions.
///
/// Warns if the value has a unit and the transform has none. Warns if the value's frame has a name and `to` is empty.
/// Cost: O(n).
Value apply_transform(const Value& value, const Transforms& transforms, Context& context);

}  // namespace scanmill
