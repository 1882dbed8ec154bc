// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/wide_triangles.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "region_grow/triangle_circle.hpp"

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

}  // namespace

void WideTriangles::update(const Surface& surface) {
    if (seen_ == 0) bound_ = circle_of_most(surface);
    for (; seen_ < surface.triangles.size(); ++seen_)
        if (squared_circle_of(surface, surface.triangles[seen_]) > bound_) wide_.push_back(surface.triangles[seen_]);
}

}  // namespace scanmill::growing
