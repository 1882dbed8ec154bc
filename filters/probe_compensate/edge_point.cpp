// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_compensate/edge_point.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/statistics.hpp"

namespace scanmill::compensating {

namespace {

/// Smallest sine of the angle between contact normals; the error of the point is 1,400 times the machine's there.
constexpr double least_sine = 1e-3;

/// Largest distance of a point, and of an outer neighbour, from the circle through the three others, as a share of half
/// the distance of the inner neighbours. At a corner of 90 degrees one of them is 0.5 or more. On the rim of a hole
/// they are 1.5 and 3.2 times the errors of the points.
constexpr double most_deviation = 0.25;

/// A point moves by less than this share of the radius in the last round.
constexpr double converged = 1e-9;
constexpr int most_rounds = 20;

/// Sagittas below this share of the chord are of a straight line.
constexpr double straight = 1e-9;

/// A circle, or a straight line.
struct Arc {
    bool is_straight;
    Vec3 centre, axis;  ///< axis: unit vector; for a straight line, centre is a point of it and axis its direction
    double radius;
};

Arc arc_through(const Vec3& before, const Vec3& at, const Vec3& after) {
    const Vec3 a = before - at, b = after - at, normal = a.cross(b), chord = after - before;
    const double square = normal.squaredNorm();
    if (!(square > straight * straight * chord.squaredNorm() * chord.squaredNorm()))
        return {true, at, chord.normalized(), 0};
    const Vec3 to_centre = (a.squaredNorm() * b - b.squaredNorm() * a).cross(normal) / (2 * square);
    return {false, at + to_centre, normal / std::sqrt(square), to_centre.norm()};
}

double distance(const Vec3& point, const Arc& arc) {
    const Vec3 offset = point - arc.centre;
    const double along = offset.dot(arc.axis), across = (offset - along * arc.axis).norm();
    if (arc.is_straight) return across;
    const double radial = across - arc.radius;
    return std::sqrt(radial * radial + along * along);
}

/// The pair in the plane across the arc at `point`: turned about its axis, or moved along the straight line.
BallPair across(const BallPair& pair, const Arc& arc, const Vec3& point) {
    if (arc.is_straight) return {pair.first, pair.second, arc.axis, pair.approach};
    const Vec3 outward = (point - arc.centre).normalized();
    const auto turned = [&](const Vec3& centre) {
        const Vec3 offset = centre - arc.centre;
        const double along = offset.dot(arc.axis);
        return Vec3(arc.centre + along * arc.axis + (offset - along * arc.axis).norm() * outward);
    };
    return {turned(pair.first), turned(pair.second), arc.axis.cross(outward), pair.approach};
}

/// The corrected point in the middle of five; empty if it stays as it is.
std::optional<EdgePoint> corrected(const std::array<LinePosition, 5>& five, double radius) {
    for (const LinePosition& position : five)
        if (!position.pair) return {};
    const auto at = [&](std::size_t i) -> const Vec3& { return five[i].point->position; };
    const double most = most_deviation * (at(3) - at(1)).norm() / 2;
    const Arc from_before = arc_through(at(0), at(1), at(3)), from_after = arc_through(at(4), at(3), at(1));
    if (!(most > 0) || !(distance(at(4), from_before) < most) || !(distance(at(0), from_after) < most) ||
        !(distance(at(2), from_before) < most) || !(distance(at(2), from_after) < most))
        return {};
    const Arc arc = arc_through(at(1), at(2), at(3));
    return edge_point(across(*five[2].pair, arc, at(2)), radius);
}

/// Returns the number of steps from a point to its neighbours. They are at least a radius apart, because circles
/// through nearer points follow the noise.
std::size_t stride_of(std::span<const LinePosition> line, double radius) {
    std::vector<double> distances;
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
        distances.push_back((line[i + 1].point->position - line[i].point->position).norm());
    const auto most = static_cast<double>((line.size() - 1) / 4);
    return static_cast<std::size_t>(std::clamp(std::ceil(radius / median(distances)), 1.0, most));
}

}  // namespace

std::optional<EdgePoint> edge_point(const BallPair& pair, double radius) {
    const Vec3 apart = pair.second - pair.first, chord = apart - pair.tangent.dot(apart) * pair.tangent;
    const double length = chord.norm(), square = radius * radius - length * length / 4;
    if (!(square >= 0)) return {};
    const double height = std::sqrt(square), sine = length * height / (radius * radius);
    const Vec3 up = pair.tangent.cross(chord);  // as long as the chord
    const double rise = up.dot(pair.approach);
    if (!(sine >= least_sine) || !(std::abs(rise) >= least_sine * length)) return {};
    const Vec3 down = (rise > 0 ? -height : height) / length * up;
    return EdgePoint{(pair.first + pair.second) / 2 + down, sine, -chord / 2 - down, chord / 2 - down};
}

std::size_t correct_curved(std::span<const LinePosition> line, bool closed, double radius) {
    const std::size_t count = line.size();
    std::vector<std::optional<EdgePoint>> next(count);
    if (count < 5) return 0;
    const std::size_t stride = stride_of(line, radius);
    for (int round = 0; round < most_rounds; ++round) {
        double moved = 0;
        for (std::size_t i = 0; i < count; ++i) {
            next[i].reset();
            if (!closed && (i < 2 * stride || i + 2 * stride >= count)) continue;
            std::array<LinePosition, 5> five;
            for (std::size_t k = 0; k < 5; ++k) five[k] = line[(i + count + k * stride - 2 * stride) % count];
            next[i] = corrected(five, radius);
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (!next[i]) continue;
            moved = std::max(moved, (next[i]->position - line[i].point->position).norm());
            *line[i].point = *next[i];
        }
        if (moved <= converged * radius) break;
    }
    std::size_t corrected_points = 0;
    for (const auto& point : next) corrected_points += point.has_value();
    return corrected_points;
}

}  // namespace scanmill::compensating
