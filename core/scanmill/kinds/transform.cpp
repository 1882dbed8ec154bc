// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/transform.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

void require_rotation(const Eigen::Matrix3d& matrix, std::string_view place) {
    // The largest entry of R Rᵀ − I that counts as rounding. It covers numbers with truncated digits.
    constexpr double most = 1e-6;
    const double off = (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (const double determinant = matrix.determinant(); off <= most && determinant < 0)
        throw Error("{}: the matrix is a reflection: its determinant is {:.6g}; a rotation's is 1", place, determinant)
            .hint("an axis points the wrong way");
    if (off <= most) return;
    const double scale = std::copysign(std::sqrt(matrix.squaredNorm() / 3), matrix.determinant());
    const Eigen::Matrix3d unscaled = matrix / scale;
    if ((unscaled * unscaled.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= most)
        throw Error("{}: the matrix scales by {:.6g}; a rotation's axes have the length 1", place, scale)
            .hint("convert the scan's unit instead, or write the rows divided by it");
    throw Error("{}: the matrix is not a rotation: its axes are up to {:.3g} off the length 1 or a right angle", place,
                off)
        .hint("write it with seven digits or more");
}

/// The rotation nearest to a matrix that is almost a rotation (Björck and Bowie 1971). Every step squares the error.
Eigen::Matrix3d orthonormal(Eigen::Matrix3d matrix) {
    for (int step = 0; step < 2; ++step)
        matrix = 0.5 * (matrix * (3 * Eigen::Matrix3d::Identity() - matrix.transpose() * matrix)).eval();
    return matrix;
}

}  // namespace

Eigen::Matrix3d rotation_of(std::span<const double, 4> quaternion, std::string_view place, const OnWarning& warn) {
    constexpr double of_rounding = 1e-5;  // rounding of components with six digits, with room to spare
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

namespace {

struct PoseDocument {
    std::string scan;
    std::optional<std::array<double, 4>> rotation;
    std::optional<Vec3> translation;
    std::optional<std::array<std::array<double, 4>, 4>> matrix;
    std::optional<double> rms;
};
constexpr auto fields(const PoseDocument*) {
    using T = PoseDocument;
    return std::tuple{
        field("scan", &T::scan, "The name of the coordinate system, or of the scan, that the pose starts from.")
            .nullable()
            .optional(),
        field("rotation", &T::rotation, "A quaternion x, y, z, w.").optional(),
        field("translation", &T::translation).optional(),
        field("matrix", &T::matrix, "Four rows, instead of rotation and translation.").optional(),
        field("rms", &T::rms,
              "Root mean square distance that is left between what the motion brings together, in the unit.")
            .optional()};
}

struct PosesDocument {
    LengthUnit unit = LengthUnit::unknown;
    std::string frame;
    std::vector<PoseDocument> poses;
};
constexpr auto fields(const PosesDocument*) {
    using T = PosesDocument;
    return std::tuple{field("unit", &T::unit).nullable().optional(),
                      field("frame", &T::frame, "The coordinate system that all poses lead to.").nullable().optional(),
                      field("poses", &T::poses)};
}

RigidTransform motion_at(const PoseDocument& pose, const std::string& place, const OnWarning& warn) {
    if (pose.matrix) {
        for (const auto& [name, is_given] :
             {std::pair("rotation", pose.rotation.has_value()), std::pair("translation", pose.translation.has_value())})
            if (is_given)
                throw Error("{}: has a matrix and '{}'; expected a matrix, or rotation and translation", place, name);
        return motion_of(std::span<const double, 16>(pose.matrix->front().data(), 16), place);
    }
    if (!pose.rotation) throw Error("{}: 'rotation' is missing", place);
    if (!pose.translation) throw Error("{}: 'translation' is missing", place);
    RigidTransform motion;
    motion.rotation = rotation_of(*pose.rotation, place, warn);
    motion.translation = *pose.translation;
    return motion;
}

}  // namespace

std::vector<ScanPose> poses_from_json(const Json& json, const OnWarning& warn) {
    const auto document = from_document<PosesDocument>(json);
    if (document.poses.empty()) throw Error("contains no pose; expected \"poses\" to be a list of poses");
    std::vector<ScanPose> poses;
    for (const PoseDocument& each : document.poses) {
        ScanPose pose{each.scan, motion_at(each, fmt::format("pose {}", poses.size() + 1), warn)};
        pose.transform.unit = document.unit;
        pose.transform.to = document.frame;
        if (each.rms && !(*each.rms >= 0))
            throw Error("pose {}: 'rms' is {}; expected a length of at least 0", poses.size() + 1, *each.rms)
                .hint("leave it out if the motion was not found by a fit");
        pose.transform.rms = each.rms;
        poses.push_back(std::move(pose));
    }
    return poses;
}

template <>
struct KindTraits<RigidTransform> : NotGeometric<RigidTransform>, NoProperties<RigidTransform> {
    static constexpr std::string_view name = "transform";
    static constexpr std::string_view json_member = "poses";
    static void to_json(const RigidTransform& transform, Json& json) {
        PoseDocument pose{transform.from, {}, {}, std::array<std::array<double, 4>, 4>{}, transform.rms};
        for (std::size_t row = 0; row < 3; ++row) {
            const auto at = static_cast<Eigen::Index>(row);
            const auto r = transform.rotation.row(at);
            (*pose.matrix)[row] = {r[0], r[1], r[2], transform.translation[at]};
        }
        json = document_of(PosesDocument{transform.unit, transform.to, {pose}});
        json["poses"][0]["matrix"][3] = {0, 0, 0, 1};
    }
    static RigidTransform from_json(const Json& document, const OnWarning& warn) {
        const std::vector<ScanPose> poses = poses_from_json(document, warn);
        if (poses.size() > 1) throw Error("contains {} poses; a transform is one", poses.size());
        RigidTransform transform = poses.front().transform;
        transform.from = poses.front().scan;
        return transform;
    }
    static Json schema() {
        Json schema = schema::document(name, JsonForm<PosesDocument>::schema());
        schema["properties"]["poses"].update({{"minItems", 1}, {"maxItems", 1}});
        return schema;
    }
};

template Kind kind_of<RigidTransform>();

}  // namespace scanmill
