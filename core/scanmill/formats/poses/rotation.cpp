// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/poses/rotation.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

void require_rotation(const Eigen::Matrix3d& matrix, std::string_view place) {
    constexpr double most = 1e-6;  // of what is left when it is multiplied with its transpose: digits cut off
    const double off = (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (const double determinant = matrix.determinant(); off <= most && determinant < 0)
        throw Error("{}: the matrix is a reflection: its determinant is {:.6g}; a rotation's is 1", place, determinant)
            .hint("an axis points the wrong way");
    if (off <= most) return;
    const double scale = std::cbrt(matrix.determinant());
    const Eigen::Matrix3d unscaled = matrix / scale;
    if ((unscaled * unscaled.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= most)
        throw Error("{}: the matrix scales by {:.6g}; a rotation's axes have the length 1", place, scale)
            .hint("convert the scan's unit instead, or write the rows divided by it");
    throw Error("{}: the matrix is no rotation: its axes are up to {:.3g} off the length 1 or a right angle", place,
                off)
        .hint("write it with seven digits or more");
}

/// The nearest rotation of a matrix that nearly is one: Björck and Bowie 1971, whose every step squares the error.
Eigen::Matrix3d orthonormal(Eigen::Matrix3d matrix) {
    for (int step = 0; step < 2; ++step)
        matrix = 0.5 * (matrix * (3 * Eigen::Matrix3d::Identity() - matrix.transpose() * matrix)).eval();
    return matrix;
}

}  // namespace

Eigen::Matrix3d rotation_of(std::span<const double, 4> quaternion, std::string_view place, const OnPoseWarning& warn) {
    constexpr double of_rounding = 1e-5;  // of components with six digits, with room to spare
    constexpr double most = 1e-3;
    const Eigen::Quaterniond q(quaternion[3], quaternion[0], quaternion[1], quaternion[2]);
    const double length = q.norm();
    if (!(std::abs(length - 1) <= most))
        throw Error("{}: the quaternion {} {} {} {} has the length {:.6g}; a rotation's has 1", place, quaternion[0],
                    quaternion[1], quaternion[2], quaternion[3], length)
            .hint("the order is qx qy qz qw, with four digits or more");
    if (std::abs(length - 1) > of_rounding)
        warn(fmt::format("{}: the quaternion has the length {:.6g} and was scaled to 1", place, length));
    return q.normalized().toRotationMatrix();
}

RigidTransform motion_of(std::span<const double, 16> matrix, std::string_view place) {
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> rows(matrix.data());
    if (!rows.allFinite()) throw Error("{}: the matrix holds a number that is not finite", place);
    if (rows.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        throw Error("{}: the last row of the matrix is {} {} {} {}; expected 0 0 0 1", place, rows(3, 0), rows(3, 1),
                    rows(3, 2), rows(3, 3))
            .hint("the translation is the last column");
    const Eigen::Matrix3d rotation = rows.topLeftCorner<3, 3>();
    require_rotation(rotation, place);
    RigidTransform motion;
    const bool is_exact = rotation * rotation.transpose() == Eigen::Matrix3d::Identity();
    motion.rotation = is_exact ? rotation : orthonormal(rotation);
    motion.translation = rows.topRightCorner<3, 1>();
    return motion;
}

}  // namespace scanmill
