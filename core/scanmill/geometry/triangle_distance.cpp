// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/triangle_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace scanmill {

namespace {

/// Squared height over longest edge below which rounding decides between the regions of Ericson's method: its weights
/// lose the square of that ratio.
constexpr double thin = 1e-4;

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
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
    const double doubled_area = ab.cross(ac).squaredNorm();
    if (doubled_area > thin * longest * longest) return nearest_by_region(point, a, b, c);

    Vec3 best = nearest_on_segment(point, a, b);
    const auto offer = [&](const Vec3& candidate) {
        if ((candidate - point).squaredNorm() < (best - point).squaredNorm()) best = candidate;
    };
    offer(nearest_on_segment(point, b, c));
    offer(nearest_on_segment(point, c, a));
    if (doubled_area > 0) {
        // The face's own candidate, held inside by its weights, which may be noise: it is a point of the triangle.
        const Vec3 normal = ab.cross(ac), ap = point - a;
        const double v = std::clamp(ap.cross(ac).dot(normal) / doubled_area, 0.0, 1.0);
        const double w = std::clamp(ab.cross(ap).dot(normal) / doubled_area, 0.0, 1.0 - v);
        offer(a + v * ab + w * ac);
    }
    return best;
}

}  // namespace scanmill
