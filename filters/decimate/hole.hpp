// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The polygon of a hole that an edit leaves, or of its part on one side of a feature line, and its best triangulation.

#include <array>
#include <span>
#include <vector>

#include "decimate/errors.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/geometry/mesh/hole_triangulation.hpp"

namespace scanmill::decimating {

struct HoleCorner {
    u32 vertex;
    u32 ring_position;
    Vec3 position;
};

/// Computes the errors of edges and triangles, and compares them with the limits. Corners are given by their positions
/// in the polygon, in ascending order.
class HoleErrors {
public:
    virtual ~HoleErrors() = default;
    /// Adds the errors of a new edge. Returns false if the edge is not allowed.
    virtual bool add_edge(u32 i, u32 j, SignedErrors& errors) = 0;
    /// Adds the errors of a triangle, except those of its edges. Returns false if they are not allowed. Pre: unit
    /// `normal`.
    virtual bool add_triangle(u32 i, u32 k, u32 j, const Vec3& normal, SignedErrors& errors) = 0;
};

struct HoleTriangle {
    std::array<u32, 3> corners;  ///< ascending
    SignedErrors errors;
};

class HoleTriangulator {
public:
    /// Finds the triangulation with the least sum of costs. Returns false if no triangulation is within the limits. The
    /// cost of an edge is the square of its error as a share of the limits. The cost of a triangle is the same for its
    /// own error, plus a penalty for a poor shape. The angle between the normal of a triangle and `up` is within the
    /// limits, and no angle of a triangle has a sine below `angle_sine`. Cost: O(n³) for n corners.
    bool triangulate(std::span<const HoleCorner> corners, const Vec3& up, double angle_sine, const Limits& limits,
                     HoleErrors& judge, std::vector<HoleTriangle>& triangles);

private:
    HoleTriangulation best_;
    std::vector<SignedErrors> edges_, faces_;  ///< by edge: its own errors, and those of the triangle beyond it
};

}  // namespace scanmill::decimating
