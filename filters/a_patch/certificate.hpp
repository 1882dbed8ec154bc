// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Largest distances between a surface of A-patches and the points of a scan, in both directions.

#include <span>

#include "patch_distance/patch_distance.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/point_tree.hpp"

namespace scanmill::a_patches {

struct Certificate {
    struct Farthest {
        double distance = 0;
        Vec3 place = Vec3::Zero();
    };
    Farthest point;  ///< the point that is farthest from the surface
    std::size_t beyond = 0;  ///< number of points farther from the surface than the limit
    /// The place on the surface that is farthest from the points. Its distance is that from the nearest point, less the
    /// distance of that point from its 6th neighbour; 0 if this is negative.
    Farthest surface;
};

/// `distances` are those of distances_to_patches() by point. Measures the surface at the vertices of a tessellation
/// with 4 segments per edge. A point without a distance counts as the farthest distance that is measured, if the
/// surface is closed; else it does not count, as it is beside the boundary. Pre: at least one point. Ties: the first
/// point or vertex. Bytes do not depend on the number of threads. Cost: about 50 us per triangle of the mesh.
Certificate certify(const PatchComplex& patches, const PatchDistances& distances, std::span<const Vec3> points,
                    const PointTree& tree, bool is_closed, double limit, Execution& execution);

/// Triangles nearest to a point that is farther from the surface than `limit` and than three standard deviations of the
/// noise; ascending. The nearest other point must be on the same side, at least half as far: a single point is an
/// outlier. The noise follows from the differences between the distances of neighbours, since what a surface misses is
/// nearly equal at both.
std::vector<u32> far_triangles(const TriangleMesh& mesh, const PatchDistances& distances, const PointTree& tree,
                               double limit, Execution& execution);

}  // namespace scanmill::a_patches
