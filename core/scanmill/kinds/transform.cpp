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

using Matrix = std::array<std::array<double, 4>, 4>;

struct PoseDocument {
    std::string scan;
    std::optional<std::array<double, 4>> rotation;
    std::optional<Vec3> translation;
    std::optional<Matrix> matrix;
    std::optional<double> rms;
    std::optional<std::string> refused;
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
            .optional(),
        field("refused", &T::refused, "Why the scan has no pose, instead of a motion.").optional()};
}

struct EdgeDocument {
    std::array<std::string, 2> views;
    Matrix matrix{};
    std::optional<double> rms;
    double overlap = 0, front = 0, missing = 0, slide = 0, score = 0;
};
constexpr auto fields(const EdgeDocument*) {
    using T = EdgeDocument;
    return std::tuple{
        field("views", &T::views, "The names of both views."),
        field("matrix", &T::matrix, "Four rows: the motion from the first view's coordinates to the second's."),
        field("rms", &T::rms, "As in a pose.").optional(),
        field("overlap", &T::overlap, "Share of points with a partner in the other view; the larger of both shares."),
        field("front", &T::front, "Share of points in front of the surface that the other view's scanner saw."),
        field("missing", &T::missing, "Share of points that the other view's scanner faces but did not measure."),
        field("slide", &T::slide, "Near 0 if the views can slide on each other."),
        field("score", &T::score, "Larger is better.")};
}

struct PosesDocument {
    LengthUnit unit = LengthUnit::unknown;
    std::string frame;
    std::vector<PoseDocument> poses;
    std::vector<EdgeDocument> edges{};
};
constexpr auto fields(const PosesDocument*) {
    using T = PosesDocument;
    return std::tuple{field("unit", &T::unit).nullable().optional(),
                      field("frame", &T::frame, "The coordinate system that all poses lead to.").nullable().optional(),
                      field("poses", &T::poses),
                      field("edges", &T::edges, "The pairs of views from which the poses were found.").optional()};
}

std::optional<double> checked_rms(const std::optional<double>& rms, std::string_view place) {
    if (rms && !(*rms >= 0))
        throw Error("{}: 'rms' is {}; expected a length of at least 0", place, *rms)
            .hint("leave it out if the motion was not found by a fit");
    return rms;
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

void require_refusal(const PoseDocument& pose, const std::string& place) {
    for (const auto& [name, is_given] :
         {std::pair("rotation", pose.rotation.has_value()), std::pair("translation", pose.translation.has_value()),
          std::pair("matrix", pose.matrix.has_value()), std::pair("rms", pose.rms.has_value())})
        if (is_given) throw Error("{}: has 'refused' and '{}'; a refused scan has no motion", place, name);
    if (pose.scan.empty()) throw Error("{}: is refused, but does not name its scan", place);
    if (pose.refused->empty()) throw Error("{}: 'refused' is empty; expected the reason", place);
}

std::vector<ScanPose> poses_of(const PosesDocument& document, const OnWarning& warn) {
    if (document.poses.empty()) throw Error("contains no pose; expected \"poses\" to be a list of poses");
    std::vector<ScanPose> poses;
    for (const PoseDocument& each : document.poses) {
        const std::string place = fmt::format("pose {}", poses.size() + 1);
        ScanPose pose{each.scan, {}, each.refused};
        if (each.refused) {
            require_refusal(each, place);
        } else {
            pose.transform = motion_at(each, place, warn);
            pose.transform.rms = checked_rms(each.rms, place);
        }
        pose.transform.unit = document.unit;
        pose.transform.to = document.frame;
        poses.push_back(std::move(pose));
    }
    return poses;
}

std::vector<PoseEdge> edges_of(const PosesDocument& document) {
    std::vector<PoseEdge> edges;
    for (const EdgeDocument& each : document.edges) {
        const std::string place = fmt::format("edge {}", edges.size() + 1);
        RigidTransform pose = motion_of(std::span<const double, 16>(each.matrix.front().data(), 16), place);
        pose.unit = document.unit;
        pose.from = each.views[0];
        pose.to = each.views[1];
        pose.rms = checked_rms(each.rms, place);
        edges.push_back({std::move(pose), each.overlap, each.front, each.missing, each.slide, each.score});
    }
    return edges;
}

Matrix matrix_of(const RigidTransform& motion) {
    Matrix matrix{};
    for (std::size_t row = 0; row < 3; ++row) {
        const auto at = static_cast<Eigen::Index>(row);
        const auto r = motion.rotation.row(at);
        matrix[row] = {r[0], r[1], r[2], motion.translation[at]};
    }
    return matrix;
}

/// Throws Error unless the motions lead to one frame, in one unit.
void require_one_frame(const Transforms& transforms) {
    if (transforms.motions.empty()) throw Error("the transform has no motion; at least one is needed");
    const RigidTransform& first = transforms.motions.front();
    for (const RigidTransform& motion : transforms.motions)
        if (motion.to != first.to)
            throw Error("the motions lead to different frames: '{}' and '{}'", first.to, motion.to);
    const auto require_unit = [&](const RigidTransform& motion) {
        if (motion.unit != first.unit)
            throw Error("the motions have different units: '{}' and '{}'", symbol(first.unit), symbol(motion.unit));
    };
    for (const RigidTransform& motion : transforms.motions) require_unit(motion);
    for (const PoseEdge& edge : transforms.edges) require_unit(edge.pose);
}

}  // namespace

std::vector<ScanPose> poses_from_json(const Json& json, const OnWarning& warn) {
    const auto document = from_document<PosesDocument>(json);
    std::vector<ScanPose> poses = poses_of(document, warn);
    edges_of(document);
    return poses;
}

template <>
struct KindTraits<Transforms> : NotGeometric<Transforms>, NoProperties<Transforms> {
    static constexpr std::string_view name = "transform";
    static constexpr std::string_view json_member = "poses";
    static void require_usable(const Transforms& transforms) {
        require_one_frame(transforms);
        for (const RefusedFrame& each : transforms.refused)
            if (each.from.empty() || each.reason.empty())
                throw Error("a refused frame has no {}", each.from.empty() ? "name" : "reason");
    }
    static void to_json(const Transforms& transforms, Json& json) {
        require_one_frame(transforms);
        PosesDocument document{transforms.motions.front().unit, transforms.motions.front().to, {}};
        for (const RigidTransform& motion : transforms.motions)
            document.poses.push_back({motion.from, {}, {}, matrix_of(motion), motion.rms, {}});
        for (const RefusedFrame& each : transforms.refused)
            document.poses.push_back({each.from, {}, {}, {}, {}, each.reason});
        for (const PoseEdge& edge : transforms.edges)
            document.edges.push_back({{edge.pose.from, edge.pose.to},
                                      matrix_of(edge.pose),
                                      edge.pose.rms,
                                      edge.overlap,
                                      edge.front,
                                      edge.missing,
                                      edge.slide,
                                      edge.score});
        json = document_of(document);
        const Json last_row{0, 0, 0, 1};  // whole numbers
        for (Json& pose : json["poses"])
            if (pose.contains("matrix")) pose["matrix"][3] = last_row;
        if (json.contains("edges"))
            for (Json& edge : json["edges"]) edge["matrix"][3] = last_row;
    }
    static Transforms from_json(const Json& json, const OnWarning& warn) {
        const auto document = from_document<PosesDocument>(json);
        Transforms transforms;
        for (ScanPose& pose : poses_of(document, warn)) {
            if (pose.refused) {
                transforms.refused.push_back({std::move(pose.scan), std::move(*pose.refused)});
                continue;
            }
            pose.transform.from = std::move(pose.scan);
            transforms.motions.push_back(std::move(pose.transform));
        }
        transforms.edges = edges_of(document);
        if (transforms.motions.empty())
            throw Error(
                "contains no motion: {}",
                transforms.refused.size() == 1
                    ? fmt::format("'{}' is refused: {}", transforms.refused[0].from, transforms.refused[0].reason)
                    : fmt::format("all {} scans are refused", transforms.refused.size()));
        return transforms;
    }
    static Json schema() {
        Json schema = schema::document(name, JsonForm<PosesDocument>::schema());
        schema["properties"]["poses"].update({{"minItems", 1}});
        return schema;
    }
};

template Kind kind_of<Transforms>();

}  // namespace scanmill
