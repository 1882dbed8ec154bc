// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/triangle_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace scanmill {

namespace {

/// Limit of the squared ratio of height to longest edge. Below it, the weights of Ericson's method lose too many
/// digits.
constexpr double thin = 1.0 / 16;

/// Ericson's walk through the Voronoi regions of corners, edges and face. Pre: not thin.
Vec3 nearest_by_region(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a;
    const Vec3 ap = point - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vec3 bp = ap - ab;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const Vec3 cp = ap - ac;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) {
        const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return b + along * (c - b);
    }
    const double scale = 1 / (va + vb + vc);
    return a + vb * scale * ab + vc * scale * ac;
}

/// The projection of `point` to the plane of the triangle, clamped to the triangle. Its coordinates are along the
/// longest edge and along the height, which are perpendicular. They are therefore as accurate as the corners, however
/// thin the triangle is. Pre: p q is the longest edge.
Vec3 projection(const Vec3& point, const Vec3& p, const Vec3& q, const Vec3& r) {
    const Vec3 edge = q - p, side = r - p;
    const double squared = edge.squaredNorm();
    const double foot = edge.dot(side) / squared;
    Vec3 height = side - foot * edge;
    height -= edge.dot(height) / squared * edge;  // removes the rounding error along the edge
    if (!(height.squaredNorm() > 0)) return p;
    const Vec3 to = point - p;
    const double up = std::clamp(height.dot(to) / height.squaredNorm(), 0.0, 1.0);
    const double along = std::clamp(edge.dot(to) / squared - up * foot, 0.0, 1.0 - up);
    return p + along * edge + up * side;
}

Vec3 nearest_on_thin(const Vec3& point, const Vec3& p, const Vec3& q, const Vec3& r) {
    Vec3 best = nearest_on_segment(point, p, q);
    for (const Vec3& candidate :
         {nearest_on_segment(point, q, r), nearest_on_segment(point, r, p), projection(point, p, q, r)})
        if ((candidate - point).squaredNorm() < (best - point).squaredNorm()) best = candidate;
    return best;
}

}  // namespace

Vec3 nearest_on_segment(const Vec3& point, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    const double squared = along.squaredNorm();
    if (!(squared > 0)) return a;
    const double share = along.dot(point - a) / squared;
    if (share <= 0) return a;
    if (share >= 1) return b;
    return a + share * along;
}

Vec3 nearest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a;
    const double squared_ab = ab.squaredNorm(), squared_ac = ac.squaredNorm(), squared_bc = (c - b).squaredNorm();
    const double longest = std::max({squared_ab, squared_ac, squared_bc});
    if (ab.cross(ac).squaredNorm() > thin * longest * longest) return nearest_by_region(point, a, b, c);
    if (longest == squared_ab) return nearest_on_thin(point, a, b, c);
    return longest == squared_bc ? nearest_on_thin(point, b, c, a) : nearest_on_thin(point, c, a, b);
}

}  // namespace scanmill
