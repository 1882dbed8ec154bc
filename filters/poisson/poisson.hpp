// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Makes a surface of points with normals: the boundary between inside and outside that agrees best with all of the
/// points and normals.
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
    /// Edge of the octree's cube, as a multiple of the longest side of the points' box; above 1, at most 10.
    double scale = 1.5;
    /// Share of the vertices to remove, those of least density first; from 0 to below 1.
    Ratio trim = Ratio::percent(2);
    /// Vertices farther than this from every point are removed as well; above 0. If empty, no vertex is removed for its
    /// distance.
    std::optional<Length> max_distance;
};

struct PoissonResult {
    /// With the vertex column `density` (1 × float32). Every vertex is in a triangle.
    TriangleMesh mesh;
    /// Vertices removed by `trim` and `max_distance`, including those left without a triangle.
    std::size_t trimmed = 0;
    /// Points that are not used, because their normal is 0, NaN or infinite.
    std::size_t without_normal = 0;
    /// Holes of a few edges that PCL leaves in the surface and fill_holes() fills.
    std::size_t cracks = 0;
    /// Boundary loops of the mesh.
    std::size_t loops = 0;
    /// Share of the mesh's area that is far from all points.
    double invented = 0;
    /// Share of the points that are far from the surface, before trimming.
    double missed = 0;
    /// Share of the vertices where the surface faces away from the normals of the nearest points.
    double against = 0;
    /// Edge of the octree's smallest possible cell.
    double cell = 0;
};

/// Fits a function that is 1 inside and 0 outside by least squares: its gradient is nearest to the points' normals, and
/// it is about one half at the points. The octree that carries it is fine where points are dense. The surface is where
/// the function is one half.
///
/// Density. The density of a vertex is (m / d)². The distance d is that from the vertex to the 8th nearest position of
/// the points (to the last one if there are fewer). The length m is the median, over all positions, of the distance to
/// the 8th nearest other position. The density is about 1 where points are as dense as usual, and 1/100 where they are
/// ten times as far away. The floor(trim × #vertices) vertices of least density are removed, with their triangles;
/// ties: the lowest rows.
///
/// Invented. A vertex is far from all points if its distance to the nearest position is more than twice the distance
/// from that position to its 8th nearest other one. The share of a triangle's vertices that are far is the share of its
/// area that counts as invented.
///
/// Missed. A position is missed if it is far from the surface before trimming: by more than two smallest cells, and by
/// more than twice the distance to its 8th nearest other position. At most 10,000 positions, spread evenly, are tested.
///
/// Against. The normals at the 8 positions nearest to a vertex are summed. The vertex is against its points if its own
/// normal has a negative dot product with this sum. Vertices are those before trimming.
///
/// Pre:  the column `normal`, 3 numbers, of any length above 0, that points outwards; finite coordinates; at least 4
///       different positions with a normal, not on one line. Throws Error otherwise, for a parameter out of range, if
///       no surface separates the points, and if trimming leaves no triangle.
/// Post: triangles are counter-clockwise seen from the side to which the normals point, except those of closed
///       components: these face outwards, or inwards round a cavity (see sides.hpp). With a trim of 0 and no
///       `max_distance`, the surface is closed, unless it leaves the octree's cube, which is centred on the points'
///       box. The surface of an open sheet leaves the cube. A surface with a gap near a face of the cube may leave it,
///       too.
/// Doubts its result if more than 5 % of its area is invented, of the points are missed, or of the vertices are against
/// their points. Doubts handles that the object hardly has (see handles.hpp; invented is a vertex farther than 4
/// median edges from every point). Warns of points without a normal, of a surface that leaves the cube, of cracks that
/// stay open, and of normals that point into the enclosed volume. Columns of the points other than `normal` are
/// dropped, with a warning.
///
/// Deterministic: the same bytes for any number of threads and any processor; PCL works on one thread. The bytes depend
/// on the order of the points. PCL cannot be cancelled: a cancelled call returns only after PCL's part. PCL prints
/// messages on stdout and stderr, keeps the octree's memory for the next call, and leaks 4^(depth + 2) bytes.
/// Cost: time and memory grow with the surface's area in cells. They grow fourfold with every step of `depth`, until
///       cells are as small as the distance between points.
/// Metrics: `triangles`, `trimmed`, `invented`, `missed`, `against`, `without-normal`, `cracks`, `loops`, `cell`.
PoissonResult poisson(const PointCloud& cloud, const PoissonParams& params, Context& context);

}  // namespace scanmill
