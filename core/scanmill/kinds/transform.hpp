// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `transform`, and poses: rigid motions as JSON.
///
///     {"scanmill": 1, "unit": "m", "frame": "bunny",
///      "poses": [{"scan": "bun000.ply", "rotation": [0, 0, 0, 1], "translation": [0, 0, 0]}]}
///
/// with rotation = [qx, qy, qz, qw], a point p goes to R(q) p + t; `unit`, `frame` (the name of the frame that all
/// poses lead to) and `scan` (the frame that they start from) may be left out. Instead of rotation and translation a
/// pose may have `"matrix"`, four rows of four numbers that (p, 1) is multiplied with. Coordinates are world
/// coordinates.
///
/// A transform is such a document with one pose, written with its matrix, which keeps every bit.

#include <span>

#include "scanmill/data/transform.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

struct ScanPose {
    std::string scan;  ///< as the file has it: a file's name or stem; may be empty in JSON
    RigidTransform transform;
};

/// In the document's order, at least one. Throws Error with the number of the pose from 1: unknown keys, missing,
/// superfluous or infinite numbers, a quaternion whose length is more than 0.1 % off 1, a matrix that is not a rigid
/// motion. Warns of a quaternion whose length rounding to six digits does not explain; all are scaled to length 1.
std::vector<ScanPose> poses_from_json(const nlohmann::ordered_json& document, const OnWarning& warn);

/// The usual rotation of the quaternion x, y, z, w scaled to length 1. `place` begins every message: "line 3". Throws
/// Error when the length is more than 0.1 % off 1; warns of what rounding to six digits does not explain.
Eigen::Matrix3d rotation_of(std::span<const double, 4> quaternion, std::string_view place, const OnWarning& warn);

/// The motion of a matrix in rows: a rotation in the upper left, the translation in the last column, 0 0 0 1 in the
/// last row. The rotation is made orthonormal to the last digits; one that already is keeps every bit. Throws Error for
/// another last row, a number that is not finite, and a rotation that is more than 1e-6 off: with its scale, or when it
/// is a reflection.
RigidTransform motion_of(std::span<const double, 16> matrix, std::string_view place);

template <>
struct KindTraits<RigidTransform> : NotGeometric<RigidTransform> {
    static constexpr std::string_view name = "transform";
    static void visit(FieldVisitor& visitor, RigidTransform& transform);
    static constexpr std::string_view json_member = "poses";
    static void to_json(const RigidTransform& transform, nlohmann::ordered_json& document);
    /// Throws Error also when there are several poses.
    static RigidTransform from_json(const nlohmann::ordered_json& document, const OnWarning& warn);
};
inline const KindRegistration<RigidTransform> transform_kind;

}  // namespace scanmill
