// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// GLB, binary glTF 2.0: meshes and points for browsers, Blender and other viewers.
///
/// glTF is in metres with y up. Scans declare no up direction, so z is assumed to be up: the vertices (x, y, z) become
/// (x, z, -y). A scan of unknown unit is written as if it were in metres, with a warning. Far from zero, the node's
/// `translation` is an origin near the data (double), so that the vertices keep their precision as float.
///
/// Column `normal` becomes NORMAL, normalised. Column `colour` becomes COLOR_0, 16 bits and linear as glTF requires;
/// viewers then show the sRGB bytes of the column. Every other column of points or vertices becomes `_NAME`, in upper
/// case, with '_' for everything but letters and digits. Numbers of 8 and 16 bits and float keep their type. Wider
/// integers become float if this changes none of them. Double becomes float, with a warning if this rounds.
///
/// Some columns are left out, with a warning: columns with numbers that do not fit, with lists, with more than 4
/// numbers per row, or with NaN or infinity. All columns of faces and edges are left out, too. The unit and the frame's
/// name are the node's `extras`. There is one material: rough, not metallic, visible from both sides.
///
/// Refused: NaN and infinite positions, meshes without triangles, more than 2^32 bytes.
/// Source: glTF 2.0 specification, Khronos 2021.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::glb {

void write_glb_points(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_glb_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill::glb
