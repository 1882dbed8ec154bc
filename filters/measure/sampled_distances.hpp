// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Points spread evenly over a mesh, and which points are nearest to its border.

#include <span>

#include "scanmill/base/random.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/geometry/distance/nearest_distances.hpp"

namespace scanmill::measuring {

struct SurfaceSamples {
    Array<Vec3> positions;
    /// The triangle of each sample; ascending.
    Array<u32> triangles;
};

/// Systematic sampling: the triangles' areas are laid end to end, and samples are taken at equal steps from a random
/// start. So every triangle gets its share of `count` by area, rounded up or down. Within its triangle a sample is
/// uniform. Triangles without area get none.
/// Pre: count ≥ 1, an area above 0. Depends on the generator alone, not on the number of threads.
SurfaceSamples sample_surface(const TriangleMesh& mesh, std::size_t count, const Random& random, unsigned threads);

/// Removes from `nearest`, keeping the order of the others, the points whose nearest point on the mesh is on a boundary
/// edge (an edge of only one triangle) or on a vertex of one, within `rounding`. Returns how many were removed.
/// Edges are compared by vertex index, as in geometry/topology.hpp. If several triangles are equally near, the one in
/// `nearest` counts.
///
/// Pre: `nearest` belongs to these points and this mesh. Throws Error if no point would be left.
/// Cost: O(points + F).
std::size_t leave_out_borders(NearestDistances& nearest, std::span<const Vec3> points, const TriangleMesh& mesh,
                              double rounding);

}  // namespace scanmill::measuring
