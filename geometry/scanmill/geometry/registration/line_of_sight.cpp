// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/line_of_sight.hpp"

#include <algorithm>

namespace scanmill {

namespace {

/// As shares of the reach.
constexpr double ray_distance = 0.5, height_distance = 0.75, cell_edge = 0.5;

double squared_across(const ProjectedGrid::Ray& a, const ProjectedGrid::Ray& b) {
    const double x = a.x - b.x, y = a.y - b.y;
    return x * x + y * y;
}

bool is_left(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& point) {
    const Eigen::Vector2d along = to - from, there = point - from;
    return along.x() * there.y() - along.y() * there.x() > 0;
}

/// Andrew's chains: the lower one from left to right, then the upper one back.
std::vector<Eigen::Vector2d> convex_outline(const ProjectedGrid& grid, std::span<const Vec3> points) {
    if (points.empty()) return {};
    std::vector<Eigen::Vector2d> sorted;
    for (const Vec3& p : points) {
        const ProjectedGrid::Ray ray = grid.ray_of(p);
        sorted.emplace_back(ray.x, ray.y);
    }
    const auto by_x = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    };
    std::ranges::sort(sorted, by_x);
    std::vector<Eigen::Vector2d> outline;
    for (int chain = 0; chain < 2; ++chain) {
        const std::size_t first = outline.size();
        for (const Eigen::Vector2d& p : sorted) {
            while (outline.size() >= first + 2 && !is_left(outline[outline.size() - 2], outline.back(), p))
                outline.pop_back();
            outline.push_back(p);
        }
        outline.pop_back();  // the first corner of the next chain
        std::ranges::reverse(sorted);
    }
    return outline;
}

}  // namespace

SightLines::SightLines(std::span<const Vec3> points, const Vec3& to_scanner, double reach, bool sees_all)
    : grid_(points, to_scanner, cell_edge * reach),
      reach_(reach) {
    if (!sees_all) outline_ = convex_outline(grid_, points);
}

bool SightLines::is_in_outline(const ProjectedGrid::Ray& at) const {
    for (std::size_t i = 0; i < outline_.size(); ++i)
        if (!is_left(outline_[i], outline_[(i + 1) % outline_.size()], {at.x, at.y})) return false;
    return true;
}

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
    if (!is_in_outline(at)) return false;
    return !grid_.any_within(
        at, reach_, [&](const ProjectedGrid::Ray& other) { return squared_across(at, other) <= reach_ * reach_; });
}

}  // namespace scanmill
