// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Normals of a light mesh that let its surface pass near many points.

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

/// Turns the normals of `mesh` so that a surface through its vertices passes near the points. A dense mesh's normal at
/// a vertex follows noise and details smaller than the triangles here; over long edges it would bend the surface away.
///
/// Minimises the sum over the points of (F / |grad F|)² + s · weight · |change of the normals|², where F is the cubic
/// over the point's nearest triangle that vanishes at its corners, has these normals as gradients there, and is exact
/// for quadrics; s is the mean diagonal element of the first sum's matrix. Points farther away than 3 times the median
/// near their triangle count less (Huber), and those farther away than the radius of their triangle's inscribed circle
/// not at all. Each normal chooses its weight: 1e-3 times a power of 10, below 200, with which each half of the points
/// best predicts the other half near the vertex. Three rounds. A change that a triangle opposes is halved until none
/// does. Without such points nothing changes; normals that are 0 stay 0.
///
/// Bytes do not depend on the number of threads. Cost: about 2 us per point and 20 us per triangle.
void fit_normals(PatchMesh& mesh, std::span<const Vec3> points, Execution& execution);

}  // namespace scanmill::a_patches
