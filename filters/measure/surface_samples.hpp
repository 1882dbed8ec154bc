// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Points spread evenly over the area of a mesh.

#include "scanmill/base/random.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill::measuring {

struct SurfaceSamples {
    Array<Vec3> positions;
    /// The triangle each lies on; ascending.
    Array<u32> triangles;
};

/// Systematic sampling: the triangles' areas are laid end to end, and points are taken at equal steps from a random
/// start, so that every triangle gets its share of `count` by area, rounded up or down. Within its triangle a point is
/// uniform. Triangles without area get none.
/// Pre: count ≥ 1, an area above 0. Depends on the generator alone, not on the number of threads.
SurfaceSamples sample_surface(const TriangleMesh& mesh, std::size_t count, const Random& random, unsigned threads);

}  // namespace scanmill::measuring
