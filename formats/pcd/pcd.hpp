// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// PCD, the Point Cloud Library's files: ascii, binary and binary_compressed. PCL's own reader reads headers and binary
/// points.
///
/// Reading: the fields x, y, z, or X, Y, Z, of any numeric type are the positions (doubles stay doubles). The fields
/// normal_x, normal_y, normal_z (or nx, ny, nz) become the column `normal`. The field rgb or rgba becomes the column
/// `colour` (3 or 4 × uint8, unpacked). Every other field keeps its name, type and count. Padding (`_`) is skipped; in
/// compressed files it is refused, because PCL misreads it.
///
/// The points of an organised cloud are kept in file order, NaN points included, with a warning that states its rows
/// and columns. A VIEWPOINT that is not the identity is not applied, with a warning. With such a VIEWPOINT, or for an
/// organised cloud, the column `approach` (3 × float32) contains the unit vectors to the sensor's position, 0 for NaN
/// points. The header lines `# unit mm` and `# frame NAME` define the frame.
///
/// Writing: DATA binary. Positions are float if this is exact, else double (which PCL's viewers do not show). List
/// columns are left out, and columns may get another name, each with a warning. Cost: the file is copied once, and its
/// rows are read once per field.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::pcd {

LoadedFile read_pcd(const FileBytes& file, const ReadOptions& options);
void write_pcd(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::pcd
