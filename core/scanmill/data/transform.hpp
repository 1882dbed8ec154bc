// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `transform`: a rigid motion from one named frame to another.

#include <Eigen/Core>
#include <optional>
#include <string>

#include "scanmill/data/frame.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

struct RigidTransform {
    /// Orthonormal with determinant +1.
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    /// Lengths in `unit`. Applies to world positions, which include the frame's origin.
    Vec3 translation = Vec3::Zero();
    LengthUnit unit = LengthUnit::unknown;
    std::string from, to;
    /// Root mean square distance that is left between what the motion brings together, in `unit`. Without a value if
    /// the motion was not found by fitting.
    std::optional<double> rms{};

    Vec3 apply(const Vec3& world) const { return rotation * world + translation; }
};
constexpr auto fields(const RigidTransform*) {
    return std::tuple{field("rotation", &RigidTransform::rotation),
                      field("translation", &RigidTransform::translation),
                      field("unit", &RigidTransform::unit),
                      field("from", &RigidTransform::from),
                      field("to", &RigidTransform::to),
                      field("rms", &RigidTransform::rms)};
}

}  // namespace scanmill
