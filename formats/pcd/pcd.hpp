// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// PCD, the Point Cloud Library's files: ascii, binary and binary_compressed; headers and binary points through PCL's
/// own reader.
///
/// Read: fields x, y, z, or X, Y, Z, of any numeric type are the positions (doubles stay doubles); normal_x, normal_y,
/// normal_z are the column `normal`, rgb or rgba the column `colour` (3 or 4 × uint8, unpacked); every other field
/// keeps its name, type and count, except padding (`_`; refused in compressed files, where PCL misreads it). The points
/// of an organised cloud are kept in file order, NaN points included, with a warning that gives its rows and columns. A
/// VIEWPOINT that is not the identity is not applied, with a warning. If there is such a one, or the cloud is
/// organised, the column `approach` (3 × float32) has the unit vectors to the sensor's position, 0 for points that are
/// NaN. `# unit mm` and `# frame NAME` lines in the header give the frame.
///
/// Written: DATA binary, positions as float where that is exact, else as double (which PCL's viewers do not show). List
/// columns are left out, and columns may need another name, each with a warning. Cost: the file is copied once, and its
/// rows are read once per field.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::pcd {

LoadedFile read_pcd(const FileBytes& file, const ReadOptions& options);
void write_pcd(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::pcd
