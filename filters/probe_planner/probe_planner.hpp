// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plans where and from which direction a touch probe touches the edges of a part, so that the ball meets the edge
/// before a face, although the scan shows the edge only to within the scanner's error; and proves it by simulation.
///
/// Source: Wang 2006, chapter 5; both faces in closed form, collisions, order and the pairing of lines are our own.

#include <optional>
#include <vector>

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/probes.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct ProbePlannerParams {
    enum class Features { all, creases, holes, boundaries };
    /// r, of the probe's ball; above 0. No default.
    Length radius;
    /// delta: the largest distance of a reference point from the true edge, across the edge: what the scanner errs, and
    /// what thinning and triangulating add. 0 or more, below `radius`. No default.
    Length scanner_error;
    /// Distance between touches along a line; above 0.
    Length spacing = Length::percent_of_diagonal(1);
    /// phi of all touches, -90 to 90 degrees, whether or not it is safe; absent: the smallest safe one of each touch.
    std::optional<Angle> approach;
    /// h: how far along the bisector of the faces an approach begins; above 0. Absent: 4 radius + scanner_error +
    /// clearance.
    std::optional<Length> retract;
    /// Between the part, and ball and stylus, on moves from touch to touch; 0 or more. Absent: radius.
    std::optional<Length> clearance;
    /// Above 0, below `radius`. Absent: 0.6 radius.
    std::optional<Length> stylus_radius;
    /// From the ball's centre; above `radius`. Absent: 20 radius.
    std::optional<Length> stylus_length;
    /// The largest angle between the machine's axis and the direction from the part to the probe; 0 to 180 degrees.
    Angle max_tilt = Angle::degrees(90);
    /// From the ball along the stylus; three numbers, not all 0.
    std::vector<double> machine_axis = {0, 0, 1};
    /// The lines that are probed.
    Features features = Features::all;
    /// 1, or 2: two touches of each reference point, from both sides of the bisector, which together measure the edge
    /// exactly. 2 excludes `approach`.
    u32 directions = 1;
};

struct ProbePlannerResult {
    ProbePlan plan;
    std::size_t assumed = 0;  ///< touches whose second face is assumed
    std::size_t unreachable = 0, concave = 0, too_narrow = 0, too_tilted = 0, obstructed = 0;
    /// Tried positions of reference points, 1,000 per touch, for which a face is met before the edge.
    std::size_t false_touches = 0;
    /// Touches whose ball, moved against the mesh, does not meet it near the reference point first, or rests on a face
    /// there, or whose stylus meets the mesh on the way. Only a given `approach` plans such ones.
    std::size_t wrong_contacts = 0;
    double travel = 0;  ///< length of all moves
    double edge_roughness = 0;
    std::size_t paired_lines = 0;
    /// With two `directions`: reference points that got one touch, since the range leaves less than 10 degrees between
    /// two, or one of them is too tilted, obstructed or does not pass a hole.
    std::size_t single = 0;
};

/// Plans touches at `spacing` along the chosen lines (see reference_points.hpp). The angle phi of an approach is
/// measured from the bisector of the faces, in the plane perpendicular to the edge.
///
/// A touch gets the smallest |phi| for which: the ball meets the edge before a face for every position of the reference
/// point within `scanner_error` (see contact_range.hpp; where there is none and the second face is assumed, for every
/// position on the first face); the approach is tilted by at most `max_tilt`; ball and stylus do not meet the mesh
/// elsewhere (within radius + reach of the reference point facets belong to the edge); the ball, moved against the
/// mesh, meets it within the reach of the reference point, and not squarely on one of the two faces (to 1 degree), as
/// where another part continues a face; and the start can be left along the machine's axis. The reach is scanner_error
/// and 1.5 segment lengths, but at most the radius: creases of thinned scans zigzag by about a segment. Tried in steps
/// of 1 degree; of phi and -phi the positive one, towards the left face, first. The start is h / cos phi from the
/// reference point (at most 6 h), or up to 8 radii farther if the way up is not free there. Touches without such a phi
/// stay in the plan with the first reason that applies: concave, too-narrow, too-tilted, obstructed. With `approach`,
/// that phi is used; only concave edges, holes, tilt and collisions prevent the touch.
///
/// Collisions are checked for the planned T only; raise `stylus_radius` by `scanner_error` for approaches from below.
///
/// A ball that comes from above meets the edge of a round hole of radius R before the opposite edge if
/// r sin psi <= R, with the angle psi between the preferred direction (the bisector, the middle of the known range, or
/// the given approach) and the normal of the left face; else the touch is too narrow.
///
/// Post: false shares are those of 1,000 seeded random positions per touch. They evaluate the closed form that chose
/// phi, so without `approach` they are 0 and only confirm the range. Order and moves: see tour.hpp. Metrics: the
/// counts above; a warning if the edge roughness exceeds `scanner_error`; a doubt if no touch can be made.
///
/// Throws Error: a parameter out of range; features and mesh in different units or named frames; a mesh without
/// triangles or with a vertex that is not finite; a closed mesh with a negative volume; features as in
/// find_reference_points(); lines of which every reference point is farther than radius + scanner_error + 1.5 segment
/// lengths from the mesh.
///
/// Deterministic: the same bytes for any number of threads. Cost: O((touches + triangles) log triangles + lines² +
/// lines · touches on closed lines), about 0.05 ms per touch; obstructed touches, for which all directions are tried,
/// up to some milliseconds.
ProbePlannerResult probe_planner(const FeatureGraph& features, const TriangleMesh& mesh,
                                 const ProbePlannerParams& params, Context& context);

}  // namespace scanmill
