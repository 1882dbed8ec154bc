// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// 3MF, the files of 3D printing: closed meshes.
///
/// Unit: the scan's own; an unknown one is written as millimetre, 3MF's default, with a warning. Only closed, oriented
/// manifolds whose triangles face outwards are written; intersections of triangles are not checked. The frame's name is
/// that of the object. Coordinates have single precision, as 3MF's readers do, with a warning when that moves one by
/// more than a millionth of the diagonal. Far from zero, the build item's transform moves the object to its position,
/// and the vertices contain the remainder. Columns and sharp edges are left out, with a warning.
///
/// Equal values give equal bytes. Source: 3MF core specification 1.2.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::threemf {

void write_threemf(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::threemf
