// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// VTP, the XML files of VTK's polygonal data: points, meshes, features and probes for ParaView, PyVista and other
/// programs that use VTK.
///
/// Positions are world coordinates, as double. Columns, unit and frame: vtk/vtk_arrays.hpp. NaN is written unchanged.
///
/// Points: every point is also a cell of its own (`Verts`), so that it is visible. A mesh: vertex columns are point
/// data, face columns cell data. Edges have no equivalent in VTK and are in the field data: `sharp_edges` (2 × uint32,
/// vertices), `edges` and for each edge column `edge:NAME`. Only lists are lost.
///
/// Features: every polyline is a cell (`Lines`); a closed one ends with its first point. Points are not shared:
/// each polyline and each corner has its own, so that the normals on both sides can be point data (`left_normal`,
/// `right_normal`; of the segment that starts there, zero where there is none); `vertex` is the number of the point in
/// the feature graph. Corners are also cells (`Verts`, which come first). Cell data: `type`, whose names are the field
/// data `type_names`: 0 outer boundary, 1 hole, 2 crease, 3 corner; and `closed`, 0 or 1. Vertices that are in no
/// polyline and no corner are left out, with a warning.
///
/// Probes: every touch is a cell (`Verts`, which come first), and every direction (from the touch to the start of its
/// approach) and every move is a polyline (`Lines`) with points of its own. Point data: `direction`, the approach
/// direction at the touches, zero elsewhere. Cell data: `type`, whose names are the field data `type_names`: 0 touch,
/// 1 direction, 2 clearance, 3 approach, 4 retract; and every field of the cell's touch that is a number, in radians if
/// it is an angle: `touch`, `feature`, `interior_angle`, `assumed` (0 or 1), `phi_min` … `phi`, `reason` (names:
/// `reason_names`), `false_share`, `contact` (names: `contact_names`), `contact_distance`, `order`. Where the touch is
/// not made, numbers that it does not have are NaN.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::vtk {

void write_vtp_points(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtp_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtp_features(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtp_probes(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::vtk
