// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/sectors.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace scanmill::growing {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Pre: the sector first → last is narrower than a half turn.
bool inside(const Vec3& centre, const Vec3& first, const Vec3& last, const Vec3& p, const Vec3& axis,
            double axis_length) {
    return side_of(centre, first, p, axis, axis_length) >= 0 && side_of(centre, p, last, axis, axis_length) >= 0;
}

}  // namespace

int exact_side_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& axis, double axis_length) {
    const Vec3 above = a + axis_length * axis;
    const auto point = [](const Vec3& p) { return Kernel::Point_3(p.x(), p.y(), p.z()); };
    return static_cast<int>(CGAL::orientation(point(a), point(b), point(c), point(above)));
}

bool sector_is_free(const Surface& surface, u32 vertex, u32 first, u32 last, const Vec3& axis) {
    const auto& p = surface.positions;
    const Vec3& centre = p[vertex];
    if (side_of(centre, p[first], p[last], axis, surface.axis_length) <= 0) return false;
    return !surface.fans.any(vertex, [&](const Fans::Pair& pair) {
        if (pair.first == first || pair.last == last) return true;
        const auto in_pair = [&](u32 x) {
            return x != pair.first && x != pair.last &&
                   inside(centre, p[pair.first], p[pair.last], p[x], axis, surface.axis_length);
        };
        const auto in_new = [&](u32 x) {
            return x != first && x != last && inside(centre, p[first], p[last], p[x], axis, surface.axis_length);
        };
        return in_pair(first) || in_pair(last) || in_new(pair.first) || in_new(pair.last);
    });
}

bool lies_over(const Surface& surface, const Triangle& triangle, const Vec3& normal, u32 x) {
    const auto& p = surface.positions;
    for (std::size_t i = 0; i < 3; ++i)
        if (side_of(p[triangle[i]], p[triangle[(i + 1) % 3]], p[x], normal, surface.axis_length) < 0) return false;
    return true;
}

bool border_crosses(const Surface& surface, u32 vertex, u32 a, u32 d, u32 b, const Vec3& normal, double height) {
    const auto& p = surface.positions;
    const auto separates = [&](u32 from, u32 to, u32 x, u32 y) {
        const int first = side_of(p[from], p[to], p[x], normal, surface.axis_length);
        const int second = side_of(p[from], p[to], p[y], normal, surface.axis_length);
        return first * second <= 0 && (first != 0 || second != 0);
    };
    return surface.fans.any(vertex, [&](const Fans::Pair& pair) {
        const u32 end = pair.first;
        if (end == a || end == d || end == b || surface.fans.right_of(vertex, end) != nobody) return false;
        const double x = normal.dot(p[vertex] - p[d]), y = normal.dot(p[end] - p[d]);
        if (std::min(std::abs(x), std::abs(y)) > height && x * y > 0) return false;
        const auto cross = [&](u32 from, u32 to) {
            return separates(from, to, vertex, end) && separates(vertex, end, from, to);
        };
        return cross(a, d) || cross(d, b);
    });
}

}  // namespace scanmill::growing
