// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/overlaps.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/geometry/growing/detail/exact_orientation.hpp"

namespace scanmill::growing {

int exact_side_of(const Surface& surface, u32 a, u32 b, u32 c, const Vec3& axis) {
    const auto& p = surface.positions;
    return exact::orientation(p[a], p[b], p[c], p[a] + surface.axis_length * axis);
}

bool sector_is_free(const Surface& surface, u32 vertex, u32 first, u32 last, const Vec3& axis) {
    const auto side = [&](u32 a, u32 b) { return side_of(surface, vertex, a, b, axis); };
    if (side(first, last) <= 0) return false;
    const auto is_between = [&](u32 begin, u32 x, u32 end) {
        return x != begin && x != end && side(begin, x) >= 0 && side(x, end) >= 0;
    };
    return !surface.fans.any(vertex, [&](const Fans::LinkEdge& edge) {
        return edge.first == first || edge.last == last || is_between(edge.first, first, edge.last) ||
               is_between(edge.first, last, edge.last) || is_between(first, edge.first, last) ||
               is_between(first, edge.last, last);
    });
}

Vec3 fan_normal(const Surface& surface, u32 vertex, const Vec3& more) {
    Vec3 sum = more;
    surface.fans.any(vertex, [&](const Fans::LinkEdge& edge) {
        sum += surface.facet_normal(vertex, edge.first, edge.last);
        return false;
    });
    return sum.normalized();
}

bool sectors_are_free(const Surface& surface, const Triangle& triangle, const Vec3& normal, bool along_fans) {
    for (std::size_t i = 0; i < 3; ++i) {
        const u32 corner = triangle[i];
        if (surface.fans.empty(corner)) continue;
        const Vec3 axis = surface.fixed_edges.at(corner)
                              ? Vec3((fan_normal(surface, corner, Vec3::Zero()) + normal).normalized())
                          : along_fans ? fan_normal(surface, corner, normal)
                                       : surface.normals[corner];
        if (!sector_is_free(surface, corner, triangle[(i + 1) % 3], triangle[(i + 2) % 3], axis)) return false;
    }
    return true;
}

bool contains(const Surface& surface, const Triangle& triangle, const Vec3& normal, u32 point) {
    for (std::size_t i = 0; i < 3; ++i)
        if (side_of(surface, triangle[i], triangle[(i + 1) % 3], point, normal) < 0) return false;
    return true;
}

bool crosses_fixed_edge(const Surface& surface, const Triangle& triangle, const Vec3& normal,
                        std::span<const u32> near) {
    const auto& p = surface.positions;
    const auto& fixed = surface.fixed_edges;
    if (fixed.empty()) return false;
    constexpr double steep = 0.9;  // sine of 64 degrees
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, (p[triangle[(i + 1) % 3]] - p[triangle[i]]).norm());
    const auto side = [&](u32 a, u32 b, u32 c) { return side_of(surface, a, b, c, normal); };
    const auto is_corner = [&](u32 x) { return std::ranges::find(triangle, x) != triangle.end(); };

    const auto leaves_into = [&](std::size_t i, u32 end) {
        const u32 corner = triangle[i];
        const Vec3 along = p[end] - p[corner];
        return std::abs(normal.dot(along)) < steep * along.norm() && side(corner, triangle[(i + 1) % 3], end) >= 0 &&
               side(corner, end, triangle[(i + 2) % 3]) >= 0;
    };
    for (std::size_t i = 0; i < 3; ++i)
        for (u32 end : fixed.of(triangle[i]))
            if (!is_corner(end) && leaves_into(i, end)) return true;

    const auto separates = [&](u32 from, u32 to, u32 x, u32 y) {
        const int first = side(from, to, x), second = side(from, to, y);
        return first * second <= 0 && (first != 0 || second != 0);
    };
    const auto crosses = [&](u32 x, u32 y) {
        const double height_x = normal.dot(p[x] - p[triangle[0]]), height_y = normal.dot(p[y] - p[triangle[0]]);
        if (std::min(std::abs(height_x), std::abs(height_y)) > longest / 2 && height_x * height_y > 0) return false;
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3];
            if (separates(from, to, x, y) && separates(x, y, from, to)) return true;
        }
        return std::abs(height_x) < longest / 2 && contains(surface, triangle, normal, x);
    };
    return std::ranges::any_of(near, [&](u32 x) {
        return !is_corner(x) && std::ranges::any_of(fixed.of(x), [&](u32 y) { return !is_corner(y) && crosses(x, y); });
    });
}

bool boundary_crosses(const Surface& surface, u32 vertex, u32 a, u32 d, u32 b, const Vec3& normal, double height) {
    const auto& p = surface.positions;
    const auto separates = [&](u32 from, u32 to, u32 x, u32 y) {
        const int first = side_of(surface, from, to, x, normal), second = side_of(surface, from, to, y, normal);
        return first * second <= 0 && (first != 0 || second != 0);
    };
    return surface.fans.any(vertex, [&](const Fans::LinkEdge& edge) {
        const u32 end = edge.first;
        if (end == a || end == d || end == b || surface.fans.right_of(vertex, end) != invalid_index) return false;
        const double x = normal.dot(p[vertex] - p[d]), y = normal.dot(p[end] - p[d]);
        if (std::min(std::abs(x), std::abs(y)) > height && x * y > 0) return false;
        const auto cross = [&](u32 from, u32 to) {
            return separates(from, to, vertex, end) && separates(vertex, end, from, to);
        };
        return cross(a, d) || cross(d, b);
    });
}

}  // namespace scanmill::growing
