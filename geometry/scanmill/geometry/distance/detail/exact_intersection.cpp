// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/detail/exact_intersection.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>

namespace scanmill::exact {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 point(const Vec3* p) { return {p->x(), p->y(), p->z()}; }

Kernel::Triangle_3 triangle(const Corners& t) { return {point(t[0]), point(t[1]), point(t[2])}; }

/// The edge opposite the first corner.
Kernel::Segment_3 edge(const Corners& t) { return {point(t[1]), point(t[2])}; }

/// The side of the line from `a` to `b` on which `p` is after a move by ε along x and ε² along y. 0 only if a = b.
int side(const Kernel::Point_2& a, const Kernel::Point_2& b, const Kernel::Point_2& p) {
    const auto orientation = static_cast<int>(CGAL::orientation(a, b, p));
    if (orientation != 0) return orientation;
    const auto by_x = static_cast<int>(CGAL::compare_y(a, b));
    return by_x != 0 ? by_x : static_cast<int>(CGAL::compare_x(b, a));
}

}  // namespace

bool collinear(const Corners& triangle) {
    return CGAL::collinear(point(triangle[0]), point(triangle[1]), point(triangle[2]));
}

bool triangles_intersect(const Corners& one, const Corners& other, std::size_t common) {
    switch (common) {
        case 0: return CGAL::do_intersect(triangle(one), triangle(other));
        case 1:
            // Any other common part extends, in one of the triangles, to the edge opposite the common corner.
            return CGAL::do_intersect(triangle(one), edge(other)) || CGAL::do_intersect(triangle(other), edge(one));
        case 2: {
            // Triangles with a common edge overlap if one is folded flat onto the other.
            const Kernel::Point_3 a = point(one[0]), b = point(one[1]), c = point(one[2]), d = point(other[2]);
            return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
        }
        default: return true;  // the same triangle twice
    }
}

int crossing(const Vec3& p, int axis, bool is_upward, const Corners& triangle) {
    // Projects seen from the positive end of the axis: counter-clockwise triangles face the positive direction.
    const auto seen = [&](const Vec3& v) { return Kernel::Point_2(v[(axis + 1) % 3], v[(axis + 2) % 3]); };
    const Kernel::Point_2 a = seen(*triangle[0]), b = seen(*triangle[1]), c = seen(*triangle[2]), q = seen(p);
    const int facing = side(a, b, q);
    if (facing == 0 || side(b, c, q) != facing || side(c, a, q) != facing) return 0;
    const auto above =
        static_cast<int>(CGAL::orientation(point(triangle[0]), point(triangle[1]), point(triangle[2]), point(&p)));
    return above == (is_upward ? -facing : facing) ? facing : 0;
}

}  // namespace scanmill::exact
