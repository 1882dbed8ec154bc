// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A shared, immutable object of one of the kinds. Values flow between the steps of a workflow.

#include <cassert>
#include <memory>
#include <utility>

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/patches.hpp"
#include "scanmill/data/picture.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/probes.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

class Value {
public:
    /// A value without an object.
    Value() = default;
    template <class T>
    Value(std::shared_ptr<T> object) : kind_(kind_of<std::remove_const_t<T>>()),
                                       object_(std::move(object)) {}
    Value(Kind kind, std::shared_ptr<const void> object) : kind_(kind), object_(std::move(object)) {}

    Kind kind() const { return kind_; }
    /// Pre: the value is of this kind.
    template <class T>
    std::shared_ptr<const T> get() const {
        assert(kind_ == kind_of<T>());
        return std::static_pointer_cast<const T>(object_);
    }
    /// Null if the value is of another kind.
    template <class T>
    const T* find() const {
        return kind_ == kind_of<T>() ? static_cast<const T*>(object_.get()) : nullptr;
    }
    const void* object() const { return object_.get(); }
    /// Whether both values share one object.
    bool operator==(const Value& other) const { return object_ == other.object_; }

private:
    Kind kind_;
    std::shared_ptr<const void> object_;
};

inline Kind kind_of(const Value& value) { return value.kind(); }
inline bool is_geometric(Kind kind) { return kind.info().is_geometric; }

/// Copies the value's object (arrays are shared), visits the copy and returns it.
Value visited(const Value& value, FieldVisitor& visitor);

/// The frame; nullopt for kinds that are not geometric.
std::optional<Frame> frame_of(const Value& value);
/// All positions, relative to the frame's origin; none for kinds that are not geometric.
Buffer<Vec3> positions_of(const Value& value);

/// The same geometry in another frame: positions are shifted to the new origin; unit and name are set, not converted.
/// Values without positions are returned unchanged.
Value reframed(const Value& value, const Frame& frame);

/// The same geometry in another unit. Converts positions, the frame's origin, other lengths, and columns according to
/// their length exponent. Pre: neither unit is unknown.
Value in_unit(const Value& value, LengthUnit unit);

std::vector<PropertySpec> property_specs(Kind kind);
/// The properties, in the order of property_specs(). Undefined properties (genus of a non-manifold mesh) are left out.
Metrics properties_of(const Value& value);

/// The value with its world positions moved by the pose. Positions are only rotated and frame.origin is translated, so
/// coordinates of 10^6 m keep their micrometres. Directions and columns of directions (see turned()) are rotated, too;
/// columns of integers become float64. The frame gets the name `pose.to` unless that is empty. Its unit stays; the
/// translation is converted to this unit. The identity changes no bit of a position.
///
/// Throws Error if the pose has a unit and the value has none, for an origin outside the range of double, and for kinds
/// without positions.
Value placed(const Value& value, const RigidTransform& pose);

/// The translation of the pose in another unit; unchanged if the pose has no unit. Throws Error if the pose has a unit
/// and `unit` is unknown; the hint explains how to declare the unit.
Vec3 translation_in(LengthUnit unit, const RigidTransform& pose);

/// A column of directions rotated: `normal` and `approach` with three numbers per row, `corner-normals` with nine.
/// float32 stays float32, other types become float64. Any other column is returned unchanged.
Column turned(const Column& column, const Eigen::Matrix3d& rotation);

}  // namespace scanmill
