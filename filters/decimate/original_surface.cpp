// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/original_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace scanmill::decimating {

using half_edges::after;
using half_edges::before;

bool OriginalSurface::add_path(u32 from, u32 to, const Vec3& up, const SignedErrors& limits,
                               SignedErrors& errors) const {
    const Vec3 begin = position(from), along = position(to) - begin;
    const double squared = along.squaredNorm();
    const Vec3 sideways = up.cross(along);
    struct End {
        u32 vertex;
        double side;  ///< proportional to the distance from the plane; negative on the right
    };
    const auto at = [&](u32 vertex) { return End{vertex, sideways.dot(position(vertex) - begin)}; };
    const auto crossing = [&](const End& right, const End& left) {
        const double share = right.side / (right.side - left.side);
        return Vec3(position(right.vertex) + share * (position(left.vertex) - position(right.vertex)));
    };

    // The edge opposite to `from` through which the plane leaves the triangles at `from`. Of several such edges, the
    // one crossed farthest towards `to`.
    u32 crossed = half_edges::boundary;
    double farthest = 0;
    u32 half_edge = features_.first(from);
    do {
        const u32 edge = after(half_edge);  // leads from right to left if the plane leaves here
        const End right = at(half_edges::start(mesh_, edge)), left = at(half_edges::end(mesh_, edge));
        if (right.vertex == to || left.vertex == to) return true;  // an edge of the original surface
        if (right.side < 0 && left.side >= 0) {
            const double share = (crossing(right, left) - begin).dot(along);
            if (share > farthest) {
                farthest = share;
                crossed = edge;
            }
        }
        half_edge = opposite_[before(half_edge)];
    } while (half_edge != half_edges::boundary && half_edge != features_.first(from));
    if (crossed == half_edges::boundary) return false;

    End right = at(half_edges::start(mesh_, crossed)), left = at(half_edges::end(mesh_, crossed));
    for (std::size_t steps = 0; steps < mesh_.triangles.size(); ++steps) {
        if (features_.is_feature(crossed)) return false;
        const Vec3 point = crossing(right, left) - begin;
        const Vec3 off = point - std::clamp(point.dot(along) / squared, 0.0, 1.0) * along;
        errors.add(off.norm(), off.dot(up) >= 0);
        if (!errors.is_within(limits)) return false;
        const u32 beyond = opposite_[crossed];
        const End apex = at(half_edges::start(mesh_, before(beyond)));
        if (apex.vertex == to) return true;
        if (apex.side < 0) {
            crossed = before(beyond);
            right = apex;
        } else {
            crossed = after(beyond);
            left = apex;
        }
    }
    return false;
}

}  // namespace scanmill::decimating
