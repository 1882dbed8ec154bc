// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A shared, immutable object of one of the kinds: what flows between steps.

#include <cassert>
#include <memory>
#include <utility>

#include "scanmill/kinds/all_kinds.hpp"

namespace scanmill {

struct RigidTransform;

class Value {
public:
    /// Holds no object.
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
    /// Null when the value is of another kind.
    template <class T>
    const T* find() const {
        return kind_ == kind_of<T>() ? static_cast<const T*>(object_.get()) : nullptr;
    }
    const void* object() const { return object_.get(); }
    /// Whether both hold the same object.
    bool operator==(const Value& other) const { return object_ == other.object_; }

private:
    Kind kind_;
    std::shared_ptr<const void> object_;
};

inline Kind kind_of(const Value& value) { return value.kind(); }
inline bool is_geometric(Kind kind) { return kind.info().is_geometric; }

/// Hands a copy of the value's object, which shares its arrays, to the visitor, and returns that copy.
Value visited(const Value& value, FieldVisitor& visitor);

/// The frame; nothing for kinds that are not geometric.
std::optional<Frame> frame_of(const Value& value);
/// All positions, relative to the frame's origin; none for kinds that are not geometric.
Buffer<Vec3> positions_of(const Value& value);

/// The same geometry in another frame: `frame.origin` moves and positions move against it; unit and name are set, not
/// converted. Values without positions come back as they are.
Value reframed(const Value& value, const Frame& frame);

/// The same geometry in another unit: positions, the frame's origin, other lengths, and columns by their length
/// exponent. Throws Error when a finite coordinate would become infinite. Pre: neither unit is unknown.
Value in_unit(const Value& value, LengthUnit unit);

std::vector<PropertySpec> property_specs(Kind kind);
/// In the order of property_specs(); one that is not defined (the genus of a mesh that is not a manifold) is left out.
Metrics properties_of(const Value& value);

/// The value with its world positions moved by the pose. Positions are only rotated; frame.origin takes the motion, so
/// large numbers never meet small ones: coordinates of 10^6 m keep their micrometres. Directions and columns `normal`
/// of three numbers turn too; integers among them become float64. The frame is called `pose.to` unless that is empty;
/// its unit stays, the translation is converted to it. The identity changes no bit of a position. Throws Error for a
/// pose in a known unit when that of the value is not, for an origin that double cannot hold, and for kinds without
/// positions.
Value placed(const Value& value, const RigidTransform& pose);

/// The translation in another unit; unchanged when the pose has none. Throws Error when the pose has a unit and `unit`
/// is unknown, saying how to declare it.
Vec3 translation_in(LengthUnit unit, const RigidTransform& pose);

/// A column of directions (`normal`, three numbers per row) turned: float32 stays float32, everything else becomes
/// float64. Any other column comes back unchanged.
Column turned(const Column& column, const Eigen::Matrix3d& rotation);

}  // namespace scanmill
