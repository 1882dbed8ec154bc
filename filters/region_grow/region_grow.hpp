// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Grows a surface over thinned points, triangle by triangle from a seed triangle. Reports its boundaries, holes and
/// sharp edges.
///
/// Every boundary edge looks for its *suitable point*. This point is within the search radius. No angle of the new
/// triangle is below `min_angle`. The normal of the new triangle differs from that of every triangle that shares an
/// edge by at most `max_normal_angle`. Of all such points, the suitable one has an empty circle with the edge, as in a
/// Delaunay triangulation. An empty circle with a radius above a third of the search radius is a hole.
///
/// These rules keep the result a surface:
/// - A triangle is rejected if one of its edges already has two triangles, if it overlaps triangles around one of its
///   corners (exact, projected along the normal), if a nearer point lies in it, or if the boundary crosses it.
/// - The normal of a triangle must agree with the normals of its points: within 60 degrees, at sharp edges within 85
///   degrees. This keeps sheets apart.
/// - A triangle must not intersect triangles near it in space. This is tested where the surface is not flat, where
///   candidates were rejected, under relaxed limits, and near a boundary that faces the other way.
/// - In the end, every vertex keeps only its largest fan of triangles.
///
/// Order: edges where the surface is flat and evenly sampled go first. Edges without a suitable point are retried in
/// three rounds with min_angle × 2/3, 1/3 and 1/30, max_normal_angle × 7/6, 4/3 and 4/3, and the search radius × 1.1,
/// 1.15 and 1.15. Further components start at unused points. Components that meet are joined.
///
/// Loops: the thesis distinguishes cases by the position of the point (outside, next on the loop, elsewhere on it).
/// Here, a triangle cancels opposite half-edges. Loops split, close and merge by themselves. Loops without an empty
/// circle as large as a hole are closed afterwards, see holes.hpp.
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
    /// Largest distance of the suitable point from the nearer end of its edge. With Score::circumradius, circumcircles
    /// of triangles have at most a third of it as radius. Above 0. If absent, it is 2 √3 B, where B is the point's
    /// value in the column `bin-size`. Without the column, or where the density contradicts it, B is the voxel size
    /// that matches the density (see search_radii.hpp).
    std::optional<Length> search_radius;
    /// An edge is a crease if the normals of its triangles differ by more than this; 0 to 180 degrees.
    Angle sharp_angle = Angle::degrees(40);
    /// Standard deviation of the points' distances from the surface, for the creases; 0 or more. If absent, it is
    /// estimated, see noisy_normals.hpp.
    std::optional<Length> noise;
    /// Loops of at most this many edges are closed. Longer loops, up to 100 edges, are closed if they have no empty
    /// circle as large as a hole. If `max_normal_angle` is below 90 degrees, such a longer loop stays open where
    /// closing it needs dihedral deviations above 4/3 of that angle. 0, 1 and 2 close none; at most 100.
    u32 close_holes = 4;
    Score score = Score::circumradius;
    /// Row of the point where the seed triangle starts; absent: the flattest point.
    std::optional<u32> start;
};

struct RegionGrowResult {
    /// The surface over the used points, in input order with their columns. Its sharp edges are the creases, and the
    /// boundary edges beyond which the surface continues in another patch.
    TriangleMesh mesh;
    /// Boundaries, holes and creases of the mesh with the normals on both sides. Beyond a boundary that is a sharp
    /// edge, the normals are those of the other patch.
    FeatureGraph features;
    /// Per vertex its row in the cloud, ascending. Points of lines that are not in the cloud count on from its size, by
    /// x, y, z.
    Array<u32> rows;
    /// Per triangle: 0 if formed under the given limits, 1 to 3 if formed under relaxed ones, 4 if it closes a hole.
    Array<u8> passes;
    std::size_t components = 0;
    /// Number of boundary loops, and number of those that are holes.
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
    /// Triangles removed again, because a vertex had several fans or to close a hole.
    std::size_t removed_triangles = 0;
    /// Scan points left out beside lines, and segments of lines that are edges of the mesh.
    std::size_t near_lines = 0, line_segments = 0;
    /// Segments of lines that are not: without support by the scan, in favour of a segment that they cross, and those
    /// that the surface does not contain. See lines.hpp.
    std::size_t unsupported_lines = 0, crossing_lines = 0, missing_lines = 0;
    /// Loops whose area does not decide whether they are holes, and triangles without area. find_features() counts
    /// both.
    std::size_t ambiguous_loops = 0, triangles_without_area = 0;
};

/// Grows a surface over the cloud, in as many components as needed.
///
/// The points should be thinned: of even density, at least locally. A column `normal` (three numbers per row) is used
/// with its signs. If the signs are mixed or few points have a normal (see given_normals.hpp), only the directions are
/// used, and the signs decide the orientation of components. A normal that is zero or not finite is replaced by the
/// principal one. Without the column, normals are the principal directions of the 12 nearest neighbours. A column
/// `bin-size` (one number per row, in the scan's unit) gives the voxels of a thinning. Its values that are not finite
/// or not above 0 count as unknown. Of rows at one position, the smallest bin-size is used, and the first normal by x,
/// y, z.
///
/// Throws Error, with numbers and a way out, for
/// - fewer than three distinct points, or all points on one line;
/// - a NaN or infinite coordinate, or a normal column of another size;
/// - a parameter out of range, or a start that is not a row or starts nothing;
/// - a search radius too small for any triangle, or layers so close that no triangle is flat.
/// Post: an oriented manifold. Every edge is in one triangle, or in two with opposite half-edges. The triangles of
///       every vertex form one fan. No two vertices are at one position. Triangles around a vertex do not overlap,
///       projected along its normal. Triangles of pass 4 are an exception, with dihedral deviations of up to 172
///       degrees. No triangle that was tested in space (above), nor one that closes a hole, intersects triangles near
///       it. Triangles of pass 0 keep the limits on angles; later passes relax these. Closed components
///       face outwards, or inwards round a cavity. Open ones that bulge face outwards; flat ones face up. If the signs
///       of given normals are mixed or missing, three quarters of a component's normals decide which way it faces.
///       Ties: among equal scores (to 1e-9), the first point along a space-filling curve is used. So the mesh depends
///       neither on the order of the points, up to numbering, nor on the number of threads.
///
/// Cost: O(n log n) time where the nearest 16 points decide; about 450 bytes per point beside the result. Other edges,
///       and edges without a suitable point, consider the open points within their search radius. If one of these could
///       be suitable, they consider all m points there, up to four times. Each time costs O(m log m), and again for
///       every point that is rejected because of the boundary or other points. So a radius of many spacings costs O(n m
///       log m) on noisy scans; use the default there.
///
/// Metrics: see plugin.cpp. Warns if more than half a percent of the points stay unused, or if most points are too
/// dense for their `bin-size`. Also warns of normals with mixed signs, and of cases that find_features() could not
/// decide. Doubts the result if more than 2 % of the points are unused, if normals end the surface, or if loops lie at
/// thin parts. Also doubts it if the triangles by themselves make more than one crease per 20 edges, of more than
/// 10,000 edges.
RegionGrowResult region_grow(const PointCloud& cloud, const RegionGrowParams& params, Context& context);

/// Grows a surface that contains the segments of `lines` as edges.
///
/// prepare_lines() in lines.hpp joins the points of the lines to the cloud, leaves out scan points beside them, divides
/// long segments and leaves out segments that cross others or have no scan points near them. No triangle may cross or
/// cover a segment, nor join points on its two sides (see edge_sides.hpp). Points within 1.5 spacings take the normal
/// of their side. Creases beside segments that noise explains are left out (see creases.hpp). At segments, neither
/// max_normal_angle nor the normals of points limit the angle between triangles.
/// Segments that the growth misses are restored by restore_fixed_edges() in restored_edges.hpp. Each part of a divided
/// segment counts as a segment.
///
/// Post: every segment that is not counted as unsupported, crossing or missing is a sharp edge of the mesh. It is part
/// of a crease in `features`, or of a boundary if it has one triangle. A warning or doubt gives number, position and
/// reason for the others. The result does not depend on the order of the lines, except for ties between crossing ones.
/// Throws Error also as prepare_lines() does, and if the point `start` is left out.
RegionGrowResult region_grow(const PointCloud& cloud, const FeatureGraph& lines, const RegionGrowParams& params,
                             Context& context);

}  // namespace scanmill
