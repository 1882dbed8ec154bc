// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The rigid motion that carries points onto corresponding points: from a scanner's frame to a machine's.
///
/// Source: Kabsch 1978 and Umeyama 1991 for the motion; Wang 2006, chapter 5, for the four corners of the base plate.

#include <optional>
#include <vector>

#include "scanmill/data/bounds.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct AlignParams {
    /// Whether the best scale is reported as a check. The motion itself never scales.
    enum class Scale { none, report } scale = Scale::report;
    /// rows: row i of the source belongs to row i of the target. rectangle: the source and the target each have four
    /// corners, in any order.
    enum class Correspondence { rows, rectangle } correspondence = Correspondence::rows;
    /// For `rectangle`: three world coordinates in the source, near the corner that belongs to the first target point.
    /// They are needed because a rectangle also fits itself after half a turn.
    std::optional<std::vector<Length>> first_corner;
    /// For `rectangle`: a direction away from the plate's upper side, in the source and in the target. It counts for
    /// points without a column `normal`. If absent, the order of the source's rows decides, else (0, 0, 1).
    std::optional<std::vector<double>> up;
};

/// The part for which `error_at_part` is computed.
struct AlignPart {
    BoundingBox box;  ///< in world coordinates
    std::string frame;  ///< name of the part's frame
};

struct AlignResult {
    /// From the source's world coordinates to the target's; from and to are the names of their frames.
    RigidTransform transform;
    /// By target row: the row of its partner in the source.
    std::vector<u32> partner;
    /// Target minus moved source, by target row.
    std::vector<Vec3> residuals;
    /// Root mean square of the residuals' lengths, and the largest length.
    double rms = 0, largest_residual = 0;
    /// Size of the target relative to the source by Umeyama's method: 1 where both are equally large.
    double scale = 1;
    /// Standard error of a moved point, the largest over the corners of the part's box; empty without a part.
    std::optional<double> error_at_part;
};

/// Finds the motion by least squares: the rotation R (never a reflection) and the translation t with the smallest sum
/// of squared residuals |b_i - R a_i - t|² over the pairs of source a_i and target b_i, weighted equally.
///
/// The standard error at a point x of the source is sigma sqrt(3/n + tr([x - m] J^-1 [x - m]^T)). Here m is the
/// source's centroid, [v] the cross-product matrix of v, J = sum(|c|² I - c c^T) over c = a_i - m, and sigma² =
/// sum|residual|² / (3 n - 6). With equal residuals, the error grows with the distance between the part and the pairs.
///
/// For `rectangle`, each corner list is put in counter-clockwise order seen from its upper side. The first of these
/// directions that is at most 60 degrees off the plate's normal determines the upper side:
/// - the mean of the column `normal`;
/// - `up`, if it is given;
/// - for a source without normals, the side from which its rows go counter-clockwise, if they go once around: the area
///   of their polygon is more than half of that of the largest of the three possible polygons;
/// - (0, 0, 1), if there is no other direction.
/// The source corner nearest to `first_corner` belongs to the first target point. Ties: if two corners are equally
/// near, Error is thrown.
///
/// Throws Error in these cases:
/// - There are fewer than 3 pairs, different numbers of points, NaN or infinite coordinates, or different units.
/// - The pairs fit ten times better after a reflection.
/// - The pairs leave the rotation uncertain by more than 1 degree (standard error), as all pairs on a line do.
/// - The normals of all pairs point to opposite sides after the motion. Pairs without a finite normal do not count.
/// - The part is empty, or in another frame than the source.
/// - `first_corner` is given for `rows`.
/// - For `rectangle`, there are not 4 corners, or the corners do not go once around a centre.
/// - For `rectangle`, `first_corner` is missing, or its distance to a corner is not less than half the shorter side.
/// - For `rectangle`, no direction determines the upper side, or a corner next to the chosen one fits much better.
///
/// A scale explains the residuals if it differs from 1 by more than 1e-4, and leaves less than a third of their RMS;
/// for three pairs, less than a tenth. If `scale` is `report`, the result is then doubtful. If the rotation is
/// uncertain, but would be certain with that scale, the Error contains the scale.
///
/// Cost: O(n). Metrics: `rms`, `largest-residual`, `residual` (numbered, of the first 100 target rows), `scale` if it
/// is reported, `error-at-part` if there is a part.
AlignResult align(const PointCloud& source, const PointCloud& target, const std::optional<AlignPart>& part,
                  const AlignParams& params, Context& context);

}  // namespace scanmill
