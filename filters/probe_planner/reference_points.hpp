// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Touch points on edges: reference points along feature lines, with the edge's direction and the normals of both
/// faces there.
///
/// Directions and normals are length-weighted means over a window of two segments on either side of the point's
/// segment; the window ends where lines meet and where the line turns: at a corner with more than 45 degrees between
/// the chords of two segments on either side (boundaries over scanned points have corners of one segment everywhere).
/// It shrinks until the line turns by at most 45 degrees in it, measured between its chords before and after the point,
/// and to one segment where the left normals cancel out.
///
/// Source: Wang 2006, section 5.2. The window replaces the thesis's fan of triangles, since lines have no mesh.

#include <vector>

#include "probe_planner/lines.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::probing {

struct ReferencePoint {
    u32 line;  ///< row of the polyline
    Vec3 position;  ///< T
    Vec3 tangent, left_normal, right_normal;  ///< e, n1, n2: unit vectors, the normals perpendicular to e
    double interior_angle;  ///< alpha
    /// No segment of the window has a right normal: n2 = e x n1, and alpha is a right angle.
    bool assumed;
    /// Mean length of the window's segments.
    double segment_length;
    /// How far the chord at T may lie beyond the edge, over the right side: the sagitta of a line that turns right.
    double beyond;
    /// Radius of the hole that the line bounds; NaN for other lines and for holes that are not round.
    double hole_radius;
};

/// Reference points that follow one another along a line; all of it, or a part between left-out ones.
struct Chain {
    bool closed;
    u32 begin, end;  ///< range of its points
};

struct ReferencePoints {
    std::vector<ReferencePoint> points;
    std::vector<Chain> chains;
    /// Pairs of boundary lines along one edge, of which the later one is left out there.
    std::size_t paired_lines = 0;
    /// The 95 % quantile, over the vertices of lines with 16 or more, of the distance across the line between a vertex
    /// and the quadratic in arc length through the vertices up to four before and after it; 0 without such lines.
    double edge_roughness = 0;
};

/// Reference points at about `spacing`: on a closed line max(3, round(length / spacing)) at equal arc lengths, on an
/// open one max(1, round(length / spacing)), half a spacing from its ends.
///
/// Two patches of region-grow end in two boundary lines along one edge, one or both with the normals of both. Segments
/// match that run in opposite directions (to within 45 degrees), have their middles within two median segment lengths,
/// and have left normals that are within 30 degrees of the other's right normal; the nearest one, ties: the lower row.
/// Runs of segments that match along half of the shorter run are paired: the one of the earlier line gets points on the
/// intersection of the planes of both faces, the matching part of the other one none.
///
/// Where the mesh within `error` and two segment lengths of a point (or two mean edge lengths there; at most twice
/// `radius`, the ball's) shows other faces than the line does, the faces, the tangent and the point on the edge are the
/// mesh's: see edge_fit.hpp. An assumed face is replaced if there is one beyond an edge along the line (to within 60
/// degrees) at 30 degrees or more.
///
/// Then points are left out that are nearer than 3/4 spacing to a point of a longer line (ties: of an earlier one)
/// on the same edge: at most `error` and 1.5 segment lengths beside its tangent, both normals within 30 degrees. So
/// the many short creases of a blunted edge are one edge.
///
/// Throws Error: any line with too few vertices or with arrays that do not fit; no line of the choice; among those an
/// open boundary, a segment of length 0, a coordinate or normal that is not finite, a left normal that is missing, a
/// normal that is not a unit vector, equal normals on both sides; more than 10^6 points.
/// Cost: O(n log n) in the segments and points.
ReferencePoints find_reference_points(const FeatureGraph& features, const LineChoice& choice, double spacing,
                                      const TriangleTree& mesh, double error, double radius, const Context& context);

}  // namespace scanmill::probing
