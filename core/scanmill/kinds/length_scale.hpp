// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two lengths that relative parameters refer to: the bounding box's diagonal and the spacing of the samples.

#include "scanmill/data/quantity.hpp"
#include "scanmill/geometry/spatial/spacing.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// What `%diag` and `spacing` mean for this value. The diagonal is that of all its positions, of a mesh those that its
/// triangles use; the spacing of points is by point_spacing, of meshes by edge_spacing, of everything else by its
/// positions. Both are computed at most once, on demand. `%diag` throws Error when all positions are equal. Metrics
/// have the diagonal that they report, and no spacing.
LengthScale length_scale(const Value& value);

class PointStream;
/// The same of a scan that is streamed. Its spacing would take all points: whoever asks gets an Error.
LengthScale length_scale(const PointStream& scan);

}  // namespace scanmill
