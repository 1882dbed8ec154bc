// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// VTP, the XML files of VTK's polygonal data: points, meshes, features and probes for ParaView, PyVista and other
/// programs that use VTK.
///
/// Positions are world coordinates, as double. Columns, unit and frame are written as described in vtk/vtk_arrays.hpp.
/// NaN is written unchanged.
///
/// Points: every point is also a cell of its own (`Verts`), so that it is visible.
///
/// Meshes: vertex columns are point data, face columns cell data. VTK has no equivalent of edges; they are in the field
/// data: `sharp_edges` (2 × uint32, vertices), `edges` and for each edge column `edge:NAME`. Only list columns are left
/// out.
///
/// Features: every polyline is a cell (`Lines`); a closed polyline ends with its first point. Every corner is a cell
/// too (`Verts`, which come first). Polylines and corners share no points, so that the normals on both sides can be
/// point data. `left_normal` and `right_normal` belong to the segment that starts at the point; they are zero if there
/// is none. `vertex` is the number of the point in the feature graph. Cell data: `type` and `closed` (0 or 1). Types
/// are 0 outer boundary, 1 hole, 2 crease, 3 corner; the field data `type_names` has these names. Vertices that are in
/// no polyline and no corner are left out, with a warning.
///
/// Probes: every touch is a cell (`Verts`, which come first). Every direction, from the touch to the start of its
/// approach, is a polyline (`Lines`) with points of its own; so is every move. Point data: `direction`, the approach
/// direction at the touches, zero elsewhere. Cell data: `type` and every numeric field of the cell's touch. Types are 0
/// touch, 1 direction, 2 clearance, 3 approach, 4 retract; the field data `type_names` has these names. The fields of a
/// touch are `touch`, `feature`, `interior_angle`, `assumed` (0 or 1), `phi_min` … `phi`, `reason` (names:
/// `reason_names`), `false_share`, `contact` (names: `contact_names`), `contact_distance`, `order`. Angles are in
/// radians. For a touch that is not made, numbers that it does not have are NaN.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::vtk {

void write_vtp_points(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtp_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtp_features(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtp_probes(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::vtk
