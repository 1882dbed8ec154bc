// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/placed.hpp"

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

template <class Number>
Column turned_to(const Column& normals, const Eigen::Matrix3d& rotation) {
    Array<Number> values(3 * normals.rows());
    for (std::size_t row = 0; row < normals.rows(); ++row) {
        const Vec3 normal = rotation * Vec3(normals.number(row, 0), normals.number(row, 1), normals.number(row, 2));
        for (std::size_t axis = 0; axis < 3; ++axis)
            values[3 * row + axis] = static_cast<Number>(normal[static_cast<Eigen::Index>(axis)]);
    }
    return {normals.name(), 3, Buffer<Number>(std::move(values))};
}

ColumnTable turned(const ColumnTable& columns, const Eigen::Matrix3d& rotation) {
    ColumnTable result;
    for (const Column& column : columns) result.add(turned(column, rotation));
    return result;
}

void turn_columns(PointCloud& cloud, const Eigen::Matrix3d& rotation) {
    cloud.columns = turned(cloud.columns, rotation);
}

void turn_columns(TriangleMesh& mesh, const Eigen::Matrix3d& rotation) {
    for (ColumnTable* columns : {&mesh.vertex_columns, &mesh.face_columns, &mesh.edge_columns})
        *columns = turned(*columns, rotation);
}

Frame placed(Frame frame, const RigidTransform& pose) {
    const Vec3 translation = translation_in(frame.unit, pose);
    if (!pose.rotation.isIdentity(0)) frame.origin = pose.rotation * frame.origin;
    frame.origin += translation;
    if (!frame.origin.allFinite())
        throw Error("the pose moves the scan's origin to ({}, {}, {}), which no coordinate can hold", frame.origin.x(),
                    frame.origin.y(), frame.origin.z());
    if (!pose.to.empty()) frame.name = pose.to;
    return frame;
}

template <class T>
Value placed(const T& value, const RigidTransform& pose) {
    T moved = value;
    moved.frame = placed(value.frame, pose);
    if (!pose.rotation.isIdentity(0)) {  // multiplied with it, a -0 would become 0
        Array<Vec3> positions(value.positions.size());
        for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = pose.rotation * value.positions[i];
        moved.positions = std::move(positions);
        turn_columns(moved, pose.rotation);
    }
    return std::make_shared<const T>(std::move(moved));
}

}  // namespace

Value placed(const Value& value, const RigidTransform& pose) {
    if (const auto* cloud = std::get_if<std::shared_ptr<const PointCloud>>(&value)) return placed(**cloud, pose);
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value)) return placed(**mesh, pose);
    throw Error("a pose moves points and meshes; this is {}", name_of(kind_of(value)));
}

Vec3 translation_in(LengthUnit unit, const RigidTransform& pose) {
    if (pose.unit == LengthUnit::unknown || pose.unit == unit) return pose.translation;
    if (unit == LengthUnit::unknown)
        throw Error("the pose is in {}; the unit of the scan is not declared", symbol(pose.unit))
            .hint("declare it: --unit mm, or `unit: mm` at the workflow's input or at the scan in a batch");
    Vec3 translation;
    for (int axis = 0; axis < 3; ++axis) translation[axis] = in_unit(pose.translation[axis], pose.unit, unit);
    return translation;
}

Column turned(const Column& column, const Eigen::Matrix3d& rotation) {
    if (column.name() != "normal" || column.components() != 3) return column;
    return column.type() == ScalarType::float32 ? turned_to<float>(column, rotation)
                                                : turned_to<double>(column, rotation);
}

}  // namespace scanmill
