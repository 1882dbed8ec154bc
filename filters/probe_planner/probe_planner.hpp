// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plans where and from which direction a touch probe touches the edges of a part. The scan shows an edge only to
/// within the scanner's error. The ball meets the edge before a face nevertheless. A simulation checks this.
///
/// Source: Wang 2006, chapter 5; both faces in closed form, collisions, order and the pairing of lines are our own.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/probes.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct ProbePlannerParams {
    enum class Features { all, creases, holes, boundaries };
    /// Radius r of the probe's ball; above 0. No default.
    Length radius;
    /// delta: the largest distance of a reference point from the true edge, across the edge. It is the scanner's error
    /// plus what thinning and triangulation add. 0 or more, below `radius`. No default.
    Length scanner_error;
    /// Distance between touches along a line; above 0.
    Length spacing = Length::percent_of_diagonal(1);
    /// Angle phi of all touches, from -90 to 90 degrees, whether or not it is safe. If absent, each touch has its
    /// smallest safe angle.
    std::optional<Angle> approach;
    /// h: distance from the edge, along the bisector of the faces, at which an approach begins; above 0. If absent, it
    /// is 4 radius + scanner_error + clearance.
    std::optional<Length> retract;
    /// Least distance of ball and stylus from the part on moves between touches; 0 or more. If absent: radius.
    std::optional<Length> clearance;
    /// Radius of the stylus; above 0, below `radius`. If absent: 0.6 radius.
    std::optional<Length> stylus_radius;
    /// Length of the stylus from the ball's centre; above `radius`. If absent: 20 radius.
    std::optional<Length> stylus_length;
    /// The largest angle between the machine's axis and the direction from the part to the probe; 0 to 180 degrees.
    Angle max_tilt = Angle::degrees(90);
    /// Direction from the ball along the stylus; three numbers, not all 0.
    std::vector<double> machine_axis = {0, 0, 1};
    /// The lines that are probed.
    Features features = Features::all;
    /// Number of touches of each reference point, 1 or 2. Two touches come from both sides of the bisector and together
    /// measure the edge exactly. 2 excludes `approach`.
    u32 directions = 1;
    /// A text file with the header of a DMIS program of the plan, with the placeholders of formats/dmis/header.hpp. If
    /// absent, the default header.
    std::optional<std::filesystem::path> dmis_header;
    /// The spelling of moves in a DMIS program of the plan.
    DmisGoto dmis_goto = DmisGoto::plain;
    /// Decimals of coordinates in a DMIS program of the plan; at most DmisOptions::most_decimals. If absent, as many as
    /// keep 1e-4 of the radius, and at least 4.
    std::optional<u32> dmis_decimals;
};

struct ProbePlannerResult {
    ProbePlan plan;
    std::size_t assumed = 0;  ///< touches whose second face is assumed
    std::size_t unreachable = 0, concave = 0, too_narrow = 0, too_tilted = 0, obstructed = 0;
    /// Tried positions of reference points, 1,000 per touch, for which the ball meets a face before the edge.
    std::size_t false_touches = 0;
    /// Touches with a wrong contact in a simulated move: the ball does not meet the mesh near the reference point
    /// first, or rests on a face there, or the stylus meets the mesh on the way. Only a given `approach` plans such
    /// touches.
    std::size_t wrong_contacts = 0;
    double travel = 0;  ///< length of all moves
    double edge_roughness = 0;
    std::size_t left_out_creases = 0;  ///< left out, see reference_points.hpp
    std::size_t paired_lines = 0;
    /// With two `directions`: number of reference points that got one touch. There, the range leaves less than 10
    /// degrees between two touches, or one of the two is too tilted, obstructed or does not pass a hole.
    std::size_t single = 0;
};

/// Plans touches at `spacing` along the chosen lines (see reference_points.hpp). The angle phi of an approach is
/// measured from the bisector of the faces, in the plane perpendicular to the edge.
///
/// A touch gets the smallest |phi| that meets these conditions:
/// - The ball meets the edge before a face for every position of the reference point within `scanner_error` (see
///   contact_range.hpp). If no phi does and the second face is assumed, every position on the first face suffices.
/// - The approach is tilted by at most `max_tilt`.
/// - Ball and stylus do not meet the mesh elsewhere. Facets within radius + reach of the reference point belong to the
///   edge.
/// - The ball, moved against the mesh, meets it within the reach of the reference point. It does not rest squarely on
///   one of the two faces (to 1 degree), as it does where another part continues a face.
/// - The probe can leave the start along the machine's axis.
/// The reach is scanner_error plus 1.5 segment lengths, but at most scanner_error plus the radius: creases of thinned
/// scans zigzag by about a segment. Angles are tried in steps of 1 degree. Of phi and -phi, the positive one, towards
/// the left face, is tried first. The start is h / cos phi from the reference point (at most 6 h), or up to 8 radii
/// farther if the way up is not free there. A touch without such a phi stays in the plan with the first reason that
/// applies: concave, too-narrow, too-tilted, obstructed. With `approach`, that phi is used. Only concave edges, holes,
/// tilt and collisions then prevent the touch.
///
/// Collisions are checked for the planned T only; raise `stylus_radius` by `scanner_error` for approaches from below.
///
/// A ball that comes from above meets the edge of a round hole of radius R before the opposite edge if r sin psi <= R.
/// Otherwise the touch is too narrow. Here psi is the angle between the preferred direction and the normal of the left
/// face. The preferred direction is the bisector, the middle of the known range, or the given approach.
///
/// Post: a false share is the share of 1,000 seeded random positions per touch for which the ball meets a face first.
///       It evaluates the closed form that chose phi. So without `approach` it is 0 and only confirms the range. For
///       order and moves see tour.hpp. Metrics: the counts above. Warns if the edge roughness exceeds `scanner_error`.
///       Doubts the result if no touch can be made, with a way out.
///
/// Throws Error: a parameter out of range; features and mesh in different units or named frames; a mesh without
/// triangles or with a vertex that is not finite; a file of a DMIS header that cannot be read, or that
/// dmis::require_header() refuses; a closed mesh with a negative volume; features as in
/// find_reference_points(); lines of which every reference point is farther than radius + scanner_error + 1.5 segment
/// lengths from the mesh.
///
/// Deterministic: the same bytes for any number of threads. Cost: O((touches + triangles) log triangles + lines² +
/// lines · touches on closed lines), about 0.05 ms per touch. An obstructed touch, for which all directions are tried,
/// takes up to some milliseconds.
ProbePlannerResult probe_planner(const FeatureGraph& features, const TriangleMesh& mesh,
                                 const ProbePlannerParams& params, Context& context);

/// What to change so that more touches can be made, by the most frequent reason of those that cannot; of equally
/// frequent ones: no safe direction, holes, tilt, obstacles, concave edges. Where no direction is safe, a larger ball
/// reaches more; in a hole, a smaller one. Pre: not empty.
std::string way_out(std::span<const ProbeTouch> touches);

}  // namespace scanmill
