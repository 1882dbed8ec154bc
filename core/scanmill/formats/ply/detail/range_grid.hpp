// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The direction to the scanner, from the grid of a range image in a PLY file.

#include <optional>
#include <span>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The unit vector from the surface to a scanner whose rays are parallel. A cell of a range image has one point or
/// none. Apart from their distance along the rays, the positions are an affine function of the cells' column and row.
/// The direction to the scanner is therefore the direction in which the positions differ most from their best affine
/// fit. If it is more than 60 degrees from the mean normal of the grid's triangles, this normal is returned instead.
/// Seen from the scanner, the next column is to the right and the next row is above, as in the files of the Stanford
/// repository.
///
/// `cells` has a list for each cell: the row of the cell's point, or nothing. Cells are in row order, `columns` in each
/// row. Returns nullopt if a list is longer or contains a number that is not a point, if the cells are not whole rows,
/// or if no three neighbouring cells have points.
std::optional<Vec3> direction_to_scanner(const Column& cells, std::size_t columns, std::span<const Vec3> positions);

}  // namespace scanmill
