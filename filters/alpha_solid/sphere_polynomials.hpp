// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The polynomials behind circumspheres, for any number type: one definition serves doubles and exact numbers.
///
/// Everything is written in offsets u, v, w from one corner. With n = u×v and p = u·(v×w):
/// circumcentre of a tetrahedron = (|u|² v×w + |v|² w×u + |w|² u×v) / 2p;
/// circumcentre of a triangle    = (|v|² n×u + |u|² v×n) / 2|n|².

#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/data/frame.hpp"

namespace scanmill::alpha {

template <class Number>
using Offset = std::array<Number, 3>;
template <class Number, std::size_t count>
using Offsets = std::array<Offset<Number>, count>;

template <class Number>
Number dot(const Offset<Number>& a, const Offset<Number>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Number>
Offset<Number> cross(const Offset<Number>& a, const Offset<Number>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class Number>
Offset<Number> minus(const Offset<Number>& a, const Offset<Number>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline double largest(const Offset<double>& offset) {
    return std::max(std::abs(offset[0]), std::max(std::abs(offset[1]), std::abs(offset[2])));
}

template <class Number = double, class... Others>
Offsets<Number, sizeof...(Others)> offsets_from(const Vec3& origin, const Others&... others) {
    const auto offset = [&](const Vec3& p) -> Offset<Number> {
        return {Number(p.x()) - Number(origin.x()), Number(p.y()) - Number(origin.y()),
                Number(p.z()) - Number(origin.z())};
    };
    return {offset(others)...};
}

/// |u|² v×w + |v|² w×u + |w|² u×v.
template <class Number>
Offset<Number> circumcentre_numerator(const Number& uu, const Number& vv, const Number& ww, const Offset<Number>& vw,
                                      const Offset<Number>& wu, const Offset<Number>& uv) {
    Offset<Number> sum;
    for (int i = 0; i < 3; ++i) sum[i] = uu * vw[i] + vv * wu[i] + ww * uv[i];
    return sum;
}

/// |n|² times the power of offset w with regard to the smallest sphere through 0, u and v: negative inside.
/// |n|² |w|² − w·(|v|² n×u + |u|² v×n).
template <class Number>
Number smallest_sphere_power(const Offsets<Number, 3>& offsets) {
    const auto& [u, v, w] = offsets;
    const Offset<Number> n = cross(u, v);
    const Offset<Number> nu = cross(n, u), vn = cross(v, n);
    const Number uu = dot(u, u), vv = dot(v, v);
    Offset<Number> twice_centre;
    for (int i = 0; i < 3; ++i) twice_centre[i] = vv * nu[i] + uu * vn[i];
    return dot(n, n) * dot(w, w) - dot(w, twice_centre);
}

/// The same in exact arithmetic, for the few cases that doubles cannot decide; a thousand times slower. Values are
/// finite: one beyond the range of double becomes the largest double.
double exact_squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
double exact_squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c);
/// −1 when d is strictly inside the smallest sphere through a, b, c; 0 on it; 1 outside.
int exact_smallest_sphere_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace scanmill::alpha
