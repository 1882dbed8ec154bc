// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <cmath>

#include "merge/pose_files.hpp"
#include "scanmill/filter/error.hpp"

namespace scanmill::merging {

Eigen::Matrix3d rotation_of(std::span<const double, 4> quaternion, std::string_view place, const Warn& warn) {
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

}  // namespace scanmill::merging
