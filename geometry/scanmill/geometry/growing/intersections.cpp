// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/intersections.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/geometry/distance/triangles_intersect.hpp"

namespace scanmill::growing {

namespace {

double squared_radius_of(const Surface& surface, const Triangle& triangle) {
    const auto& p = surface.positions;
    const Vec3 u = p[triangle[1]] - p[triangle[0]], w = p[triangle[2]] - p[triangle[0]];
    return squared_enclosing_radius(u.squaredNorm(), w.squaredNorm(), (w - u).squaredNorm(), u.cross(w).norm());
}

/// The largest squared radius of the triangles that are not large.
double squared_radius_of_most(const Surface& surface) {
    std::vector<double> radii;
    radii.reserve(surface.triangles.size());
    for (const Triangle& triangle : surface.triangles) radii.push_back(squared_radius_of(surface, triangle));
    const std::size_t large = std::max<std::size_t>(64, radii.size() / 1024);
    if (large >= radii.size()) return 0;
    const auto nth = radii.end() - static_cast<std::ptrdiff_t>(large) - 1;
    std::ranges::nth_element(radii, nth);
    return *nth;
}

}  // namespace

NearTriangles::Box NearTriangles::box_of(const Surface& surface, std::span<const u32> corners) {
    Box box{surface.positions[corners[0]], surface.positions[corners[0]]};
    for (u32 corner : corners.subspan(1)) {
        box.low = box.low.cwiseMin(surface.positions[corner]);
        box.high = box.high.cwiseMax(surface.positions[corner]);
    }
    return box;
}

void NearTriangles::gather_around(const Surface& surface, std::span<const u32> corners) {
    update_large(surface);
    const Vec3& centre = surface.positions[corners[0]];
    double size = 0;
    for (u32 corner : corners) size = std::max(size, (surface.positions[corner] - centre).norm());
    // The triangulation lies in the ball of radius `size`. A triangle that intersects this ball has a corner within its
    // own enclosing radius from the ball.
    const double reach = (size + std::sqrt(others_squared_radius_)) * (1 + 1e-9);
    points_.assign(1, corners[0]);
    surface.neighbourhoods.within(corners[0], reach * reach, buffer_, points_);
    const Box region = box_of(surface, corners);
    clear(surface);
    for (u32 point : points_) gather_at(surface, point, region);
    for (const Triangle& triangle : large_) {
        if (surface.fans.left_of(triangle[0], triangle[1]) != triangle[2]) continue;
        const Box box = box_of(surface, triangle);
        if (region.overlaps(box)) triangles_.push_back({triangle, box});
    }
}

void NearTriangles::gather_near(const Surface& surface, const Triangle& triangle, std::span<const u32> near) {
    const Box region = box_of(surface, triangle);
    clear(surface);
    for (u32 corner : triangle) gather_at(surface, corner, region);
    for (u32 corner : triangle)
        for (u32 other : surface.neighbourhoods.of(corner)) gather_at(surface, other, region);
    for (u32 point : near) gather_at(surface, point, region);
}

void NearTriangles::clear(const Surface& surface) {
    triangles_.clear();
    if (visited_.empty()) visited_.resize(surface.positions.size(), 0);
    if (++gathering_ != 0) return;
    std::ranges::fill(visited_, 0);
    gathering_ = 1;
}

void NearTriangles::gather_at(const Surface& surface, u32 point, const Box& region) {
    if (is_visited(point)) return;
    visited_[point] = gathering_;
    surface.fans.any(point, [&](const Fans::LinkEdge& edge) {
        if (is_visited(edge.first) || is_visited(edge.last)) return false;
        const Triangle triangle{point, edge.first, edge.last};
        const Box box = box_of(surface, triangle);
        if (region.overlaps(box)) triangles_.push_back({triangle, box});
        return false;
    });
}

bool NearTriangles::intersect(const Surface& surface, const Triangle& triangle) const {
    const Box box = box_of(surface, triangle);
    const auto is_same = [&](const Triangle& other) {
        return std::ranges::all_of(triangle, [&](u32 corner) { return std::ranges::count(other, corner) > 0; });
    };
    return std::ranges::any_of(triangles_, [&](const Boxed& other) {
        return box.overlaps(other.box) && !is_same(other.corners) &&
               triangles_intersect(surface.positions, triangle, other.corners);
    });
}

void NearTriangles::update_large(const Surface& surface) {
    if (seen_ == 0) others_squared_radius_ = squared_radius_of_most(surface);
    for (; seen_ < surface.triangles.size(); ++seen_)
        if (squared_radius_of(surface, surface.triangles[seen_]) > others_squared_radius_)
            large_.push_back(surface.triangles[seen_]);
}

}  // namespace scanmill::growing
