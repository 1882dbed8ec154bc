// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Grows a surface over thinned points, triangle by triangle from a seed, until the points end. Reports its boundaries,
/// holes and sharp edges.
///
/// Every boundary edge looks for its *suitable point*: one within the search radius, for which no angle of the new
/// triangle is below `min_angle`, and the normal differs from that of every triangle that shares an edge by at most
/// `max_normal_angle`; of these the one whose circle with the edge is empty, as in a Delaunay triangulation. An empty
/// circle with a radius above a third of the search radius is a hole.
///
/// What keeps the result a surface:
/// - A triangle is rejected when one of its edges has two triangles, when it overlaps triangles around one of its
///   corners (exact, projected along the normal), when a nearer point lies in it, and when the boundary crosses it.
/// - Its normal must agree with the normals of its points: within 60 degrees, at sharp edges 85. This keeps sheets
///   apart.
/// - In space it must not intersect triangles near it. This is tested where the surface is not flat, candidates were
///   rejected, limits are relaxed, or a boundary that faces the other way is near.
/// - In the end every vertex keeps one fan of triangles, the largest.
///
/// Order: edges where the surface is flat and evenly sampled go first. Edges without a suitable point are retried in
/// three rounds with min_angle × 2/3, 1/3 and 1/30, max_normal_angle × 7/6, 4/3 and 4/3, and the search radius
/// × 1.1, 1.15 and 1.15. Further components start at unused points; components that meet are joined.
///
/// Loops: the thesis distinguishes cases by where the point lies (outside, next on the loop, elsewhere on it). Here a
/// triangle cancels opposite half-edges, and loops split, close and merge by themselves. Loops without a larger empty
/// circle are closed afterwards, see holes.hpp.
///
/// Source: Wang 2006, chapter 4, made robust; the choice by empty circles after Delaunay.

#include <optional>

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct RegionGrowParams {
    enum class Score {
        circumradius,  ///< the point whose circle with the edge is empty
        midpoint  ///< as in the thesis: the point nearest the edge's midpoint
    };
    /// Least angle of every triangle of the first pass; 0 or more, below 60 degrees.
    Angle min_angle = Angle::degrees(10);
    /// Largest angle between the normals of a new triangle and its neighbours; above 0, at most 180 degrees.
    Angle max_normal_angle = Angle::degrees(90);
    /// The suitable point is no farther from an end of the edge, and the radius of the triangle's circumcircle is at
    /// most a third of this. Above 0; absent: 2 √3 B, where B is the point's value in the column `bin-size` or, without
    /// one or where the density contradicts it, the voxel size that the density corresponds to (see search_radii.hpp).
    std::optional<Length> search_radius;
    /// Edges whose triangles' normals differ by more are creases. 0 to 180 degrees.
    Angle sharp_angle = Angle::degrees(40);
    /// Standard deviation of the points' distances from the surface, for the creases; 0 or more. Absent: estimated, see
    /// noisy_normals.hpp.
    std::optional<Length> noise;
    /// Loops of at most this many edges are closed, and longer ones (up to 100 edges) without an empty circle as large
    /// as a hole, unless `max_normal_angle` is below 90 degrees and their dihedral deviations exceed 4/3 of it. 0 (and
    /// 1 and 2) closes none; at most 100.
    u32 close_holes = 4;
    Score score = Score::circumradius;
    /// Row of the point where the seed triangle starts; absent: the flattest point.
    std::optional<u32> start;
};

struct RegionGrowResult {
    /// Over the used points, in input order with their columns. Its sharp edges are the creases, and the boundary edges
    /// beyond which the surface continues in another patch.
    TriangleMesh mesh;
    /// Its boundaries, holes and creases with the normals on both sides; beyond a boundary that is a sharp edge the
    /// normals of the other patch.
    FeatureGraph features;
    /// Per vertex its row in the cloud, ascending.
    Array<u32> rows;
    /// Per triangle: 0 formed under the given limits, 1 to 3 under relaxed ones, 4 closing a hole.
    Array<u8> passes;
    std::size_t components = 0;
    /// Boundary loops, and those of them that are holes.
    std::size_t loops = 0, holes = 0;
    /// Loops at parts so thin that the surface may continue there (see boundaries.hpp).
    std::size_t thin_loops = 0;
    /// Rows without a vertex: repeats of an earlier row, and distinct points in no triangle.
    std::size_t duplicates = 0, unused_points = 0;
    /// Boundary edges that would have chosen a boundary point if it were not for the angle to their triangle.
    std::size_t patch_edges = 0;
    std::size_t creases = 0, corners = 0, closed_holes = 0;
    /// Standard deviation of the points' distances from the surface, given or estimated.
    double noise = 0;
    /// Triangles removed again, where a vertex had several fans or to close a hole.
    std::size_t removed_triangles = 0;
    /// Loops whose area does not decide whether they are holes, and triangles without area, as counted by
    /// find_features().
    std::size_t ambiguous_loops = 0, triangles_without_area = 0;
};

/// Grows a surface over the cloud, in as many components as needed.
///
/// The points should be thinned: of even density, at least locally. A column `normal` (three numbers per row) is used
/// with its sign, unless the signs are mixed or few points have a normal (see normals.hpp): then it gives directions,
/// and decides the orientation of components. A normal that is zero or not finite is replaced by the principal one.
/// Without the column, normals are the principal directions of the 12 nearest neighbours. A column `bin-size` (one
/// number per row, in the scan's unit; values not above 0 or not finite are unknown) gives the voxels of a thinning. Of
/// rows at one position the smallest bin-size is used, and the first normal by x, y, z.
///
/// Throws Error with numbers and a way out: fewer than three distinct points, all on one line, a NaN or infinite
/// coordinate, a normal column of another size, a parameter out of range, a start that is no row or starts nothing, and
/// a search radius too small for any triangle (or layers so close that no triangle is flat).
///
/// Post: an oriented manifold: every edge is in one triangle, or in two with opposite half-edges; the triangles of
/// every vertex form one fan. No two vertices at one position. Triangles around a vertex do not overlap, projected
/// along its normal, except those of pass 4, with dihedral deviations of up to 172 degrees. No triangle that was tested
/// in space (above), nor one that closes a hole, intersects triangles near it. Angles of triangles of pass 0 keep the
/// limits; later passes relax them. Components that enclose a volume face outwards, as do open ones that bulge; flat
/// ones face up. With normals they face as three quarters of these do. Ties: equal scores (to 1e-9) by position along a
/// space-filling curve. So the mesh depends neither on the order of the points, up to numbering, nor on the number of
/// threads.
///
/// Cost: O(n log n) time where the nearest 16 points decide, about 450 bytes per point beside the result. An edge where
/// they do not, or without a suitable point, considers the open points within its search radius, and if one of them
/// could be suitable all m there, up to four times: O(m log m) each, and again for every point that is rejected because
/// of the boundary or other points. So a radius of many spacings costs O(n m log m) on noisy scans; use the default
/// there.
///
/// Metrics: see plugin.cpp. Warns when more than half a percent of the points stay unused, when most points are too
/// dense for their `bin-size`, about normals with mixed signs, and about what find_features() could not decide. Doubts:
/// more than 2 % of the points unused, triangles that by themselves make more than one crease per 20 of more than
/// 10,000 edges, normals that end the surface, loops at thin parts.
RegionGrowResult region_grow(const PointCloud& cloud, const RegionGrowParams& params, Context& context);

}  // namespace scanmill
