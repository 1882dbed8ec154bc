// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/value.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/kind_traits.hpp"

namespace scanmill {

namespace {

class Reframe : public FieldVisitor {
public:
    explicit Reframe(const Frame& frame) : frame_(frame) {}
    void frame(const char*, Frame& frame) override {
        shift_ = frame.origin - frame_.origin;
        frame = frame_;
    }
    void positions(const char*, Buffer<Vec3>& positions) override {
        if (shift_ != Vec3::Zero()) positions = translated(positions, shift_);
    }

private:
    const Frame& frame_;
    Vec3 shift_ = Vec3::Zero();
};

Buffer<Vec3> mapped(const Buffer<Vec3>& vectors, auto&& map) {
    Array<Vec3> result(vectors.size());
    std::ranges::transform(vectors, result.begin(), map);
    return result;
}

class ConvertUnit : public FieldVisitor {
public:
    explicit ConvertUnit(LengthUnit to) : to_(to) {}
    void frame(const char*, Frame& frame) override {
        from_ = frame.unit;
        frame.origin = converted(frame.origin);
        frame.unit = to_;
    }
    void positions(const char*, Buffer<Vec3>& positions) override {
        positions = mapped(positions, [&](const Vec3& p) { return converted(p); });
    }
    void lengths(const char*, Buffer<double>& lengths, int exponent) override {
        Array<double> scaled(lengths.begin(), lengths.end());
        const double factor = scanmill::in_unit(1, from_, to_);
        for (double& length : scaled)
            for (int power = 0; power < exponent; ++power) length *= factor;
        lengths = std::move(scaled);
    }
    void columns(const char*, ColumnTable& columns) override {
        columns = columns.scaled(scanmill::in_unit(1, from_, to_));
    }

private:
    Vec3 converted(const Vec3& p) const {
        return p.unaryExpr([&](double length) { return scanmill::in_unit(length, from_, to_); });
    }
    LengthUnit from_ = LengthUnit::unknown, to_;
};

/// Without a rotation only the frame changes, because multiplication by the identity would change -0 to 0.
class Move : public FieldVisitor {
public:
    explicit Move(const RigidTransform& pose) : pose_(pose), turns_(!pose.rotation.isIdentity(0)) {}
    void frame(const char*, Frame& frame) override {
        const Vec3 translation = translation_in(frame.unit, pose_);
        if (turns_) frame.origin = pose_.rotation * frame.origin;
        frame.origin += translation;
        if (!frame.origin.allFinite())
            throw Error("the pose moves the scan's origin to ({}, {}, {}), which is outside the range of a coordinate",
                        frame.origin.x(), frame.origin.y(), frame.origin.z());
        if (!pose_.to.empty()) frame.name = pose_.to;
    }
    void positions(const char*, Buffer<Vec3>& positions) override {
        if (turns_) positions = mapped(positions, [&](const Vec3& p) { return Vec3(pose_.rotation * p); });
    }
    void directions(const char* name, Buffer<Vec3>& directions) override { positions(name, directions); }
    void columns(const char*, ColumnTable& columns) override {
        if (!turns_) return;
        ColumnTable all;
        for (const Column& column : columns) all.add(turned(column, pose_.rotation));
        columns = std::move(all);
    }

private:
    const RigidTransform& pose_;
    bool turns_;
};

struct ReadGeometry : FieldVisitor {
    void frame(const char*, Frame& frame) override { found_frame = frame; }
    void positions(const char*, Buffer<Vec3>& positions) override {
        if (!found_positions.empty()) {
            Array<Vec3> all(found_positions.begin(), found_positions.end());
            all.insert(all.end(), positions.begin(), positions.end());
            found_positions = std::move(all);
        } else {
            found_positions = positions;
        }
    }
    std::optional<Frame> found_frame;
    Buffer<Vec3> found_positions;
};

ReadGeometry geometry_of(const Value& value) {
    ReadGeometry read;
    visited(value, read);
    return read;
}

/// The numbers per row of a column of directions with this name; 0 for other columns.
u32 numbers_of_directions(std::string_view column) {
    if (column == "normal" || column == "approach") return 3;
    return column == "corner-normals" ? 9 : 0;
}

template <class Number>
Column turned_to(const Column& directions, const Eigen::Matrix3d& rotation) {
    Array<Number> values;
    values.reserve(directions.rows() * directions.components());
    for (std::size_t row = 0; row < directions.rows(); ++row)
        for (u32 first = 0; first < directions.components(); first += 3) {
            const Vec3 direction(directions.number(row, first), directions.number(row, first + 1),
                                 directions.number(row, first + 2));
            for (const double number : Vec3(rotation * direction)) values.push_back(static_cast<Number>(number));
        }
    return {directions.name(), directions.components(), Buffer<Number>(std::move(values))};
}

}  // namespace

Value visited(const Value& value, FieldVisitor& visitor) {
    const std::shared_ptr<void> copy = value.kind().info().copy(value.object());
    value.kind().info().visit(visitor, copy.get());
    return Value(value.kind(), copy);
}

std::optional<Frame> frame_of(const Value& value) { return geometry_of(value).found_frame; }

Buffer<Vec3> positions_of(const Value& value) { return geometry_of(value).found_positions; }

Value reframed(const Value& value, const Frame& frame) {
    const std::optional<Frame> before = frame_of(value);
    if (!before || *before == frame) return value;
    Reframe change(frame);
    return visited(value, change);
}

Value in_unit(const Value& value, LengthUnit unit) {
    ConvertUnit change(unit);
    return visited(value, change);
}

std::vector<PropertySpec> property_specs(Kind kind) { return kind.info().property_specs(); }

Metrics properties_of(const Value& value) { return value.kind().info().properties(value.object()); }

Value placed(const Value& value, const RigidTransform& pose) {
    if (!is_geometric(value.kind()))
        throw Error("a pose moves values with positions; this is {}", name_of(value.kind()));
    Move change(pose);
    return visited(value, change);
}

Vec3 translation_in(LengthUnit unit, const RigidTransform& pose) {
    if (pose.unit == LengthUnit::unknown || pose.unit == unit) return pose.translation;
    if (unit == LengthUnit::unknown)
        throw Error("the pose is in {}; the unit of the scan is not declared", symbol(pose.unit))
            .hint("declare it with `unit: mm` at the workflow's input, or at the scan in a batch")
            .remedy(Remedy::declare_unit);
    Vec3 translation;
    for (int axis = 0; axis < 3; ++axis) translation[axis] = in_unit(pose.translation[axis], pose.unit, unit);
    return translation;
}

Column turned(const Column& column, const Eigen::Matrix3d& rotation) {
    if (column.is_list() || column.components() != numbers_of_directions(column.name())) return column;
    return column.type() == ScalarType::float32 ? turned_to<float>(column, rotation)
                                                : turned_to<double>(column, rotation);
}

}  // namespace scanmill
