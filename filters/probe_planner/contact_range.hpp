// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// In which directions a ball meets an edge before a face: geometry in the plane perpendicular to the edge.
///
/// The edge is at Q = 0. The y axis is the bisector n0 of the normals n1 and n2, the x axis is e x n0 for the tangent
/// e, so the left face runs along (-sin(alpha/2), -cos(alpha/2)) and n1 = (-cos(alpha/2), sin(alpha/2)); alpha is the
/// angle of the material. A ball of radius r moves along a line through T, its centre at T + s u for falling s with
/// u = (-sin phi, cos phi). T is a reference position near Q: the edge as a scan has it.
///
/// With d = T.x cos phi + T.y sin phi, how far the line passes Q, and beta = asin(d / r), the angle between the
/// approach and the normal of the contact, the ball meets the edge first if and only if |phi - beta| <= pi/2 - alpha/2.
/// For the left face alone this is d + r cos(phi + alpha/2) >= 0.
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
/// The angle in [0, pi]. Pre: |cosine| <= 1.
double arc_cosine(double cosine);

/// Radians. NaN where no direction is admissible.
struct AngleRange {
    double min = std::numeric_limits<double>::quiet_NaN();
    double max = std::numeric_limits<double>::quiet_NaN();
};
bool is_empty(const AngleRange& range);

/// The directions that meet the edge first for every T with |T| <= error: |phi| <= acos(error / radius) - alpha/2.
/// Empty if there is none. Pre: 0 <= error <= radius, 0 < alpha < pi.
AngleRange range_of_disc(double alpha, double radius, double error);

/// The same for one position T: the directions between those to the centres r n1 and r n2. Pre: |T| < radius.
AngleRange range_of_position(double alpha, double radius, const Vec2& position);

/// The same for every T on the left face at a distance of at most `error` from the edge, or beyond the edge in the
/// plane of that face by at most `beyond`. Pre: 0 <= error, beyond < radius.
AngleRange range_on_left_face(double alpha, double radius, double error, double beyond);

/// T on the left face at the distance s from the edge, negative beyond it.
Vec2 on_left_face(double alpha, double s);

/// Decides for many T at one phi whether the edge is met first: compares d with two limits. The border counts as met.
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
