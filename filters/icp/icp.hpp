// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The rigid motion that brings a scan onto a surface near it, by iterated closest points.
///
/// Source: Chen and Medioni 1992 for point to plane; Chetverikov, Svirko, Stepanov and Krsek 2002 for trimming;
/// Gelfand, Ikemoto, Rusinkiewicz and Levoy 2003 for motions that the surface does not determine.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct IcpParams {
    /// A point that is farther from the target has no pair. If absent, 5 % of the smaller of the two diagonals.
    std::optional<Length> max_distance;
    /// Share of the pairs that do not count in the last iterations, those with the largest residuals first. With 0, all
    /// pairs count equally: least squares.
    Ratio trim = Ratio::percent(10);
    u32 max_iterations = 50;
};

struct IcpResult {
    /// From the source's world coordinates to the target's; from and to are the names of their frames.
    RigidTransform transform;
    /// Root mean square residual of the points that lie on the target, see `overlap`.
    double rms = 0;
    /// Share of the source's points that lie on the target: their residual is at most `cut`.
    double overlap = 0;
    /// The largest residual that counts in the last iteration, before trimming.
    double cut = 0;
    /// Number of motions that were computed and applied one after the other.
    u32 iterations = 0;
    /// Whether the last iteration moved no point by more than `tolerance`.
    bool converged = false;
    /// Largest motion of a point in the last iteration, and the motion that counts as none: 1/10,000 of the spacing of
    /// the points that are used.
    double last_motion = 0, tolerance = 0;
    /// Smallest eigenvalue of H, see icp(), and the number of its eigenvalues below 0.002.
    double slide = 0;
    u32 free_directions = 0;
};

/// Refines the pose in which the source is: finds the motion that minimises the residuals between the source's points
/// and the target's planes next to them.
///
/// Pairs. Each point belongs to the nearest point of the target, its foot. The residual of a mesh is the distance to
/// the foot. Its direction is the line from the foot to the point, so that edges and vertices of the mesh act as what
/// they are, and not as the plane of one of their triangles. The residual of points is the distance to the plane
/// through the nearest point. The plane has the direction of the column `normal`, if there is one; otherwise it is the
/// plane of the 50 nearest neighbours. No pairs are: points farther than `max_distance`; feet on the boundary of an
/// open mesh; points that are beside the sampled area of a target of points: farther beside the nearest point than its
/// 12th neighbour.
///
/// Weights. A pair with residual r counts with (1 - (r / cut)²)², and not at all beyond `cut` (Tukey's biweight).
/// `cut` begins with `max_distance` and is halved whenever the motion has become small. It ends at 4.685 standard
/// deviations of the residuals, estimated by their median. Dents and burrs therefore attract the scan only in the first
/// iterations. Once `cut` has arrived there, the share `trim` of the pairs with the largest residuals does not count
/// either. Earlier, it would remove those surfaces that show where to move. With `trim` 0 all pairs have the weight 1,
/// so a part that is too long comes to lie in the middle; with other values, it comes to lie at one end, or the
/// position along it is not determined.
///
/// Motion. Each iteration solves the Gauss-Newton equations H x = -g with H = mean of J^T J, J = (c × n / R, n), over
/// the weighted pairs: n is the direction of the residual, c the point relative to the pairs' centroid, R the root mean
/// square of |c|. Directions of motion with an eigenvalue below 0.002 are not determined by the surfaces; the scan does
/// not move along them.
///
/// Pre:  finite coordinates, equal units. The names of the frames may differ. Lengths refer to the source.
/// Post: doubts the result if `max_iterations` do not suffice, if a direction is not determined (with the shape that
///       has it), if less than 30 % of the points lie on the target, and if the residuals fill the range up to
///       `max_distance` evenly.
///       Throws Error for fewer than 6 points, a target without triangles or with less than 6 points, triangles without
///       area only, points at one position, NaN, different units, parameters out of range, fewer than 6 pairs, pairs of
///       less than 5 % of the points (also at the end), and pairs that do not determine 3 of the 6 directions.
/// Ties: of equally near triangles the smallest row counts; of equally near points the lowest by x, y, z. Pairs with
///       exactly the residual at which `trim` cuts count.
/// Determinism: bytes do not depend on the number of threads.
/// Cost: of more than 50,000 source points, evenly chosen 50,000 along a space-filling curve are used, for the metrics
///       as well. About 0.05 s per iteration for these on one core; usually 10 to 20 iterations. A target of points
///       takes 10 us per point in addition for its planes.
/// Metrics: `rms`, `overlap`, `iterations`, `slide`.
IcpResult icp(const PointCloud& source, const TriangleMesh& target, const IcpParams& params, Context& context);
IcpResult icp(const PointCloud& source, const PointCloud& target, const IcpParams& params, Context& context);

}  // namespace scanmill
