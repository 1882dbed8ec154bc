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
    /// Enclosed volume by the divergence theorem; positive if triangles are counter-clockwise seen from outside. Absent
    /// if the mesh is not closed.
    std::optional<double> volume;
    /// Triangles whose corners are on one line, decided exactly.
    std::size_t collinear_triangles = 0;
    /// Minimum, 5 % quantile and median of the triangles' smallest angles, in radians. Collinear triangles count with
    /// 0.
    double least_angle = 0, angle_p5 = 0, angle_p50 = 0;
    /// Median, 95 % quantile and maximum of the aspect ratio: the longest edge divided by 2 √3 inradii, 1 for an
    /// equilateral triangle. Collinear triangles do not count.
    double aspect_p50 = 1, aspect_p95 = 1, largest_aspect = 1;
};

/// Pre: consistent, finite coordinates. Bytes do not depend on the number of threads. Cost: O(F log F).
MeshNumbers mesh_numbers(const TriangleMesh& mesh, unsigned threads);

namespace measuring {

/// Smallest angle of a triangle with these corners, in radians; 0 if one of its edges has no length.
double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace measuring

}  // namespace scanmill
