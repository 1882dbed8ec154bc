// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "alpha_solid/facet_values.hpp"
#include "alpha_solid/sphere_polynomials.hpp"

namespace scanmill::alpha {

namespace {

/// A double result is accepted where cancellation has left at least this share of the terms (squared: of their
/// squares); the rest is computed exactly.
constexpr double share = 1e-6, squared_share = share * share;

bool lexicographically_less(const Vec3& a, const Vec3& b) {
    if (a.x() != b.x()) return a.x() < b.x();
    if (a.y() != b.y()) return a.y() < b.y();
    return a.z() < b.z();
}

void order(const Vec3*& a, const Vec3*& b) {
    const bool swap = lexicographically_less(*b, *a);
    const Vec3* low = swap ? b : a;
    b = swap ? a : b;
    a = low;
}

/// Within these sizes no intermediate of degree six overflows, nor underflows so far as to matter against the bounds.
bool of_moderate_size(double least, double most) { return least > 1e-45 && most < 1e45; }

}  // namespace

double squared_circumradius(const Vec3& p, const Vec3& q, const Vec3& r) {
    const Vec3 *a = &p, *b = &q, *c = &r;
    order(a, b);
    order(b, c);
    order(a, b);
    const auto [u, v] = offsets_from(*a, *b, *c);
    const Offset<double> normal = cross(u, v), third = minus(v, u);
    const double uu = dot(u, u), vv = dot(v, v), normal_squared = dot(normal, normal);
    if (normal_squared > squared_share * (uu * vv) && std::min(uu, vv) > 1e-90 && std::max(uu, vv) < 1e90)
        return uu * vv * dot(third, third) / (4 * normal_squared);
    return exact_squared_circumradius(*a, *b, *c);
}

Circumsphere circumsphere(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    const Vec3 *a = &p, *b = &q, *c = &r, *d = &s;
    order(a, b);
    order(c, d);
    order(a, c);
    order(b, d);
    order(b, c);
    const Offsets<double, 3> offsets = offsets_from(*a, *b, *c, *d);
    const auto& [u, v, w] = offsets;
    const double uu = dot(u, u), vv = dot(v, v), ww = dot(w, w);
    const Offset<double> vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
    const double volume = dot(u, vw);
    const Offset<double> centre = circumcentre_numerator(uu, vv, ww, vw, wu, uv);

    Circumsphere result{};
    const double numerator = dot(centre, centre), denominator = volume * volume;
    const double um = largest(u), vm = largest(v), wm = largest(w);
    const bool moderate = of_moderate_size(std::min({um, vm, wm}), std::max({um, vm, wm}));
    if (moderate && denominator > squared_share * (uu * vv * ww) &&
        numerator > 3 * squared_share * (uu * vv * ww * (uu + vv + ww)))
        result.squared_radius = numerator / (4 * denominator);
    else
        result.squared_radius = exact_squared_circumradius(*a, *b, *c, *d);

    // Barycentric coordinates of the circumcentre, times 2 volume². With u, v, w short for the offsets' largest components:
    // the monomials of the last three sum to at most 36 uvw (u + v + w) times vw, wu or uv in absolute value, and pass at
    // most 19 roundings each, the offsets' included; those of the first to at most 44 uvw (u + v + w) (vw + wu + uv) and
    // 22 roundings. 22 · 44 · 2^-53 < 1.1e-13 covers all four.
    const double of_b = dot(centre, vw), of_c = dot(centre, wu), of_d = dot(centre, uv);
    const Offset<double> sum{vw[0] + wu[0] + uv[0], vw[1] + wu[1] + uv[1], vw[2] + wu[2] + uv[2]};
    const double of_a = 2 * denominator - dot(centre, sum);
    const double bound = moderate ? 1.1e-13 * (um * vm * wm * (um + vm + wm) * (vm * wm + wm * um + um * vm))
                                  : std::numeric_limits<double>::infinity();
    const auto mark = [&](double coordinate, const Vec3* corner) {
        bool inside = coordinate < 0;
        if (!(std::abs(coordinate) > bound)) {
            std::array<const Vec3*, 3> facet;
            std::ranges::copy_if(std::array{a, b, c, d}, facet.begin(), [&](const Vec3* other) { return other != corner; });
            inside = exact_smallest_sphere_sign(*facet[0], *facet[1], *facet[2], *corner) < 0;
        }
        if (inside) result.attached |= corner == &p ? 1 : corner == &q ? 2 : corner == &r ? 4 : 8;
    };
    mark(of_a, a);
    mark(of_b, b);
    mark(of_c, c);
    mark(of_d, d);
    return result;
}

}  // namespace scanmill::alpha
