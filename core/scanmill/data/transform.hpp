// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `transform`: rigid motions from named frames into one frame. One motion is the common case.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

/// A frame that got no motion.
struct RefusedFrame {
    std::string from;  ///< the frame's name; not empty
    std::string reason;  ///< not empty
};
constexpr auto fields(const RefusedFrame*) {
    return std::tuple{field("from", &RefusedFrame::from), field("reason", &RefusedFrame::reason)};
}

/// An edge of a pose graph: two views whose relative pose was found from their overlap and accepted. The measures have
/// no unit. The views need not have a motion in the list that the edge belongs to.
struct PoseEdge {
    RigidTransform pose;  ///< from the frame of the first view to the frame of the second
    double overlap = 0;  ///< share of points with a partner in the other view; the larger share of both views
    double front = 0;  ///< share of points in front of the surface that the other view's scanner saw
    double missing = 0;  ///< share of points that the other view's scanner faces but did not measure
    double slide = 0;  ///< least eigenvalue of the point-to-plane fit; near 0 if the views slide on each other
    double score = 0;  ///< larger is better
};
constexpr auto fields(const PoseEdge*) {
    using E = PoseEdge;
    return std::tuple{field("pose", &E::pose),       field("overlap", &E::overlap), field("front", &E::front),
                      field("missing", &E::missing), field("slide", &E::slide),     field("score", &E::score)};
}

/// Motions into one frame. All have the same `to`; they and the poses of the edges have the same unit. A result of a
/// filter has at least one motion.
struct Transforms {
    std::vector<RigidTransform> motions;
    std::vector<RefusedFrame> refused;
    std::vector<PoseEdge> edges;

    Transforms() = default;
    Transforms(RigidTransform motion) : motions{std::move(motion)} {}

    /// The motion that starts from the frame with this name. A single motion is returned whatever frame it starts from,
    /// unless the frame was refused. Throws Error for a refused frame (with its reason), for a frame without a motion
    /// (with the names of the known frames), and for a frame with several motions. Cost: O(n).
    const RigidTransform& motion_from(const std::string& frame) const;
};
constexpr auto fields(const Transforms*) {
    return std::tuple{field("motions", &Transforms::motions), field("refused", &Transforms::refused),
                      field("edges", &Transforms::edges)};
}

}  // namespace scanmill
