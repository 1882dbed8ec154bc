// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// 3MF, the files of 3D printing: closed meshes.
///
/// The file has the scan's unit. An unknown unit is written as millimetre, 3MF's default, with a warning. Only closed,
/// oriented manifolds whose triangles face outwards are written; intersections of triangles are not checked. The object
/// has the frame's name. Coordinates have single precision, as in 3MF's readers. A warning is given if this moves a
/// coordinate by more than a millionth of the diagonal. Far from zero, the build item's transform moves the object to
/// its position, and the vertices contain the remainder. The vertex column `colour` (3 or 4 bytes, sRGB) becomes a
/// group of colours, one per vertex, interpolated in the triangles. Other columns and sharp edges are left out, with a
/// warning.
///
/// Equal values give equal bytes. Source: 3MF core specification 1.2, materials and properties extension 1.1.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::threemf {

void write_threemf(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::threemf
