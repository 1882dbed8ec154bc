// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The rectangle around points in a plane, by lines through the points at its border. plate_corners.hpp states the
/// rules.

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
    /// Found mean lengths of the sides from the first to the second corner, and from the second to the third.
    double first_side = 0, second_side = 0;
};

/// The points without small groups, which are not on the plate: points whose cells of edge `cell` touch are one group.
std::vector<Vec2> without_strays(std::span<const Vec2> points, double cell);

/// Diagonal of the box of the points. Pre: at least one.
double extent_of(std::span<const Vec2> points);

/// `given`: the lengths of the sides, in any order. Throws Error as plate_corners() does. Pre: at least four points.
Rectangle rectangle_of(std::span<const Vec2> points, double spacing, double tolerance,
                       const std::optional<std::array<double, 2>>& given, const Random& random);

}  // namespace scanmill::plate
