// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The polygon that an edit leaves, all around or on one side of a feature line, and its best triangulation.

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

/// Judges the parts of a triangulation. Corners are given by their positions in the polygon, ascending.
class HoleErrors {
public:
    virtual ~HoleErrors() = default;
    /// Whether a new edge may be made; adds its errors.
    virtual bool add_edge(u32 i, u32 j, SignedErrors& errors) = 0;
    /// Adds the errors of a triangle with this unit normal, without those of its edges. False if they are not allowed.
    virtual bool add_triangle(u32 i, u32 k, u32 j, const Vec3& normal, SignedErrors& errors) = 0;
};

struct HoleTriangle {
    std::array<u32, 3> corners;  ///< ascending
    SignedErrors errors;
};

class HoleTriangulator {
public:
    /// The triangulation with the least sum of costs; false if none is within the limits. The cost of an edge is the
    /// square of its error, as a share of the limits; that of a triangle likewise, and more for a poor shape. Every
    /// triangle faces `up` within the limits and has no angle with a sine below `angle_sine`. Cost: O(n³) for n
    /// corners.
    bool triangulate(std::span<const HoleCorner> corners, const Vec3& up, double angle_sine, const Limits& limits,
                     HoleErrors& judge, std::vector<HoleTriangle>& triangles);

private:
    HoleTriangulation best_;
    std::vector<SignedErrors> edges_, faces_;  ///< by edge: its own errors, and those of the triangle beyond it
};

}  // namespace scanmill::decimating
