// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// From places to the mesh that leaves the filter.

#include "region_grow/patch_edges.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill::growing {

struct FinishedMesh {
    TriangleMesh mesh;
    /// Per vertex its row in the cloud.
    Array<u32> rows;
};

/// The used points in input order with all their columns, triangles as they were formed, lowest vertex first; sharp
/// edges: those that bend by more than `sharp_angle`, and the patches' edges. Cost: linear.
FinishedMesh finish_mesh(const PointCloud& cloud, const Surface& surface, std::span<const PatchEdge> patch_edges,
                         Angle sharp_angle);

}  // namespace scanmill::growing
