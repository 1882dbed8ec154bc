// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Compensates the radius of a touch probe: makes points of the edges, and lines through them, from the ball's centres
/// or the contacts that a measuring machine reports.
///
/// One touch measures an edge along its approach only. Two touches of one reference point from two directions fix the
/// edge: their balls touch it both, so it lies where the circles round their centres intersect.
///
/// Source: Wang 2006, chapter 5, for the touches; the intersection is our own.

#include <array>
#include <optional>
#include <vector>

#include "scanmill/data/features.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/probes.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct ProbeCompensateParams {
    /// What the positions are: `contact`, the ball's centre moved by the radius against the approach, as machines
    /// report that compensate by themselves; or `centre`, the ball's centre.
    enum class Reported { contact, centre };
    /// How the plane across the edge is found, in which a pair's circles are intersected.
    enum class Tangent { line, approaches };

    /// r: the radius of the ball. No default; above 0.
    Length radius;
    Reported reported = Reported::contact;
    /// delta: the largest distance of a reference point from the true edge, of which single touches know nothing.
    Length scanner_error;
    Tangent tangent = Tangent::line;
    /// sigma of touches without the column `uncertainty`: the machine's error per coordinate.
    Length noise;
    /// Largest distance of the lines' chords from a curved edge. Empty: 0.5 % of the median distance of joined touches.
    std::optional<Length> chord_error;
    /// The distance of neighbouring touches of a line. Empty: the median distance of its consecutive touches.
    std::optional<Length> spacing;
};

struct ProbeCompensateResult {
    static constexpr u32 no_row = ~u32(0);

    /// Points of the edges, in the order in which their touches appear first; in the frame of the input. Columns:
    /// `touch` and `feature`, if the input has them, with its numbers and types; `approach` (3 × float64), for a pair
    /// the unit vector of the mean; `uncertainty` (float64, a length).
    PointCloud points;
    /// The touched lines, of type crease, with points on circles between the touches (see arcs.hpp). Their normals are
    /// zero: touches do not measure the faces. No corners.
    FeatureGraph features;
    /// For each point, the two rows of the input that it is made from, ascending; a single has no_row second.
    std::vector<std::array<u32, 2>> rows;
    /// Points made of two touches and of one; rows of the input that no point is made from; points in no line although
    /// they have a feature, without further points of their touch.
    std::size_t paired = 0, single = 0, unused = 0, lone = 0;
    /// Pairs whose tangent is that of their line.
    std::size_t curved = 0;
    /// Points left out of the lines, because another point of the same place is in them.
    std::size_t repeated = 0;
};

/// Reads the columns `approach` (three numbers: the unit vector u from the part to the probe), and, if they exist,
/// `touch` (number of the reference point), `feature` (number of the line) and `uncertainty` (sigma, the machine's
/// error per coordinate; `noise` if absent). The centre of a ball is O = position + r u, or the position itself.
///
/// Pairs:   rows of one `touch` whose approaches are at least 10 degrees apart (within 1e-9 rad). Of more than two rows
///          the two farthest apart are used, and the others are not. The tangent of the edge is the cross product of
///          the approaches. The centres may differ along it; both are projected into the plane across the tangent
///          through their mean. The point is the intersection of the circles of radius r away from the approaches. Its
///          uncertainty is sqrt(sigma1² + sigma2²) / sin gamma, gamma being the angle between the contact normals.
///          With Tangent::line, pairs between two other pairs on each side of their line are corrected by the circle
///          through their neighbours, where the line has no corner (see edge_point.hpp). On a circular edge they are
///          exact then, also if the plan's tangents are not.
/// Singles: all other rows, and all rows without the column `touch`. The point is O - r u, its uncertainty
///          sqrt(sigma² + delta²).
/// Lines:   one sequence of touches per `feature`, in the order of rows; a touch of several singles counts with its
///          first. Consecutive touches are joined if they are nearer than twice the spacing; a gap ends the line and
///          begins another. If the last touch is nearer than 1.5 spacings to the first, and there are three, they are
///          joined, too. Touches nearer than a quarter of the spacing to their predecessor are left out. No lines
///          without `feature`. Between pairs, lines follow the circles through neighbouring pairs.
/// Ties:    of equally large angles, the pair whose rows come first. A distance of exactly twice the spacing is a gap.
///
/// Throws Error for no points, or NaN or infinity among the positions or the numbers above; for a radius that is not
/// above 0, and negative or infinite lengths; without a column `approach`, or with one that is not of unit length
/// (within 1e-4, the rounding of numbers in files); for columns of another number of components; for a negative
/// uncertainty; for one touch with two features; for balls of a pair that do not meet, or whose approaches are within
/// 10 degrees of opposite; for circles that fix no point, because their centres lie on one another (sin gamma below
/// 1e-3) or along the approaches.
/// Doubts its result if the contact normals of the median pair are less than half or more than 1.5 times as far apart
/// as its approaches: the radius or `reported` is probably wrong.
/// Deterministic; one thread. Cost: O(n log n) for n rows, and O(k²) for a touch with k rows.
/// Metrics: `points`, `paired`, `single`, `unused`, `curved`, `lines`, `lone`, `repeated`.
ProbeCompensateResult probe_compensate(const PointCloud& touches, const ProbeCompensateParams& params,
                                       Context& context);

/// The touches with the column `feature`, read from the plan by their column `touch`: a machine's results have the
/// number of the touch alone. Unchanged if they have the column. Throws Error without a column `touch` of whole
/// numbers, and for a number that the plan does not have.
PointCloud with_features(const PointCloud& touches, const ProbePlan& plan);

}  // namespace scanmill
