// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// VTU, the XML files of VTK's unstructured grids: tetrahedra, for ParaView, PyVista and meshers.
///
/// Positions are world coordinates, as double. Columns, unit and frame are written as described in vtk/vtk_arrays.hpp.
/// `unit` and `frame` are the bytes of their text, because meshio does not read files with strings. Cell data:
/// `inside`, 1 or 0, if the cells are labelled. Neighbours are not written, because they follow from the cells.
///
/// Patches are Bezier tetrahedra of degree 3, each with its own 20 points. The point data `weights` are the patches'
/// weights, so VTK interpolates the patches' own function; its contour 0 is the surface. Cell data: `kind` (PatchKind),
/// `side` (1 outside the mesh), `patch` (the row of the mesh's triangle), `combine` (Combine), `edge` and `partner` (-1
/// without an edge or a partner).

#include "scanmill/formats/common/format.hpp"

namespace scanmill::vtk {

void write_vtu(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtu_patches(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::vtk
