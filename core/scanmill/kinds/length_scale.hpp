// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two lengths that relative parameters refer to: the bounding box's diagonal and the spacing of the samples.

#include "scanmill/data/quantity.hpp"
#include "scanmill/geometry/spatial/spacing.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// The lengths that `%diag` and `spacing` refer to for this value: KindTraits::box() and spacing(), each computed at
/// most once, on demand. `%diag` throws Error if all positions are equal. For metrics, `%diag` is their metric
/// `diagonal`, and `spacing` throws Error.
LengthScale length_scale(const Value& value);

class PointStream;
/// The same for a streamed scan; `spacing` throws Error, because it needs all points at once.
LengthScale length_scale(const PointStream& scan);

}  // namespace scanmill
