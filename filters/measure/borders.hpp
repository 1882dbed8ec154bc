// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which points of a cloud are nearest to where an open mesh ends.

#include <span>

#include "measure/nearest_distances.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill::measuring {

/// Removes from `nearest`, keeping the order of the others, the points whose nearest point on the mesh lies on an edge
/// that only one triangle has, or on a vertex of such an edge; "on" up to `rounding`. Returns how many they were.
/// Edges go by vertex index, as in geometry/topology.hpp. Of equally near triangles the one in `nearest` counts.
///
/// Pre: `nearest` is that of these points and this mesh. Throws Error when no point would be left.
/// Cost: O(points + F).
std::size_t leave_out_borders(NearestDistances& nearest, std::span<const Vec3> points, const TriangleMesh& mesh,
                              double rounding);

}  // namespace scanmill::measuring
