// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Values moved by a pose: from where a scanner measured them to where they belong.

#include "scanmill/data/transform.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// The points or the mesh with its world positions moved by the pose. Positions are only rotated; frame.origin takes
/// the motion, so that what is large never meets what is small: coordinates of 10^6 m keep their micrometres. Columns
/// `normal` of three numbers are turned along, those of integers as float64. The frame is called `pose.to` unless that
/// is empty; its unit stays, the translation is converted to it. The identity changes no bit of a position. Throws
/// Error for a pose in a known unit when that of the value is not, for an origin that leaves what double can hold, and
/// for other kinds.
Value placed(const Value& value, const RigidTransform& pose);

/// The translation in another unit; as it is when the pose has none. Throws Error when the pose has a unit and `unit`
/// is unknown, saying how to declare it.
Vec3 translation_in(LengthUnit unit, const RigidTransform& pose);

/// A column of directions (`normal`, three numbers per row) turned: float32 stays float32, everything else becomes
/// float64. Any other column comes back as it is.
Column turned(const Column& column, const Eigen::Matrix3d& rotation);

}  // namespace scanmill
