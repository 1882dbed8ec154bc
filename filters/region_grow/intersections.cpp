// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/intersections.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace scanmill::growing {

namespace {

double squared_circle_of(const Surface& surface, const Triangle& triangle) {
    const auto& p = surface.positions;
    const Vec3 u = p[triangle[1]] - p[triangle[0]], w = p[triangle[2]] - p[triangle[0]];
    return squared_circle(u.squaredNorm(), w.squaredNorm(), (w - u).squaredNorm(), u.cross(w).norm());
}

/// All but the largest have at most this.
double circle_of_most(const Surface& surface) {
    std::vector<double> circles;
    circles.reserve(surface.triangles.size());
    for (const Triangle& triangle : surface.triangles) circles.push_back(squared_circle_of(surface, triangle));
    const std::size_t wide = std::max<std::size_t>(64, circles.size() / 1024);
    if (wide >= circles.size()) return 0;
    const auto place = circles.end() - static_cast<std::ptrdiff_t>(wide) - 1;
    std::ranges::nth_element(circles, place);
    return *place;
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Reorders both so that their common corners lead, in the same order; how many there are.
std::size_t bring_common_first(Triangle& one, Triangle& other) {
    std::size_t common = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto same = std::find(other.begin() + static_cast<std::ptrdiff_t>(common), other.end(), one[i]);
        if (same == other.end()) continue;
        std::swap(*same, other[common]);
        std::swap(one[i], one[common]);
        ++common;
    }
    return common;
}

}  // namespace

void WideTriangles::update(const Surface& surface) {
    if (seen_ == 0) bound_ = circle_of_most(surface);
    for (; seen_ < surface.triangles.size(); ++seen_)
        if (squared_circle_of(surface, surface.triangles[seen_]) > bound_) wide_.push_back(surface.triangles[seen_]);
}

bool meet(std::span<const Vec3> positions, const Triangle& one, const Triangle& other) {
    Triangle t = one, u = other;
    const std::size_t common = bring_common_first(t, u);
    const auto point = [&](u32 place) {
        return Kernel::Point_3(positions[place].x(), positions[place].y(), positions[place].z());
    };
    const std::array<Kernel::Point_3, 3> p{point(t[0]), point(t[1]), point(t[2])},
        q{point(u[0]), point(u[1]), point(u[2])};
    if (CGAL::collinear(p[0], p[1], p[2]) || CGAL::collinear(q[0], q[1], q[2])) return false;
    const Kernel::Triangle_3 first(p[0], p[1], p[2]), second(q[0], q[1], q[2]);
    switch (common) {
        case 0: return CGAL::do_intersect(first, second);
        case 1:
            // Whatever else they share reaches the edge opposite the common corner, of one of them.
            return CGAL::do_intersect(first, Kernel::Segment_3(q[1], q[2])) ||
                   CGAL::do_intersect(second, Kernel::Segment_3(p[1], p[2]));
        case 2:
            return CGAL::coplanar(p[0], p[1], p[2], q[2]) &&
                   CGAL::coplanar_orientation(p[0], p[1], p[2], q[2]) == CGAL::POSITIVE;
        default: return true;
    }
}

NearTriangles::Box NearTriangles::box_of(const Surface& surface, std::span<const u32> corners) {
    Box box{surface.positions[corners[0]], surface.positions[corners[0]]};
    for (u32 corner : corners.subspan(1)) {
        box.low = box.low.cwiseMin(surface.positions[corner]);
        box.high = box.high.cwiseMax(surface.positions[corner]);
    }
    return box;
}

void NearTriangles::gather_round(const Surface& surface, std::span<const u32> corners) {
    wide_.update(surface);
    const Vec3& centre = surface.positions[corners[0]];
    double size = 0;
    for (u32 corner : corners) size = std::max(size, (surface.positions[corner] - centre).norm());
    // The filling lies in that ball; of a triangle that meets it a corner is no farther than its circle.
    const double reach = (size + std::sqrt(wide_.squared_circle_of_others())) * (1 + 1e-9);
    places_.assign(1, corners[0]);
    surface.neighbourhoods.within(corners[0], reach * reach, buffer_, places_);
    const Box where = box_of(surface, corners);
    begin(surface);
    for (u32 place : places_) gather_at(surface, place, where);
    wide_.each(surface, [&](const Triangle& triangle) {
        const Box box = box_of(surface, triangle);
        if (where.meets(box)) triangles_.push_back({triangle, box});
    });
}

void NearTriangles::gather_near(const Surface& surface, const Triangle& triangle) {
    const Box where = box_of(surface, triangle);
    begin(surface);
    for (u32 place : triangle) gather_at(surface, place, where);
    for (u32 place : triangle)
        for (u32 other : surface.neighbourhoods.of(place)) gather_at(surface, other, where);
}

void NearTriangles::begin(const Surface& surface) {
    triangles_.clear();
    if (asked_.empty()) asked_.resize(surface.positions.size(), 0);
    if (++gathering_ != 0) return;
    std::ranges::fill(asked_, 0);
    gathering_ = 1;
}

void NearTriangles::gather_at(const Surface& surface, u32 place, const Box& where) {
    if (is_asked(place)) return;
    asked_[place] = gathering_;
    surface.fans.any(place, [&](const Fans::Pair& pair) {
        if (is_asked(pair.first) || is_asked(pair.last)) return false;
        const Triangle triangle{place, pair.first, pair.last};
        const Box box = box_of(surface, triangle);
        if (where.meets(box)) triangles_.push_back({triangle, box});
        return false;
    });
}

bool NearTriangles::meet(const Surface& surface, const Triangle& triangle) const {
    const Box box = box_of(surface, triangle);
    return std::ranges::any_of(triangles_, [&](const Boxed& other) {
        return box.meets(other.box) &&
               std::ranges::count_if(triangle, [&](u32 corner) { return std::ranges::count(other.corners, corner); }) !=
                   3 &&
               growing::meet(surface.positions, triangle, other.corners);
    });
}

}  // namespace scanmill::growing
