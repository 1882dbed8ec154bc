// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A simulated coordinate measuring machine: makes the touches of a probe plan against a mesh, with the errors of the
/// reference points and of the machine. virtual-scan is its counterpart for scanners.
///
/// Source: Wang 2006, chapter 5; Hart 1996 for the tracing of a ball.

#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/probes.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct VirtualProbeParams {
    /// Standard deviation of the machine's error, in each coordinate.
    Length noise;
    /// The largest distance, across the edge, by which a reference point is moved at random; below the ball's radius.
    Length reference_error;
};

struct VirtualProbeResult {
    /// One point per touch that met the mesh, in the order in which the machine makes them; in the plan's frame.
    /// Columns: `uncertainty` (float64, a length): the noise; `touch` and `feature` (uint32): as in the plan;
    /// `approach` (3 × float64): the unit vector u from the part to the probe.
    PointCloud points;
    /// Rows of these touches in the plan.
    std::vector<u32> rows;
    std::size_t missed = 0;
};

/// Makes every touch of the plan that has no reason against it. The reference point T moves by a random vector, uniform
/// in the disc of radius `reference_error` perpendicular to the tangent, and `start` moves with it. The ball's centre
/// then moves from the start along -u until the ball is within 1e-9 radii of the mesh. Noise is added to the centre.
/// The reported position is that of a machine that compensates the ball's radius along the approach: centre - r u. If
/// the ball meets the true edge at Q, the position errs by the distance d of T from Q across u, and by r - sqrt(r² -
/// d²) along u.
///
/// A touch is missed, and reports nothing, if the centre passes T by r + scanner_error without contact, or if the ball
/// meets the mesh at its start. The stylus is not simulated: probe-planner has checked it. The mesh needs no topology,
/// and distances have no sign. Equally near triangles give the same contact.
///
/// Throws Error for a mesh without triangles, with a NaN or infinite vertex or an index out of range; for a plan of
/// another frame or unit than the mesh, without a touch that is made, with a radius that is not above 0 or directions
/// that are not unit vectors; for negative or infinite lengths; for a `reference_error` of the ball's radius or more;
/// and if every touch is missed. Doubts its result if more than a tenth of the touches is missed.
/// Deterministic: bytes depend on the seed, not on the number of threads; touches are made in parallel.
/// Cost: O(log triangles) per step, and some ten steps per touch. A ball that grazes the surface takes more, at most
///       100,000. A ball that slides so long, nearer than 1e-4 radii, is in contact.
/// Metrics: `points`, `missed`.
VirtualProbeResult virtual_probe(const ProbePlan& plan, const TriangleMesh& mesh, const VirtualProbeParams& params,
                                 Context& context);

}  // namespace scanmill
