// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds reference points along feature lines, each with the direction of the edge and the normals of both faces.
///
/// Directions and normals are length-weighted means over a window: the point's segment and two segments on either side.
/// The window ends where lines meet, and at a corner of more than 45 degrees. A corner is measured between the chords
/// of two segments on either side, since boundaries over scanned points have corners of one segment everywhere. The
/// window shrinks until the line turns by at most 45 degrees in it, measured between its chords before and after the
/// point. It shrinks to one segment where the left normals cancel out.
///
/// Source: Wang 2006, section 5.2. The window replaces the fan of triangles in that thesis, since lines have no mesh.

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
    /// Whether no segment of the window has a right normal. Then n2 = e x n1, and alpha is a right angle.
    bool assumed;
    /// Mean length of the window's segments.
    double segment_length;
    /// Largest distance of the chord at T beyond the edge, on the right: the sagitta of a line that turns right.
    double beyond;
    /// Radius of the hole that the line bounds; NaN for other lines and for holes that are not round.
    double hole_radius;
};

/// Consecutive reference points along a line, or along a part of it between left-out segments.
struct Chain {
    bool closed;
    u32 begin, end;  ///< range of its points
};

struct ReferencePoints {
    std::vector<ReferencePoint> points;
    std::vector<Chain> chains;
    /// Number of creases that whole_lines() left out.
    std::size_t left_out_creases = 0;
    /// Number of pairs of boundary lines along one edge. The later line is left out there.
    std::size_t paired_lines = 0;
    /// 95 % quantile of the roughness at the vertices of lines with 16 or more vertices; 0 without such lines. The
    /// roughness is the distance, across the line, between a vertex and the quadratic in arc length that fits the
    /// vertices up to four before and after it.
    double edge_roughness = 0;
};

/// First, creases are made whole: of two sides of a bevel one is left out, and so are short branches; the parts between
/// are joined (see whole_lines.hpp). Lines are numbered after that.
///
/// Finds reference points at about `spacing`. A closed line gets max(3, round(length / spacing)) points at equal arc
/// lengths. An open line gets max(1, round(length / spacing)) points; the outer ones are half a spacing from its ends.
///
/// Two patches of region-grow end in two boundary lines along one edge. At least one of these lines has the normals of
/// both patches. Two segments match if three conditions are met. They run in opposite directions (to within 45
/// degrees). Their middles are within two median segment lengths. The left normal of each is within 30 degrees of the
/// other's right normal, if there is one. The nearest such segment matches; ties: the lower row. Two runs of segments
/// are paired if they match along half of the shorter run. The run of the earlier line then gets points on the
/// intersection of the planes of both faces. The matching part of the other run gets none.
///
/// The mesh near a point may show other faces than the line does. The point then gets its faces, tangent and position
/// from the mesh: see edge_fit.hpp. The search radius is `error` plus twice the larger of the segment length and the
/// mean edge length there. Of this larger length, at most `radius` (of the ball) counts. An assumed face is replaced if
/// the mesh has an edge along the line (to within 60 degrees) and a face beyond it at 30 degrees or more.
///
/// Then points that repeat a point of a longer line (ties: of an earlier one) on the same edge are left out. Such a
/// point is nearer than 3/4 spacing, at most `error` and 1.5 segment lengths beside the tangent of the longer line, and
/// has both normals within 30 degrees. So the many short creases of a blunted edge are one edge.
///
/// Throws Error for
/// - any line with too few vertices or with arrays that do not fit;
/// - a choice without lines;
/// - a chosen line that is an open boundary, or has a segment of length 0, a coordinate or normal that is not finite,
///   no left normal, a normal that is not a unit vector, or equal normals on both sides;
/// - more than 10^6 points.
///
/// Cost: O(n log n) in the segments and points.
ReferencePoints find_reference_points(const FeatureGraph& features, const LineChoice& choice, double spacing,
                                      const TriangleTree& mesh, double error, double radius, const Context& context);

}  // namespace scanmill::probing
