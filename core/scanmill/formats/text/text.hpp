// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// XYZ and its relatives (.xyz, .txt, .asc, .csv, .pts, .pwn): one point per line, numbers in columns.
///
/// Read: columns separated by blanks, tabs, commas, semicolons or bars, of one kind in each row; `#` and `//` begin
/// comments, in which "unit mm" and "frame NAME" give the frame. A line of names (X,Y,Z,Intensity; in a comment, too)
/// names the columns, in any order; without one the first three are x, y, z. text_columns.hpp says what becomes of the
/// others. Every line must have as many numbers as the first.
///
/// A first line with a single whole number is the number of points. When further such lines follow, each behind as many
/// points as the one before promised, the blocks are scans: one cloud, with a column `scan` (uint32) from 0, which is
/// told. A count N before 2 N rows of three numbers means N points and then their normals. Lines of single letters and
/// numbers, as in "p 1 2 3", are Hoppe's points: see tagged_points.hpp.
///
/// Written: x y z, and the normals when there are some, as the shortest decimals that read back equal. Other columns
/// are told.

#include <memory>

#include "scanmill/data/point_stream.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/io/mapped_file.hpp"

namespace scanmill {

Recognition recognise_xyz(std::string_view head, u64 file_size);
LoadedFile read_xyz(const FileBytes& file, const ReadOptions& options);
void write_xyz(const Value& value, OutputBuffer& out, const WriteOptions& options);

/// Whether open_text_stream() may open the file; bytes further back may still prevent it.
bool may_be_text_stream(std::string_view file);
/// Null for a file that cannot be streamed. May throw Error for one that no reader accepts.
std::unique_ptr<PointStream> open_text_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                              unsigned threads, const OnWorldPositions& on_positions);

}  // namespace scanmill
