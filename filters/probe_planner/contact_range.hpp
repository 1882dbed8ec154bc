// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Computes from which directions a ball meets an edge before a face, in the plane perpendicular to the edge.
///
/// The edge is at Q = 0. The y axis is the bisector n0 of the normals n1 and n2. The x axis is e x n0 for the tangent
/// e. So the left face runs along (-sin(alpha/2), -cos(alpha/2)), and n1 = (-cos(alpha/2), sin(alpha/2)), where alpha
/// is the angle of the material. A ball of radius r moves along a line through T: its centre is at T + s u for falling
/// s, with u = (-sin phi, cos phi). T is a reference position near Q, the edge as a scan has it.
///
/// Let d = T.x cos phi + T.y sin phi be the distance at which the line passes Q. Let beta = asin(d / r) be the angle
/// between the approach and the normal of the contact. The ball meets the edge first if and only if |phi - beta| <=
/// pi/2 - alpha/2. For the left face alone, the condition is d + r cos(phi + alpha/2) >= 0.
///
/// Source: Wang 2006, section 5.2, equations 5.4 to 5.13, in closed form and for both faces. Angles in radians; no
/// result depends on the processor.

#include <Eigen/Core>
#include <limits>

#include "scanmill/base/elementary.hpp"

namespace scanmill::probing {

using Vec2 = Eigen::Vector2d;

using elementary::Turn;
using elementary::turn_of;
/// Returns the arc cosine, in [0, pi]. Pre: |cosine| <= 1.
double arc_cosine(double cosine);

/// Range of phi in radians. Both ends are NaN if no direction is admissible.
struct AngleRange {
    double min = std::numeric_limits<double>::quiet_NaN();
    double max = std::numeric_limits<double>::quiet_NaN();
};
bool is_empty(const AngleRange& range);

/// Returns the directions phi for which the ball meets the edge first for every T with |T| <= error: |phi| <=
/// acos(error / radius) - alpha/2. Empty if there is none. Pre: 0 <= error <= radius, 0 < alpha < pi.
AngleRange range_of_disc(double alpha, double radius, double error);

/// Returns the directions for which the ball meets the edge first for one position T: those between the directions from
/// T to the centres r n1 and r n2. Pre: |T| < radius.
AngleRange range_of_position(double alpha, double radius, const Vec2& position);

/// Returns the directions for which the ball meets the edge first for every T on a segment in the plane of the left
/// face. The segment reaches from the distance `error` on the face to the distance `beyond` beyond the edge. Pre: 0 <=
/// error, beyond < radius.
AngleRange range_on_left_face(double alpha, double radius, double error, double beyond);

/// Returns the position T on the left face at the distance s from the edge; a negative s is beyond the edge.
Vec2 on_left_face(double alpha, double s);

/// Decides for many T at one phi whether the ball meets the edge first: whether d is within two limits, inclusive.
class EdgeFirst {
public:
    EdgeFirst(double alpha, double radius, double phi);
    bool operator()(const Vec2& position) const {
        const double d = position.x() * cosine_ + position.y() * sine_;
        return d >= low_ && d <= high_;
    }

private:
    double cosine_, sine_, low_, high_;
};

}  // namespace scanmill::probing
