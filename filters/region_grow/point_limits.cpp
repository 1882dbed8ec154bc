// SPDX-License-Identifier: GPL-3.0-or-later
// What keeps a point from being suitable.
#include <Eigen/Geometry>
#include <algorithm>

#include "region_grow/sectors.hpp"
#include "region_grow/suitable_point.hpp"

namespace scanmill::growing {

namespace {

/// Of the neighbours' variance, across their plane: above this a point's normal tells nothing, at a tip.
constexpr float shapeless = 0.18f;

}  // namespace

bool PointChooser::agrees_with_points(const Triangle& triangle, const Vec3& normal, const Limits& limits) const {
    return std::ranges::all_of(triangle, [&](u32 corner) {
        const double cosine = surface_.normals[corner].dot(normal);
        const bool sign_counts = surface_.oriented || surface_.states[corner] != PlaceState::unused;
        const float roughness = surface_.roughness[corner];
        if (roughness > shapeless) return true;
        const double least = roughness > rough ? limits.rough_cosine : limits.point_cosine;
        return (sign_counts ? cosine : std::abs(cosine)) >= least;
    });
}

bool PointChooser::agrees_with_joined(u32 from, u32 to, const Vec3& normal, double least) const {
    const u32 third = surface_.fans.left_of(to, from);
    return third == nobody || surface_.facet_normal(to, from, third).dot(normal) >= least;
}

Vec3 PointChooser::fan_axis(u32 vertex, const Vec3& more) const {
    Vec3 sum = more;
    surface_.fans.any(vertex, [&](const Fans::Pair& pair) {
        sum += surface_.facet_normal(vertex, pair.first, pair.last);
        return false;
    });
    return sum.normalized();
}

bool PointChooser::sectors_are_free(const Triangle& triangle, const Vec3& normal, Pass pass) const {
    for (std::size_t i = 0; i < 3; ++i) {
        const u32 corner = triangle[i];
        if (surface_.fans.empty(corner)) continue;
        const Vec3 axis = pass == 0 ? surface_.normals[corner] : fan_axis(corner, normal);
        if (!sector_is_free(surface_, corner, triangle[(i + 1) % 3], triangle[(i + 2) % 3], axis)) return false;
    }
    return true;
}

bool PointChooser::lies_over_others(const Triangle& triangle, const Vec3& normal) {
    const auto& p = surface_.positions;
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, (p[triangle[(i + 1) % 3]] - p[triangle[i]]).norm());
    const double height = longest / 2;
    const auto on_this_sheet = [&](u32 x) {
        return (surface_.states[x] == PlaceState::unused && !surface_.oriented) || surface_.normals[x].dot(normal) > 0;
    };
    for (const Candidate& other : turned_down_)
        if (on_this_sheet(other.point) && std::abs(normal.dot(p[other.point] - p[triangle[0]])) < height &&
            lies_over(surface_, triangle, normal, other.point))
            return true;
    for (u32 x : fronts_) {
        if (x == triangle[1] || !on_this_sheet(x)) continue;
        if (border_crosses(surface_, x, triangle[0], triangle[1], triangle[2], normal, height)) return true;
    }
    return false;
}

bool PointChooser::has_good_angles(u32 from, u32 to, u32 point, const Limits& limits) const {
    const auto& p = surface_.positions;
    const double a = (p[point] - p[to]).norm(), b = (p[point] - p[from]).norm(), c = (p[to] - p[from]).norm();
    // The smallest angle is opposite the shortest side; its sine is that side over the diameter of the circumcircle.
    const double twice_area = (p[point] - p[from]).cross(p[to] - p[from]).norm();
    return std::min({a, b, c}) * twice_area >= limits.least_sine * a * b * c;
}

bool PointChooser::keeps_limits(u32 from, u32 to, const Candidate& candidate, const Limits& limits,
                                bool new_surface) const {
    const u32 point = candidate.point;
    if (surface_.states[point] == PlaceState::interior || !has_good_angles(from, to, point, limits)) return false;
    const Triangle triangle{from, point, to};
    if (!agrees_with_points(triangle, candidate.normal, limits)) return false;
    if (new_surface) return true;
    const Fans& fans = surface_.fans;
    if (fans.left_of(from, point) != nobody || fans.left_of(point, to) != nobody) return false;
    if (!agrees_with_joined(from, point, candidate.normal, limits.normal_cosine) ||
        !agrees_with_joined(point, to, candidate.normal, limits.normal_cosine))
        return false;
    // A triangle that joins those at the point in nothing but the point: the next ones will join them at edges.
    const bool touches = !fans.empty(point) && fans.left_of(point, from) == nobody && fans.left_of(to, point) == nobody;
    return !touches || fan_axis(point, Vec3::Zero()).dot(candidate.normal) >= limits.touch_cosine;
}

bool PointChooser::is_suitable(u32 from, u32 to, const Candidate& candidate, const Limits& limits, bool new_surface) {
    if (!keeps_limits(from, to, candidate, limits, new_surface)) return false;
    if (new_surface) return true;
    const Triangle triangle{from, candidate.point, to};
    return sectors_are_free(triangle, candidate.normal, limits.pass) && !lies_over_others(triangle, candidate.normal);
}

bool PointChooser::passes_through_others(const Triangle& triangle) {
    near_triangles_.gather_near(surface_, triangle);
    return near_triangles_.meet(surface_, triangle);
}

bool PointChooser::is_neighbour(u32 point, u32 vertex) const {
    return surface_.fans.any(vertex, [&](const Fans::Pair& pair) { return pair.first == point || pair.last == point; });
}

}  // namespace scanmill::growing
