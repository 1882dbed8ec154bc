// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Rigid motions from the numbers that people write them with: quaternions and matrices, of finite precision.

#include <span>
#include <string_view>

#include "scanmill/formats/poses/poses.hpp"

namespace scanmill {

/// The usual rotation of the quaternion x, y, z, w scaled to length 1. `place` begins every message: "line 3". Throws
/// Error when the length is more than 0.1 % off 1; what rounding to six digits does not explain is told.
Eigen::Matrix3d rotation_of(std::span<const double, 4> quaternion, std::string_view place, const OnPoseWarning& warn);

/// The motion of a matrix in rows: a rotation in the upper left, the translation in the last column, 0 0 0 1 in the
/// last row. The rotation is made orthonormal to the last digits; one that already is keeps every bit. Throws Error for
/// another last row, a number that is not finite, and a rotation that is more than 1e-6 off: with its scale, or when it
/// is a reflection.
RigidTransform motion_of(std::span<const double, 16> matrix, std::string_view place);

}  // namespace scanmill
