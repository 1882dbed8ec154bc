// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// GLB, binary glTF 2.0: meshes and points for browsers, Blender and other viewers.
///
/// glTF is in metres with y up; scans declare no up, so z is assumed to be up: (x, y, z) becomes (x, z, -y), in the
/// vertices themselves. A scan of unknown unit is written as if it were in metres, with a warning. Far from zero, the
/// node's `translation` holds an origin near the data (double), so that the vertices keep their precision as float.
///
/// Columns: `normal` becomes NORMAL, normalised; `colour` becomes COLOR_0, linear as glTF requires, 16 bits, so that
/// viewers show the sRGB bytes of the column. Every other column of points or vertices becomes `_NAME`, in upper case,
/// with '_' for everything but letters and digits; 8 and 16 bits and float keep their type, wider integers become float
/// when none of them changes, and double becomes float, with a warning when that rounds. Left out, with a warning:
/// numbers that do not fit, lists, more than 4 numbers per row, columns with NaN or infinity; and all columns of faces
/// and edges. The unit and the frame's name are the node's `extras`. One material: rough, not metallic, visible from
/// both sides.
///
/// Refused: NaN and infinite positions, meshes without triangles, more than 2^32 bytes. Source: glTF 2.0 specification,
/// Khronos 2021.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::glb {

void write_glb_points(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_glb_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::glb
