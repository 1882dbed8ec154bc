// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mesh of a grown surface, with vertices in the order of the cloud.

#include "scanmill/data/points.hpp"
#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

struct FinishedMesh {
    TriangleMesh mesh;
    /// Per vertex its row in the cloud.
    Array<u32> rows;
    /// Per point its vertex, invalid_index for unused ones.
    Array<u32> vertex_of_point;
};

/// The points that are in a triangle, in input order with all their columns, and the cloud's frame. Triangles in the
/// order of their creation, lowest vertex first. No sharp edges. `cloud`: the one that surface.points was made from.
/// Cost: linear.
FinishedMesh finish_mesh(const PointCloud& cloud, const Surface& surface);

}  // namespace scanmill::growing
