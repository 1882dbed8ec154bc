// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The polynomials behind the spheres of cells and facets, for any number type: one definition serves doubles,
/// intervals and exact numbers.
///
/// Everything is written in offsets u, v, w from one corner. With n = u×v and p = u·(v×w):
/// circumcentre of a tetrahedron = (|u|² v×w + |v|² w×u + |w|² u×v) / 2p;
/// circumcentre of a triangle    = (|v|² n×u + |u|² v×n) / 2|n|².
///
/// With weights, the centre's offset x from corner a satisfies 2 x·u = |u|² + w_a - w_b for every other corner b at
/// offset u. The right-hand sides are called lifts here. The formulas also hold with these lifts in place of |u|², |v|²
/// and |w|².

#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/data/frame.hpp"

namespace scanmill::spheres {

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

template <class Number>
Offset<Number> times(const Number& factor, const Offset<Number>& offset) {
    return {factor * offset[0], factor * offset[1], factor * offset[2]};
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

/// Returns |u|² v×w + |v|² w×u + |w|² u×v.
template <class Number>
Offset<Number> circumcentre_numerator(const Number& uu, const Number& vv, const Number& ww, const Offset<Number>& vw,
                                      const Offset<Number>& wu, const Offset<Number>& uv) {
    Offset<Number> sum;
    for (int i = 0; i < 3; ++i) sum[i] = uu * vw[i] + vv * wu[i] + ww * uv[i];
    return sum;
}

/// |n|² times the power of offset w with regard to the smallest sphere through 0, u and v; negative inside the sphere.
/// It is |n|² |w|² − w·(|v|² n×u + |u|² v×n).
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

/// numerator / denominator. The numerator is not negative, and the denominator is above 0.
template <class Number>
struct Fraction {
    Number numerator, denominator;
};

/// A weighted corner relative to another one; lifts are defined at the top.
template <class Number>
struct Lifted {
    Offset<Number> offset;
    Number lift;
};

/// The smallest sphere orthogonal to a, b and c. Twice the offset of its centre from a is n × spread / |n|², with n =
/// u×v and spread = lift(c) u - lift(b) v. Its squared radius is |spread|² / 4|n|² plus `deficit`, the amount by which
/// a's weight is below the largest.
template <class Number>
struct FacetSphere {
    FacetSphere(const Lifted<Number>& b, const Lifted<Number>& c)
        : normal(cross(b.offset, c.offset)),
          normal_squared(dot(normal, normal)),
          spread(minus(times(c.lift, b.offset), times(b.lift, c.offset))) {}

    Fraction<Number> squared_radius(const Number& deficit) const {
        const Number denominator = Number(4) * normal_squared;
        return {dot(spread, spread) + deficit * denominator, denominator};
    }
    /// |n|² times the power of d with regard to this sphere.
    Number power(const Lifted<Number>& d) const {
        return normal_squared * d.lift - dot(d.offset, cross(normal, spread));
    }

    Offset<Number> normal;
    Number normal_squared;
    Offset<Number> spread;
};

template <class Number>
Fraction<Number> cell_squared_radius(const Lifted<Number>& b, const Lifted<Number>& c, const Lifted<Number>& d,
                                     const Number& deficit) {
    const Offset<Number> cd = cross(c.offset, d.offset);
    const Offset<Number> centre =
        circumcentre_numerator(b.lift, c.lift, d.lift, cd, cross(d.offset, b.offset), cross(b.offset, c.offset));
    const Number volume = dot(b.offset, cd);
    const Number denominator = Number(4) * volume * volume;
    return {dot(centre, centre) + deficit * denominator, denominator};
}

}  // namespace scanmill::spheres
