// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The frame of a geometric value: the unit of its numbers, the origin that they are relative to, and the name of the
/// coordinate system.
///
/// The world position of a position p is frame.origin + p. Readers choose an origin for which the subtraction is exact
/// (distant_origin() in bounds.hpp). The engine moves the inputs of a step to one origin. Writers add the origin back.
/// Coordinates of 10^6 m thereby keep their micrometres.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "scanmill/record/fields.hpp"

namespace scanmill {

using Vec3 = Eigen::Vector3d;

enum class LengthUnit { unknown, micrometre, millimetre, centimetre, metre, inch, foot };

/// "mm", "um", "cm", "m", "in", "ft"; "u" for unknown: the scan's own, undeclared unit.
std::string_view symbol(LengthUnit unit);
std::optional<LengthUnit> length_unit(std::string_view symbol);
/// Every symbol a user may declare, for messages: "um, mm, cm, m, in, ft".
std::string_view length_unit_symbols();
/// The same length in another unit; correctly rounded between metric units. Pre: neither unit is unknown.
double in_unit(double length, LengthUnit from, LengthUnit to);

struct Frame {
    LengthUnit unit = LengthUnit::unknown;
    Vec3 origin = Vec3::Zero();
    std::string name;

    bool operator==(const Frame&) const = default;
};
/// The origin is not among the fields, because JSON contains world coordinates.
constexpr auto fields(const Frame*) {
    return std::tuple{field("unit", &Frame::unit).nullable(),
                      field("frame", &Frame::name, "The name of the coordinate system; null if none.").nullable()};
}

/// Throws Error if the units differ, or if both frames have names and the names differ. Origins may differ. `one` and
/// `other` name the values in the message, `one` with its verb: "the plan is", "the mesh".
void require_same_frame(const Frame& first, std::string_view one, const Frame& second, std::string_view other);

}  // namespace scanmill
