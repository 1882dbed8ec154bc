// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The frame that travels with every geometric value: in which unit its numbers are, which origin they are relative to,
/// and what the coordinate system is called.
///
/// A position p of a value stands for the world position frame.origin + p. Readers choose the origin so that the
/// subtraction is exact (see distant_origin() in points.hpp), the engine rebases the inputs of a step to one origin,
/// writers add it back: coordinates of 10^6 m keep their micrometres.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

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

}  // namespace scanmill
