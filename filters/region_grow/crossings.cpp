// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/crossings.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <cmath>

namespace scanmill::growing {

namespace {

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

void NearTriangles::gather_round(const Surface& surface, std::span<const u32> corners) {
    const Vec3& centre = surface.positions[corners[0]];
    double size = 0;
    for (u32 corner : corners) size = std::max(size, (surface.positions[corner] - centre).norm());
    // The filling lies in that ball; of a triangle that meets it a corner is no farther than its circle.
    const double reach = (size + std::sqrt(surface.largest_squared_circle)) * (1 + 1e-9);
    places_.assign(1, corners[0]);
    surface.neighbourhoods.within(corners[0], reach * reach, buffer_, places_);
    gather_at_places(surface);
}

void NearTriangles::gather_near(const Surface& surface, const Triangle& triangle) {
    places_.assign(triangle.begin(), triangle.end());
    for (u32 place : triangle)
        for (u32 other : surface.neighbourhoods.of(place))
            if (surface.states[other] != PlaceState::unused) places_.push_back(other);
    gather_at_places(surface);
}

void NearTriangles::gather_at_places(const Surface& surface) {
    std::ranges::sort(places_);
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    triangles_.clear();
    for (u32 place : places_)
        surface.fans.any(place, [&](const Fans::Pair& pair) {
            // Once: at the lowest of its corners that was gathered.
            const auto earlier = [&](u32 corner) {
                return corner < place && std::ranges::binary_search(places_, corner);
            };
            if (!earlier(pair.first) && !earlier(pair.last)) add(surface, {place, pair.first, pair.last});
            return false;
        });
}

void NearTriangles::add(const Surface& surface, const Triangle& triangle) {
    const auto& p = surface.positions;
    const Vec3 &a = p[triangle[0]], &b = p[triangle[1]], &c = p[triangle[2]];
    triangles_.push_back({triangle, a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)});
}

bool NearTriangles::meet(const Surface& surface, const Triangle& triangle) const {
    const auto& p = surface.positions;
    const Vec3 &a = p[triangle[0]], &b = p[triangle[1]], &c = p[triangle[2]];
    const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    return std::ranges::any_of(triangles_, [&](const Boxed& other) {
        return (other.low.array() <= high.array()).all() && (low.array() <= other.high.array()).all() &&
               std::ranges::count_if(triangle, [&](u32 corner) { return std::ranges::count(other.corners, corner); }) !=
                   3 &&
               growing::meet(p, triangle, other.corners);
    });
}

}  // namespace scanmill::growing
