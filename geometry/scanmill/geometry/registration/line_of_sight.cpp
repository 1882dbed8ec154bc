// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/line_of_sight.hpp"

namespace scanmill {

namespace {

/// As shares of the reach.
constexpr double ray_distance = 0.5, height_distance = 0.75, cell_edge = 0.5;

double squared_across(const ProjectedGrid::Ray& a, const ProjectedGrid::Ray& b) {
    const double x = a.x - b.x, y = a.y - b.y;
    return x * x + y * y;
}

}  // namespace

SightLines::SightLines(std::span<const Vec3> points, const Vec3& to_scanner, double reach)
    : grid_(points, to_scanner, cell_edge * reach),
      reach_(reach) {}

SightLines::Place SightLines::place_of(const Vec3& position) const {
    const ProjectedGrid::Ray at = grid_.ray_of(position);
    const double ray = ray_distance * reach_, height = height_distance * reach_;
    bool has_ray = false;
    const bool is_behind = grid_.any_within(at, height, [&](const ProjectedGrid::Ray& other) {
        const double squared = squared_across(at, other);
        has_ray |= squared <= ray * ray;
        return squared <= height * height && at.height - other.height <= reach_;
    });
    if (is_behind) return Place::behind;
    return has_ray ? Place::in_front : Place::unknown;
}

bool SightLines::is_empty_at(const Vec3& position) const {
    const ProjectedGrid::Ray at = grid_.ray_of(position);
    return !grid_.any_within(
        at, reach_, [&](const ProjectedGrid::Ray& other) { return squared_across(at, other) <= reach_ * reach_; });
}

}  // namespace scanmill
