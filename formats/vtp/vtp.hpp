// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// VTP, the XML files of VTK's polygonal data: points, meshes and features for ParaView, PyVista and all that VTK
/// reads.
///
/// Positions are world coordinates, as double. Columns, unit and frame: vtk/vtk_arrays.hpp. NaN is written as it is.
///
/// Points: every point is also a cell of its own (`Verts`), so that it is seen. A mesh: vertex columns are point data,
/// face columns cell data; what VTK has no place for is in the field data: `sharp_edges` (2 × uint32, vertices),
/// `edges` and for each edge column `edge:NAME`. Nothing but lists is lost.
///
/// Features: every polyline is a cell (`Lines`); a closed one ends with the point it began with. Points are not shared:
/// each polyline and each corner has its own, so that the normals on both sides can be point data (`left_normal`,
/// `right_normal`; of the segment that starts there, zero where there is none); `vertex` is the number of the point in
/// the feature graph. Corners are cells, too (`Verts`, they come first). Cell data: `type`, whose names are the field
/// data `type_names`: 0 outer boundary, 1 hole, 2 crease, 3 corner; and `closed`, 0 or 1. Vertices that neither a
/// polyline nor a corner names are left out, and told.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::vtk {

void write_vtp_points(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtp_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtp_features(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::vtk
