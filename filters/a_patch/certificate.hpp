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
        Vec3 position = Vec3::Zero();
    };
    Farthest point;  ///< the point that is farthest from the surface
    std::size_t beyond = 0;  ///< number of points farther from the surface than max-error
    /// The position on the surface that is farthest from the points. Its distance is that from the nearest point, less
    /// the distance of that point from its 6th neighbour; 0 if this is negative.
    Farthest surface;
};

/// `distances` are those of distances_to_patches() by point. A point without one is measured from a tessellation with 4
/// segments per edge; if it is beside the boundary of an open surface, it does not count. The surface is measured at
/// the vertices of that tessellation. Pre: at least one point; `tree` contains the points. Ties: the first point or
/// vertex. Bytes do not depend on the number of threads. Cost: about 50 us per triangle of the mesh.
Certificate certify(const PatchComplex& patches, const PatchDistances& distances, std::span<const Vec3> points,
                    const PointTree& tree, bool is_closed, double max_error, Execution& execution);

/// Triangles nearest to a point that is farther from the surface than `max_error` and than five standard deviations of
/// the noise; ascending. Points farther away than the longest edge of their triangle do not count. The nearest other
/// point must be on the same side, at least half as far: a single point is an outlier. The noise follows from the
/// differences between the distances of neighbours, since what a surface misses is nearly equal at both. `mesh` is the
/// one over which the patches were built, before its repair. Points without a distance do not count. Bytes do not
/// depend on the number of threads. Cost: about 1 us per point.
std::vector<u32> far_triangles(const TriangleMesh& mesh, const PatchDistances& distances, const PointTree& tree,
                               double max_error, Execution& execution);

}  // namespace scanmill::a_patches
