// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// 3MF, the files of 3D printing: closed meshes, through lib3mf.
///
/// Unit: the scan's own; an unknown one is written as millimetre, 3MF's default, and that is told. Only closed,
/// oriented manifolds whose triangles face outwards are written; that no triangles pass through each other is not
/// checked. The frame's name is the object's. Coordinates have six digits behind the point, rounded: what that moves is
/// told when it is more than a millionth of the diagonal. Far from zero, the build item's transform moves the object to
/// its place (six digits), and the vertices make up for what those digits lack. Columns and sharp edges are left out
/// and told.
///
/// Equal values give equal bytes: the package is of 1980-01-01, and the UUIDs that 3MF wants are made from the
/// geometry. Source: 3MF core specification 1.2, production extension 1.1.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::threemf {

void write_threemf(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::threemf
