// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the rectangle around points in a plane, from lines through the points at its border. plate_corners.hpp
/// describes the method.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "scanmill/base/random.hpp"

namespace scanmill::plate {

using Vec2 = Eigen::Vector2d;

struct Rectangle {
    std::array<Vec2, 4> corners;  ///< counter-clockwise
    double residual = 0;  ///< root mean square distance of the border points from the sides
    /// Measured side lengths from the first to the second corner, and from the second to the third. Each is the mean of
    /// two opposite sides.
    double first_side = 0, second_side = 0;
};

/// Returns the points without small groups, which are not part of the plate. Points whose grid cells of edge `cell`
/// touch are in one group.
std::vector<Vec2> without_strays(std::span<const Vec2> points, double cell);

/// Diagonal of the bounding box of the points. Pre: at least one point.
double extent_of(std::span<const Vec2> points);

/// Finds the rectangle by steps 3 to 6 of plate_corners(), and throws Error as it does. `given`: the known side
/// lengths, in any order. Pre: at least four points.
Rectangle rectangle_of(std::span<const Vec2> points, double spacing, double tolerance,
                       const std::optional<std::array<double, 2>>& given, const Random& random);

}  // namespace scanmill::plate
