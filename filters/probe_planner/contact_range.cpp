// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/contact_range.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill::probing {

namespace {

constexpr double pi = std::numbers::pi;
/// A range whose minimum exceeds its maximum by at most this, by rounding, is a single direction.
constexpr double angle_rounding = 1e-12;

/// The angle of (x, y) in (-pi, pi].
double arc_tangent(double y, double x) { return y < 0 ? -angle_of(x, -y) : angle_of(x, y); }

/// Returns an empty range if low exceeds high.
AngleRange range_between(double low, double high) {
    if (low > high + angle_rounding) return {};
    return {std::min(low, high), std::max(low, high)};
}

}  // namespace

double arc_cosine(double cosine) { return angle_of(cosine, std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)))); }

bool is_empty(const AngleRange& range) { return !(range.min <= range.max); }

AngleRange range_of_disc(double alpha, double radius, double error) {
    const double most = arc_cosine(error / radius) - alpha / 2;
    return range_between(-most, most);
}

AngleRange range_of_position(double alpha, double radius, const Vec2& position) {
    const auto [cosine, sine] = turn_of(alpha / 2);
    const double up = radius * sine - position.y();
    return range_between(arc_tangent(position.x() - radius * cosine, up),
                         arc_tangent(position.x() + radius * cosine, up));
}

AngleRange range_on_left_face(double alpha, double radius, double error, double beyond) {
    // While T moves along a line, the direction from T to a fixed centre turns one way. So the ends of the line decide.
    const AngleRange inner = range_of_position(alpha, radius, on_left_face(alpha, error)),
                     outer = range_of_position(alpha, radius, on_left_face(alpha, -beyond));
    return range_between(std::max(inner.min, outer.min), std::min(inner.max, outer.max));
}

Vec2 on_left_face(double alpha, double s) {
    const auto [cosine, sine] = turn_of(alpha / 2);
    return -s * Vec2(sine, cosine);
}

EdgeFirst::EdgeFirst(double alpha, double radius, double phi) {
    const double half = pi / 2 - alpha / 2;
    const Turn turn = turn_of(phi);
    cosine_ = turn.cosine;
    sine_ = turn.sine;
    // beta is at most a quarter turn: a ball whose line passes Q farther away than the radius does not meet the edge.
    // As |phi| and `half` are at most a quarter turn, only one of phi - half and phi + half can exceed one.
    low_ = phi - half <= -pi / 2 ? -radius : radius * turn_of(phi - half).sine;
    high_ = phi + half >= pi / 2 ? radius : radius * turn_of(phi + half).sine;
}

}  // namespace scanmill::probing
