// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// PTX: scans by Leica's programs, each a grid of cells in the scanner's own coordinates with the matrix that places
/// it.
///
/// Read: for each scan the numbers of columns and rows, the scanner's position and axes, four rows of four numbers that
/// carry a row vector (x y z 1) into the world, and one line per cell: x y z intensity, perhaps red green blue. The
/// result holds the placed points of all scans as `intensity` (float64) and, when every scan has them, `colour` (see
/// text_columns.hpp); with several scans a column `scan` (uint32) from 0, which is told. Cells at 0 0 0 are no points:
/// they are left out and counted. So are the grid and the scanner's position. A matrix that scales, shears or mirrors
/// is applied and told; one that is singular, not finite or not affine is an Error.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

Recognition recognise_ptx(std::string_view head, u64 file_size);
LoadedFile read_ptx(const FileBytes& file, const ReadOptions& options);

}  // namespace scanmill
