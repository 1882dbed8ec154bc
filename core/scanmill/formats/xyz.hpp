// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// XYZ and its relatives (.xyz, .txt, .pwn, .pts, .csv, .asc): one point per line, numbers in columns.
///
/// Read: columns separated by blanks, tabs, commas or semicolons; the first three are x, y, z. Further columns are
/// `normal` (3, float64) when there are exactly three and every one that is not zero has unit length within a tenth,
/// else columns c4, c5 … (float64); three that are no unit normals are told. A first line of names (X,Y,Z,Intensity,
/// perhaps in quotes) names the columns instead. A first line with a single whole number is the number of points. `#`
/// lines are comments; "unit mm" and "frame NAME" in them give the frame. Every line must have as many numbers as the
/// first. Written: x y z, and the normals when there are some, as the shortest decimals that read back equal. Other
/// columns are told.

#include "scanmill/formats/format.hpp"

namespace scanmill {

Recognition recognise_xyz(std::string_view head, u64 file_size);
LoadedFile read_xyz(const FileBytes& file, const ReadOptions& options);
void write_xyz(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill
