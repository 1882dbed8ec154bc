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
/// start. So every triangle gets its share of `count` by area, rounded up or down. The position of a sample in its
/// triangle has a uniform distribution. Triangles without area get no sample.
/// Pre: count ≥ 1, an area above 0. The result depends on the generator alone, not on the number of threads.
SurfaceSamples sample_surface(const TriangleMesh& mesh, std::size_t count, const Random& random, unsigned threads);

/// Removes points from `nearest` whose nearest point on the mesh is within `rounding` of the boundary. The boundary
/// consists of the edges of only one triangle. The other points keep their order. Returns the number of removed points.
/// Edges are compared by vertex index, as in topology.hpp. If several triangles are equally near, the one in `nearest`
/// counts.
///
/// Pre: `nearest` belongs to these points and this mesh. Throws Error if no point would be left.
/// Cost: O(points + F).
std::size_t leave_out_borders(NearestDistances& nearest, std::span<const Vec3> points, const TriangleMesh& mesh,
                              double rounding);

}  // namespace scanmill::measuring
