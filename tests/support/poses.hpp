// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Poses for tests.

#include "scanmill/data/transform.hpp"

namespace scanmill::test {

inline RigidTransform inverse_of(const RigidTransform& pose) {
    const Eigen::Matrix3d rotation = pose.rotation.transpose();
    return {rotation, -(rotation * pose.translation), pose.unit, pose.to, pose.from};
}

}  // namespace scanmill::test
