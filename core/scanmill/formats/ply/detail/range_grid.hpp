// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The direction to the scanner, from the grid of a range image in a PLY file.

#include <optional>
#include <span>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The unit vector from the surface to a scanner whose rays are parallel. A range image has a point in each of its
/// cells, or none, and the points' positions are affine in the cells' column and row, except along the rays. So the
/// direction is that in which the positions differ most from the affine map that fits them best, or, where that is more
/// than 60 degrees from the mean normal of the grid's triangles, this normal. Seen from the scanner, the next column is
/// to the right and the next row is above, as in the files of the Stanford repository.
///
/// `cells`: per cell a list with the row of its point, or an empty one; row by row, `columns` in each. Empty if a list
/// is longer or names no point, if the cells are not whole rows, or if no three neighbours have points.
std::optional<Vec3> direction_to_scanner(const Column& cells, std::size_t columns, std::span<const Vec3> positions);

}  // namespace scanmill
