// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The weights of the cubics over a hull. The cubics interpolate the vertices and their normals, and join with equal
/// gradients.

#include "a_patch/hull.hpp"
#include "scanmill/data/patches.hpp"

namespace scanmill::a_patches {

/// The second derivative along the normal of the quadric that determines the weights off the surface.
enum class Curvature {
    distance,  ///< 0: F grows like a distance
    mean       ///< the mean curvature: exact for spheres
};

struct Weights {
    PatchComplex patches;  ///< without a frame
    std::size_t raised = 0;  ///< number of weights changed so that every line to an apex meets the surface once
};

/// The second derivatives of the quadric that fits a triangle's corners and normals.
Eigen::Matrix3d face_curvature(const Hull& hull, std::size_t face, Curvature curvature);

/// Number of weights of a tetrahedron that have the sign of the other side. Weights on the mesh do not count. The
/// number is 0 for `sharp` and `continuation`, whose weights decide nothing alone.
std::size_t wrong_signs(const PatchComplex& patches, std::size_t tet);

/// Cost: linear, about 2 us per triangle.
Weights make_weights(const Hull& hull, Curvature curvature, Execution& execution);

}  // namespace scanmill::a_patches
