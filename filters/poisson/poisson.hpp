// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Makes a surface of points with normals: the boundary between inside and outside that agrees best with all of them.
///
/// Source: Kazhdan, Hoppe 2013, "Screened Poisson surface reconstruction"; by pcl::Poisson.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct PoissonParams {
    /// The octree has at most 2^depth cells along an edge of its cube; from 3 to 12.
    u32 depth = 9;
    /// Edge of the octree's cube, in longest sides of the points' box; above 1, at most 10.
    double scale = 1.5;
    /// Share of the vertices, the least dense ones, that are removed; from 0 to below 1.
    Ratio trim = Ratio::percent(2);
    /// Vertices farther than this from every point are removed as well; above 0. Empty: none.
    std::optional<Length> max_distance;
};

struct PoissonResult {
    /// With the vertex column `density` (1 × float32). Every vertex is in a triangle.
    TriangleMesh mesh;
    /// Vertices removed by `trim` and `max_distance`, and with them those left without a triangle.
    std::size_t trimmed = 0;
    /// Points that are not used, because their normal is 0, NaN or infinite.
    std::size_t without_normal = 0;
    /// Holes of a few edges that PCL leaves in the surface, and that were filled.
    std::size_t cracks = 0;
    /// Boundary loops of the mesh.
    std::size_t loops = 0;
    /// Share of the mesh's area that is far from all points.
    double invented = 0;
    /// Share of the points that are far from the surface, before trimming.
    double missed = 0;
    /// Share of the vertices whose nearest points have normals on the other side.
    double against = 0;
    /// Edge of the octree's smallest possible cell.
    double cell = 0;
};

/// The surface where the function jumps that is 1 inside and 0 outside, whose gradient is nearest to the points'
/// normals and which is half at the points (least squares, on an octree that is fine where points are dense).
///
/// Density. That of a vertex is (m / d)², where d is the distance to its 8th nearest position of the points (to the
/// last one if there are fewer), and m the median, over all positions, of the distance to the 8th nearest other one. It
/// is about 1 where points are as dense as usual, and 1/100 where they are ten times as far away. The floor(trim ×
/// #vertices) vertices of least density are removed, with their triangles; ties: the lowest rows.
///
/// Invented. A vertex is far from all points if its distance to the nearest one is more than twice the distance from
/// there to the 8th nearest other one. Every triangle counts as invented in the share of its vertices that are far.
///
/// Missed. A position of the points, of about 10,000 spread evenly over them, that is farther from the surface before
/// trimming than twice the smallest cell and twice the distance to its 8th nearest other one.
///
/// Against. A vertex of the surface before trimming, the sum of whose 8 nearest positions' normals has a negative
/// product with the vertex's normal.
///
/// Pre: the column `normal`, 3 numbers, of any length above 0, to the outside; finite coordinates; at least 4 different
///      positions with a normal, not on one line. Throws Error otherwise, for a parameter out of range, if no surface
///      separates the points, and if trimming leaves no triangle.
/// Post: triangles are counter-clockwise seen from the outside of the normals. With a trim of 0 and no `max_distance`
///       the surface is closed, unless it leaves the octree's cube, which is centred on the points' box: that of an
///       open sheet does, and one with a gap near a face of the cube.
/// Doubts its result if more than 5 % of its area is invented or of the points missed, and if more than 5 % of the
/// vertices are against their points. Warns of points without a normal, of a surface that leaves the cube, of cracks
/// that stay open, of a closed surface that is inside out, and of columns of the points other than `normal`, which are
/// dropped.
///
/// Deterministic: the same bytes for any number of threads and any processor; PCL works on one thread. They depend on
/// the order of the points. PCL cannot be cancelled: the call returns after its part. It prints messages on stdout and
/// stderr, keeps the octree's memory for the next call, and leaks 4^(depth + 2) bytes.
/// Cost: time and memory grow with the surface's area in cells, fourfold with every `depth` until cells are as small as
/// the distance between points. Metrics: `triangles`, `trimmed`, `invented`, `missed`, `against`, `without-normal`,
/// `cracks`, `loops`, `cell`.
PoissonResult poisson(const PointCloud& cloud, const PoissonParams& params, Context& context);

}  // namespace scanmill
