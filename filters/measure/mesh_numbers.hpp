// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Properties of one mesh by itself: size, topology, the shape of its triangles.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/topology.hpp"

namespace scanmill {

struct MeshNumbers {
    MeshTopology topology;
    double area = 0;
    /// By the divergence theorem: positive if triangles are counter-clockwise from outside. Absent unless closed.
    std::optional<double> volume;
    /// Triangles whose corners are on one line, decided exactly.
    std::size_t collinear_triangles = 0;
    /// Smallest angle per triangle, in radians: minimum, 5 % and 50 % quantile. Collinear triangles have 0.
    double least_angle = 0, angle_p5 = 0, angle_p50 = 0;
    /// Longest edge over 2 √3 inradii: 1 for an equilateral triangle. Collinear triangles do not count.
    double aspect_p50 = 1, aspect_p95 = 1, largest_aspect = 1;
};

/// Pre: consistent, finite coordinates. Bytes do not depend on the number of threads. Cost: O(F log F).
MeshNumbers mesh_numbers(const TriangleMesh& mesh, unsigned threads);

namespace measuring {

/// Smallest angle of a triangle with these corners, in radians; 0 if one of its edges has no length.
double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace measuring

}  // namespace scanmill
