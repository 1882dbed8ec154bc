// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `transform`, and poses: rigid motions as JSON.
///
///     {"scanmill": 1, "unit": "m", "frame": "bunny",
///      "poses": [{"scan": "bun000.ply", "rotation": [0, 0, 0, 1], "translation": [0, 0, 0]}]}
///
/// A pose with rotation q = [qx, qy, qz, qw] and translation t maps a point p to R(q) p + t. Four members are optional:
/// `unit`, `frame` (the name of the frame that all poses lead to), `scan` (the frame that the pose starts from), and
/// `rms` in a pose (what the fit that found the pose left). Instead of rotation and translation, a pose may have
/// `"matrix"`: four rows of four numbers that map (p, 1). Coordinates are world coordinates.
///
/// A scan that a registration could not place has its reason in place of a motion:
///
///     {"scan": "bun090.ply", "refused": "no-overlap: at most 12 % with any other view"}
///
/// The optional member `edges` lists the pairs of views from which the poses were found (PoseEdge). Their pose leads
/// from the first view's frame to the second's, in the unit of the document.
///
///     "edges": [{"views": ["bun000.ply", "bun045.ply"], "matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0],
///                [0, 0, 0, 1]], "overlap": 0.5, "front": 0, "missing": 0.01, "slide": 0.02, "score": 0.49}]
///
/// The JSON form of a transform is such a document: the motions, then the refused frames, then the edges. Motions are
/// written as matrices, which keep every bit.

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "scanmill/data/transform.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

struct ScanPose {
    std::string scan;  ///< the name or stem of the scan's file, as written; may be empty in JSON
    RigidTransform transform{};  ///< the identity for a refused scan
    std::optional<std::string> refused{};  ///< why the scan has no pose; without a value if it has one
};

/// The poses in the order of the document, with the refused scans; at least one. Edges are checked, but not returned.
/// Quaternions are scaled to length 1, with a warning if rounding
/// to six digits does not explain the change. Throws Error with the number of the pose (from 1) for unknown keys,
/// missing, superfluous or infinite numbers, a quaternion whose length is more than 0.1 % off 1, a matrix that is not a
/// rigid motion, and a refused scan that has a motion, no name or no reason.
std::vector<ScanPose> poses_from_json(const nlohmann::ordered_json& document, const OnWarning& warn);

/// The rotation of the quaternion x, y, z, w, scaled to length 1 as in poses_from_json(). `place` begins every message:
/// "line 3".
Eigen::Matrix3d rotation_of(std::span<const double, 4> quaternion, std::string_view place, const OnWarning& warn);

/// The motion of a matrix, which is given row by row: a rotation in the upper left, the translation in the last column,
/// 0 0 0 1 in the last row. The rotation is made orthonormal to the last digits; an orthonormal rotation keeps every
/// bit. Throws Error for another last row, a number that is not finite, and a rotation that is more than 1e-6 off. The
/// message names a scale or a reflection.
RigidTransform motion_of(std::span<const double, 16> matrix, std::string_view place);

}  // namespace scanmill
