// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// OBJ, the object file format of Wavefront, as text.
///
/// Read: `v` x y z with a weight, or with a colour of three or four numbers (see row_colours.hpp; fractions of 1 and
/// whole numbers up to 255 are both found in the wild); `f` and `fo` with v, v/vt, v//vn or v/vt/vn for each corner,
/// numbered from 1, or from the latest backwards when negative; vertices may follow the faces that name them. Faces are
/// cut into triangles. `vn` becomes the vertex column `normal` (3, float64) and `vt` the column `texture` (2, float64)
/// when all corners at a vertex name equal ones, or when no face names any and there are as many as vertices; else
/// they are left out (see obj_corner_values.hpp). A backslash at a line's end continues the line, `#` begins a comment,
/// and comments "unit mm" and "frame NAME" give the frame.
/// A vertex that is missing or numbered 0 is an Error. Everything else is left out and told with its number: weights
/// other than 1, faces of fewer than three corners, lines, points, free-form curves and surfaces, groups, objects,
/// materials and smoothing groups when there is more than one of them, material libraries, rows of no known keyword.
/// Without a face the file is a cloud of all its vertices.
/// Written: triangles with double precision, the columns `normal` (3 floats), `texture` (2 floats) and `colour`
/// (3 × uint8, as fractions of 1; a fourth channel is left out and told). Other columns, sharp and described edges are
/// told.
/// Source: Wavefront Advanced Visualizer manual, appendix B1, object files.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

Recognition recognise_obj(std::string_view head, u64 file_size);
LoadedFile read_obj(const FileBytes& file, const ReadOptions& options);
void write_obj(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill
