// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which way the closed components of a mesh face.

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Triangles of the components, connected through edges, that face the wrong way: a closed component must face
/// outwards, or inwards if an odd number of other closed components enclose it, as it then bounds a cavity.
///
/// Pre:  finite positions. A component is closed if each of its edges has two half-edges of opposite directions.
/// Post: by triangle, 1 if it must be reversed; 0 in components that are not closed. A component encloses another one
/// if
///       it has more volume and encloses, by enclosed(), a point just inside the other's largest triangle. So parts
///       that touch do not enclose each other. A component without volume, to 1e-9 of its parts, is not reversed.
/// Cost: linear for one component. For several, O(n log n) time for each pair of components whose boxes are nested, and
///       a comparison of each pair whose boxes overlap along x.
Array<u8> facing_wrong(const TriangleMesh& mesh, Execution& execution);

/// Reverses the triangles of facing_wrong(), and the values of the face column `corner-normals` and the vertex column
/// `normal` with them. Returns their number.
std::size_t face_outwards(TriangleMesh& mesh, Execution& execution);

}  // namespace scanmill
