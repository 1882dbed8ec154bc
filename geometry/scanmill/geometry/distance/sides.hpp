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
/// Post: by triangle, 1 if it must be reversed; 0 in components that are not closed. Exact: a component encloses
///       another one if it encloses the other's lowest vertex by enclosed(). Of components that intersect or touch,
///       this vertex decides. A component without volume, to 1e-9 of the area times the size, is not reversed.
/// Cost: O(n log n) time for each pair of components whose boxes are nested; linear for one component.
Array<u8> facing_wrong(const TriangleMesh& mesh, Execution& execution);

/// Reverses the triangles of facing_wrong(), and the values of the face column `corner-normals` and the vertex column
/// `normal` with them. Returns their number.
std::size_t face_outwards(TriangleMesh& mesh, Execution& execution);

}  // namespace scanmill
