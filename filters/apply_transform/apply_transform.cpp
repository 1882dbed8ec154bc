// SPDX-License-Identifier: GPL-3.0-or-later
#include "apply_transform/apply_transform.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

void require_rigid(const RigidTransform& transform) {
    constexpr double most = 1e-6;  // equals the limit for matrices in files
    const Eigen::Matrix3d& rotation = transform.rotation;
    const double off = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(off <= most) || !(rotation.determinant() > 0))
        throw Error(
            "the transform is not a rigid motion: its matrix times the transposed matrix differs by {:.3g} from "
            "the identity, and its determinant is {:.6g}; 0 and 1 are needed",
            off, rotation.determinant())
            .hint("`align` finds a rigid motion between points");
    if (!transform.translation.allFinite())
        throw Error("the translation is ({}, {}, {}); it must be finite", transform.translation.x(),
                    transform.translation.y(), transform.translation.z())
            .hint("check the file of the transform");
}

/// The motion for values in this frame.
const RigidTransform& motion_for(const std::string& name, const Transforms& transforms) {
    const auto starts_here = [&](const RigidTransform& motion) { return motion.from == name; };
    const auto ends_here = [&](const RigidTransform& motion) { return motion.to == name; };
    if (!name.empty() && std::ranges::any_of(transforms.motions, ends_here) &&
        std::ranges::none_of(transforms.motions, starts_here))
        throw Error("the value is already in the frame '{}', the target frame of the transform", name)
            .hint("wire the value as it was before this transform; a transform is applied once");
    const RigidTransform& transform = transforms.motion_from(name);
    if (!name.empty() && !transform.from.empty() && name != transform.from)
        throw Error("the value is in the frame '{}'; the transform starts from '{}'", name, transform.from)
            .hint("wire a value in that frame, or declare its frame at the workflow's input");
    return transform;
}

}  // namespace

Value apply_transform(const Value& value, const Transforms& transforms, Context& context) {
    const std::optional<Frame> frame = frame_of(value);
    if (!frame)
        throw Error("the value is {}, which has no positions", name_of(value.kind()))
            .hint("wire points, a mesh, features, patches or probes");
    const RigidTransform& transform = motion_for(frame->name, transforms);
    require_rigid(transform);
    if (transform.unit == LengthUnit::unknown && frame->unit != LengthUnit::unknown && !transform.translation.isZero(0))
        context.warn(fmt::format("the transform has no unit; its translation is read in {}, the unit of the value",
                                 symbol(frame->unit)));
    Value moved = placed(value, transform);
    if (transform.to.empty() && !frame->name.empty()) {
        context.warn(
            fmt::format("the transform does not name its target frame; the value is no longer in "
                        "'{}', and its frame has no name",
                        frame->name));
        Frame unnamed = *frame_of(moved);
        unnamed.name.clear();
        moved = reframed(moved, unnamed);
    }
    context.progress(1);
    return moved;
}

}  // namespace scanmill
