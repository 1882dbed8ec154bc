// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// PCD, the Point Cloud Library's files: ascii, binary and binary_compressed; headers and binary points through PCL's
/// own reader.
///
/// Read: fields x, y, z of any numeric type are the positions (doubles stay doubles); normal_x, normal_y, normal_z are
/// the column `normal`, rgb or rgba the column `colour` (3 or 4 × uint8, unpacked); every other field keeps its name,
/// type and count, but for padding (`_`; refused in compressed files, where PCL misreads it). The rows and columns of
/// an organised cloud are told, its points kept in file order with those that are NaN; a VIEWPOINT that is not the
/// identity is told and not applied. `# unit mm` and
/// `# frame NAME` lines in the header give the frame.
///
/// Written: DATA binary, positions as float where that loses nothing, else as double (which PCL's viewers do not show);
/// list columns, and columns that need another name, are told. Cost: the file is copied once, and its rows are walked
/// once per field.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::pcd {

LoadedFile read_pcd(const FileBytes& file, const ReadOptions& options);
void write_pcd(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::pcd
