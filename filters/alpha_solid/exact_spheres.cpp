// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "alpha_solid/exact_number.hpp"
#include "alpha_solid/sphere_polynomials.hpp"

namespace scanmill::alpha {

namespace {

/// Offsets over 2^exponent, so that products of many of them stay within double's range.
template <std::size_t count>
int normalise(Offsets<Exact, count>& offsets) {
    double size = 0;
    for (const Offset<Exact>& offset : offsets)
        for (const Exact& component : offset) size = std::max(size, std::abs(CGAL::to_double(component)));
    const int exponent = exponent_near(size);
    const Exact scale(std::ldexp(1.0, -exponent));
    for (Offset<Exact>& offset : offsets)
        for (Exact& component : offset) component = component * scale;
    return exponent;
}

}  // namespace

double exact_squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    Offsets<Exact, 3> offsets = offsets_from<Exact>(a, b, c, d);
    const int exponent = normalise(offsets);
    const auto& [u, v, w] = offsets;
    const Offset<Exact> vw = cross(v, w);
    const Exact determinant = dot(u, vw);
    const Offset<Exact> centre = circumcentre_numerator(dot(u, u), dot(v, v), dot(w, w), vw, cross(w, u), cross(u, v));
    return exact_quotient(dot(centre, centre), Exact(4) * determinant * determinant, exponent);
}

double exact_squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c) {
    Offsets<Exact, 2> offsets = offsets_from<Exact>(a, b, c);
    const int exponent = normalise(offsets);
    const auto& [u, v] = offsets;
    const Offset<Exact> normal = cross(u, v), third = minus(v, u);
    return exact_quotient(dot(u, u) * dot(v, v) * dot(third, third), Exact(4) * dot(normal, normal), exponent);
}

int exact_smallest_sphere_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return static_cast<int>(CGAL::sign(smallest_sphere_power(offsets_from<Exact>(a, b, c, d))));
}

}  // namespace scanmill::alpha
