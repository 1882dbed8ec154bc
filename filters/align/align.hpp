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
    /// The motion never scales.
    enum class Scale { none, report } scale = Scale::report;
    /// rows: row i of the source belongs to row i of the target. rectangle: four corners each, in any order around the
    /// rectangle.
    enum class Correspondence { rows, rectangle } correspondence = Correspondence::rows;
    /// Rectangle: three world coordinates in the source, near the corner that belongs to the first target point. A
    /// rectangle is its own image after half a turn; this decides which of the two is meant.
    std::optional<std::vector<Length>> first_corner;
    /// Rectangle: points away from the upper side of a plate without a column `normal`, in the source as in the target.
    /// Absent: the order of the source's rows decides, else (0, 0, 1).
    std::optional<std::vector<double>> up;
};

/// What `error_at_part` is computed for.
struct AlignPart {
    BoundingBox box;  ///< in world coordinates
    std::string frame;  ///< its name
};

struct AlignResult {
    /// From the source's world coordinates to the target's; from and to are the names of their frames.
    RigidTransform transform;
    /// The source row of every target row.
    std::vector<u32> partner;
    /// Target minus moved source, by target row.
    std::vector<Vec3> residuals;
    /// Root of the mean squared length of the residuals; the largest length.
    double rms = 0, largest_residual = 0;
    /// Size of the target relative to the source by Umeyama's method: 1 where both are equally large.
    double scale = 1;
    /// Standard error of a moved point, the largest over the corners of the part's box; empty without a part.
    std::optional<double> error_at_part;
};

/// Least squares: the rotation R (never a reflection) and the translation t with the smallest sum of squared residuals
/// |b_i - R a_i - t|² over the pairs of source a_i and target b_i, weighted equally.
///
/// Standard error at a point x of the source: sigma sqrt(3/n + tr([x - m] J^-1 [x - m]^T)), where m is the source's
/// centroid, [v] the cross-product matrix, J = sum(|c|² I - c c^T) over c = a_i - m, and sigma² = sum|residual|² /
/// (3 n - 6). The error grows with the distance between the part and the pairs, whatever the residuals are.
///
/// Rectangle: both corner lists are brought in counter-clockwise order seen from their upper sides. The upper side is
/// that of the mean of the column `normal`; else that of `up`, if it is given; else, of the source, the side from which
/// its rows go counter-clockwise, if they go once around (the area of the polygon is more than half of that of the
/// largest of the three possible ones); else that of (0, 0, 1). A direction more than 60 degrees off the plate's normal
/// does not decide: the next one does, but the rows only where there are no normals. The source corner nearest to
/// `first_corner` belongs to the first target point. Ties: of equally near corners none is chosen; that is refused.
///
/// Throws Error for fewer than 3 pairs, different numbers of points, NaN or infinite coordinates, different units; for
/// pairs that fit ten times better after mirroring; for pairs that leave the rotation uncertain by more than 1 degree
/// (standard error), as all pairs on a line do; for rows whose normals all point to opposite sides after the motion
/// (without rows that have no normal, or NaN); for a part in another frame than the source. Rectangle: other numbers
/// than 4 corners, no `first_corner`, one that is not nearer than half the shorter side to a corner, corners that do
/// not go once around a centre, an upper side that cannot be decided, and sides that fit another choice of the corner
/// better.
///
/// A scale that differs from 1 by more than 1e-4 explains the residuals if it leaves less than a third of them (RMS),
/// of three pairs less than a tenth. If `scale` is reported, such a result is doubtful. If with that scale the rotation
/// would be certain, the refusal names the scale.
///
/// Cost: O(n). Metrics: `rms`, `largest-residual`, `residual` (numbered, of the first 100 target rows), `scale` if it
/// is reported, `error-at-part` if there is a part.
AlignResult align(const PointCloud& source, const PointCloud& target, const std::optional<AlignPart>& part,
                  const AlignParams& params, Context& context);

}  // namespace scanmill
