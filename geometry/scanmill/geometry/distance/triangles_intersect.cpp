// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/triangles_intersect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "scanmill/geometry/distance/detail/exact_intersection.hpp"

namespace scanmill {

namespace {

using exact::Corners;

/// Bounds of the error of a determinant of differences. `rounding`: the rounding error, as a share of the sum of the
/// absolute values of the terms (Shewchuk 1997, orient3d). `underflow`: the additional error by underflow, for
/// coordinates in the permitted range.
constexpr double epsilon = 0x1p-53;
constexpr double rounding = (7 + 56 * epsilon) * epsilon, underflow = 0x1p-900;

/// A plane that decides sides in rounded arithmetic where rounding cannot change the result.
struct Plane {
    Vec3 origin, normal;
    /// Sums of the absolute values of the terms of the normal's coordinates.
    Vec3 magnitude;

    /// The plane with exactly this normal.
    Plane(const Vec3& at, const Vec3& across) : origin(at), normal(across), magnitude(across.cwiseAbs()) {}
    /// The plane spanned by two vectors. Each is exact, or the rounded value of an exact difference of positions.
    Plane(const Vec3& at, const Vec3& u, const Vec3& v) : origin(at) {
        for (int axis = 0; axis < 3; ++axis) {
            const int next = (axis + 1) % 3, last = (axis + 2) % 3;
            const double one = u[next] * v[last], other = u[last] * v[next];
            normal[axis] = one - other;
            magnitude[axis] = std::abs(one) + std::abs(other);
        }
    }
    /// The side of the plane, -1 or 1; 0 if rounding or overflow makes the side uncertain.
    int side_of(const Vec3& point) const {
        const Vec3 to = point - origin;
        const double value = normal.dot(to), error = rounding * magnitude.dot(to.cwiseAbs()) + underflow;
        return (value > error) - (value < -error);
    }
};

Plane plane_of(const Corners& triangle) {
    return {*triangle[0], *triangle[1] - *triangle[0], *triangle[2] - *triangle[0]};
}

/// The side of the plane on which all corners from number `first` on lie; 0 if there is none.
int common_side(const Plane& plane, const Corners& triangle, std::size_t first) {
    const int side = plane.side_of(*triangle[2]);
    for (std::size_t i = first; i < 2; ++i)
        if (plane.side_of(*triangle[i]) != side) return 0;
    return side;
}

/// Whether a plane through the common first corner separates the triangles. Only one plane is tried: its normal is the
/// difference of the mean directions of the triangles' edges.
bool are_opposite(const Corners& one, const Corners& other) {
    const Vec3& corner = *one[0];
    const auto direction = [&](const Vec3& to) -> Vec3 { return (to - corner) / (to - corner).lpNorm<1>(); };
    const Plane between(corner, direction(*one[1]) + direction(*one[2]) - direction(*other[1]) - direction(*other[2]));
    return common_side(between, one, 1) == 1 && common_side(between, other, 1) == -1;
}

/// Whether a plane through an edge of `one` and perpendicular to `one` separates the triangles. Common corners may be
/// on this edge.
bool edge_separates(const Corners& one, const Vec3& normal, const Corners& other, std::size_t common) {
    for (std::size_t opposite = common; opposite < 3; ++opposite) {
        const Vec3 &from = *one[(opposite + 1) % 3], &to = *one[(opposite + 2) % 3];
        const Plane along(from, to - from, normal);
        if (along.side_of(*one[opposite]) * common_side(along, other, common) == -1) return true;
    }
    return false;
}

/// Reorders the corners of both triangles so that the common corners come first, in the same order. Returns their
/// number.
std::size_t bring_common_first(Triangle& one, Triangle& other) {
    std::size_t common = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = common; j < 3; ++j)
            if (one[i] == other[j]) {
                std::swap(one[common], one[i]);
                std::swap(other[common], other[j]);
                ++common;
                break;
            }
    return common;
}

bool boxes_meet(const Corners& one, const Corners& other) {
    const auto low = [](const Corners& t) -> Vec3 { return t[0]->cwiseMin(*t[1]).cwiseMin(*t[2]); };
    const auto high = [](const Corners& t) -> Vec3 { return t[0]->cwiseMax(*t[1]).cwiseMax(*t[2]); };
    return (low(one).array() <= high(other).array()).all() && (low(other).array() <= high(one).array()).all();
}

Corners corners_of(std::span<const Vec3> positions, const Triangle& triangle) {
    return {&positions[triangle[0]], &positions[triangle[1]], &positions[triangle[2]]};
}

/// Whether rounded arithmetic finds a plane between the triangles. If so, the triangles touch in common corners only.
bool are_apart(const Corners& one, const Corners& other, std::size_t common) {
    if (common == 0 && !boxes_meet(one, other)) return true;
    if (common == 1 && are_opposite(one, other)) return true;
    const Plane plane = plane_of(one);
    if (common_side(plane, other, common) != 0) return true;
    const Plane other_plane = plane_of(other);
    return common_side(other_plane, one, common) != 0 || edge_separates(one, plane.normal, other, common) ||
           edge_separates(other, other_plane.normal, one, common);
}

bool is_collinear(const Corners& triangle) {
    const Plane plane = plane_of(triangle);
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(plane.normal[axis]) > rounding * plane.magnitude[axis] + underflow) return false;
    return exact::collinear(triangle);
}

}  // namespace

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) { return is_collinear({&a, &b, &c}); }

bool triangles_intersect(std::span<const Vec3> positions, const Triangle& first, const Triangle& second) {
    Triangle of_one = first, of_other = second;
    const std::size_t common = bring_common_first(of_one, of_other);
    const Corners one = corners_of(positions, of_one), other = corners_of(positions, of_other);
    if (are_apart(one, other, common)) return false;
    if (is_collinear(one) || is_collinear(other)) return false;
    return exact::triangles_intersect(one, other, common);
}

}  // namespace scanmill
