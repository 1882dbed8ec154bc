// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mesh of a grown surface, with vertices in the order of the cloud.

#include "scanmill/data/points.hpp"
#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

struct FinishedMesh {
    TriangleMesh mesh;
    /// For each vertex, its row in the cloud.
    Array<u32> rows;
    /// For each point, its vertex; invalid_index for unused points.
    Array<u32> vertex_of_point;
};

/// The vertices are the points in a triangle, in the order of the cloud, with all columns and the cloud's frame.
/// Triangles keep the order of their creation and start with their lowest vertex. The mesh has no sharp edges. `cloud`:
/// the cloud that surface.points was made from. Cost: linear.
FinishedMesh finish_mesh(const PointCloud& cloud, const Surface& surface);

}  // namespace scanmill::growing
