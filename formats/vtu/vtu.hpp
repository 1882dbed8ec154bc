// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// VTU, the XML files of VTK's unstructured grids: tetrahedra, for ParaView, PyVista and meshers.
///
/// Positions are world coordinates, as double. Columns, unit and frame: vtk/vtk_arrays.hpp; `unit` and `frame` are the
/// bytes of their text, because meshio does not read files with strings. Cell data: `inside`, 1 or 0, when the cells
/// are labelled. Neighbours are not written, because they follow from the cells.
///
/// Patches are Bezier tetrahedra of degree 3, each with its own 20 points, and point data `weights`: the function that
/// VTK interpolates is the patches' own, and its contour 0 the surface. Cell data: `kind` (0 face, 1 edge), `side` (1
/// outside the mesh), `patch` (the row of the mesh's triangle).

#include "scanmill/formats/common/format.hpp"

namespace scanmill::vtk {

void write_vtu(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_vtu_patches(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::vtk
