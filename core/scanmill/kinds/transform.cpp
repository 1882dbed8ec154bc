// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/transform.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind_traits.hpp"

namespace scanmill {

namespace {

void require_rotation(const Eigen::Matrix3d& matrix, std::string_view place) {
    constexpr double most =
        1e-6;  // of an entry of the product with its transpose, minus the identity: covers truncated digits
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

/// The rotation nearest to a matrix that is almost one: Björck and Bowie 1971; every step squares the error.
Eigen::Matrix3d orthonormal(Eigen::Matrix3d matrix) {
    for (int step = 0; step < 2; ++step)
        matrix = 0.5 * (matrix * (3 * Eigen::Matrix3d::Identity() - matrix.transpose() * matrix)).eval();
    return matrix;
}

}  // namespace

Eigen::Matrix3d rotation_of(std::span<const double, 4> quaternion, std::string_view place, const OnWarning& warn) {
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

namespace {

/// Four rows of four numbers, row by row.
std::array<double, 16> matrix_of(const Json& rows, const std::string& place) {
    if (!rows.is_array() || rows.size() != 4) throw Error("{}: 'matrix' is not a list of 4 rows", place);
    std::array<double, 16> values;
    for (std::size_t row = 0; row < 4; ++row)
        std::ranges::copy(numbers_of(rows[row], 4, fmt::format("{}: row {} of 'matrix'", place, row + 1)),
                          values.begin() + static_cast<std::ptrdiff_t>(4 * row));
    return values;
}

RigidTransform motion_at(const Json& item, const std::string& place, const OnWarning& warn) {
    if (!item.contains("matrix")) {
        RigidTransform motion;
        const std::vector<double> quaternion = numbers_of(member(item, "rotation"), 4, place + ": 'rotation'");
        motion.rotation = rotation_of(std::span<const double, 4>(quaternion), place, warn);
        motion.translation = vector_of(member(item, "translation"), place + ": 'translation'");
        return motion;
    }
    for (const char* other : {"rotation", "translation"})
        if (item.contains(other)) throw Error("{}: has a matrix and '{}'; expected one of the two ways", place, other);
    return motion_of(matrix_of(member(item, "matrix"), place), place);
}

}  // namespace

std::vector<ScanPose> poses_from_json(const Json& document, const OnWarning& warn) {
    require_document(document, {"scanmill", "unit", "frame", "poses"});
    const LengthUnit unit = unit_member(document);
    const std::string frame = text_member(document, "frame", "the document");
    const Json& list = member(document, "poses");
    if (!list.is_array() || list.empty()) throw Error("contains no pose; expected \"poses\" to be a list of poses");

    std::vector<ScanPose> poses;
    for (const Json& item : list) {
        const std::string place = fmt::format("pose {}", poses.size() + 1);
        if (!item.is_object()) throw Error("{} is not an object", place);
        require_keys(item, place, {"scan", "rotation", "translation", "matrix"});
        ScanPose pose;
        pose.scan = text_member(item, "scan", place);
        pose.transform = motion_at(item, place, warn);
        pose.transform.unit = unit;
        pose.transform.to = frame;
        poses.push_back(std::move(pose));
    }
    return poses;
}

template <>
struct KindTraits<RigidTransform> : NotGeometric<RigidTransform>, NoProperties<RigidTransform> {
    static constexpr std::string_view name = "transform";
    static void visit(FieldVisitor& visitor, RigidTransform& transform) {
        visitor.small("rotation", transform.rotation);
        visitor.small("translation", transform.translation);
        visitor.small("unit", transform.unit);
        visitor.small("from", transform.from);
        visitor.small("to", transform.to);
    }
    static constexpr std::string_view json_member = "poses";
    static void to_json(const RigidTransform& transform, Json& document) {
        Json pose = Json::object(), rows = Json::array();
        if (!transform.from.empty()) pose["scan"] = transform.from;
        for (int row = 0; row < 3; ++row)
            rows.push_back({transform.rotation(row, 0), transform.rotation(row, 1), transform.rotation(row, 2),
                            transform.translation[row]});
        rows.push_back({0, 0, 0, 1});
        pose["matrix"] = std::move(rows);
        document = {{"scanmill", 1}};
        if (transform.unit != LengthUnit::unknown) document["unit"] = symbol(transform.unit);
        if (!transform.to.empty()) document["frame"] = transform.to;
        document["poses"] = Json::array({std::move(pose)});
    }
    static RigidTransform from_json(const Json& document, const OnWarning& warn) {
        const std::vector<ScanPose> poses = poses_from_json(document, warn);
        if (poses.size() > 1) throw Error("contains {} poses; a transform is one", poses.size());
        RigidTransform transform = poses.front().transform;
        transform.from = poses.front().scan;
        return transform;
    }
};

template Kind kind_of<RigidTransform>();

}  // namespace scanmill
