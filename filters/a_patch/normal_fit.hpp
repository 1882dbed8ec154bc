// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fits the normals of a coarse mesh so that its surface passes near many points.

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

/// Turns the normals of `mesh` so that a surface through its vertices passes near the points. The normals of a dense
/// mesh follow noise, and details smaller than the triangles of `mesh`. Over long edges such normals would bend the
/// surface away from the points.
///
/// Minimises the sum over the points of (F / |grad F|)² + s · weight · |change of the normals|². F is a cubic over the
/// point's nearest triangle. It is 0 at the triangle's corners, its gradients there are the normals, and it is exact
/// for quadrics. s is the mean diagonal element of the first sum's matrix. Points farther away than 3 times the median
/// near their triangle count less (Huber). Points farther away than their triangle's inradius do not count.
///
/// Each normal chooses its weight: 1e-3 times a power of 10, below 200. It chooses the one with which each half of the
/// points best predicts the other half near the vertex. The fit takes three rounds. A change that a triangle opposes is
/// halved until none does. If no point counts, nothing changes. Normals that are 0 stay 0.
///
/// Bytes do not depend on the number of threads. Cost: about 2 us per point and 20 us per triangle.
void fit_normals(PatchMesh& mesh, std::span<const Vec3> points, Execution& execution);

}  // namespace scanmill::a_patches
