// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two lengths that relative parameters refer to: the diagonal of the box, without stray points, and the spacing of
/// the samples.

#include "scanmill/data/quantity.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// The lengths that `%diag` and `spacing` refer to for this value: the diagonal of KindTraits::box() and
/// KindTraits::spacing(), each computed at most once, on demand. `%diag` throws Error if all positions are equal. For
/// metrics, `%diag` is their metric `diagonal`, and `spacing` throws Error. `on_stray`, unless empty, gets the sentence
/// of stray_warning() if `%diag` is computed and there are stray points.
LengthScale length_scale(const Value& value, const OnWarning& on_stray = {});

class PointStream;
/// The same for a streamed scan; `spacing` throws Error, because it needs all points at once.
LengthScale length_scale(const PointStream& scan, const OnWarning& on_stray = {});

/// One sentence with the number of stray points, the first of them in world coordinates, and both diagonals. Pre: there
/// are stray points; positions are relative to frame.origin.
std::string stray_warning(const RobustBox& box, const Frame& frame);

}  // namespace scanmill
