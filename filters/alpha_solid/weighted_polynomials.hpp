// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The polynomials behind spheres orthogonal to weighted points, for any number type: one definition serves intervals
/// and exact numbers.
///
/// The centre's offset x from corner a satisfies 2 x·u = |u|² + w_a - w_b for every other corner b at offset u: the
/// formulas of sphere_polynomials.hpp with these right-hand sides, here called lifts, in place of |u|².

#include "alpha_solid/sphere_polynomials.hpp"

namespace scanmill::alpha {

/// numerator / denominator; both of them non-negative, the denominator above 0.
template <class Number>
struct Fraction {
    Number numerator, denominator;
};

/// A corner as seen from another one.
template <class Number>
struct Lifted {
    Offset<Number> offset;
    Number lift;
};

template <class Number>
Offset<Number> times(const Number& factor, const Offset<Number>& offset) {
    return {factor * offset[0], factor * offset[1], factor * offset[2]};
}

/// Twice the centre of the smallest sphere of a, b and c is n × spread / |n|², with n = u×v and
/// spread = lift(c) u - lift(b) v; so its squared radius is |spread|² / 4|n|² plus what a's weight lacks.
template <class Number>
struct FacetSphere {
    FacetSphere(const Lifted<Number>& b, const Lifted<Number>& c)
        : normal(cross(b.offset, c.offset)),
          normal_squared(dot(normal, normal)),
          spread(minus(times(c.lift, b.offset), times(b.lift, c.offset))) {}

    Fraction<Number> squared_radius(const Number& lacking) const {
        const Number denominator = Number(4) * normal_squared;
        return {dot(spread, spread) + lacking * denominator, denominator};
    }
    /// |n|² times the power of d.
    Number power(const Lifted<Number>& d) const {
        return normal_squared * d.lift - dot(d.offset, cross(normal, spread));
    }

    Offset<Number> normal;
    Number normal_squared;
    Offset<Number> spread;
};

template <class Number>
Fraction<Number> cell_squared_radius(const Lifted<Number>& b, const Lifted<Number>& c, const Lifted<Number>& d,
                                     const Number& lacking) {
    const Offset<Number> cd = cross(c.offset, d.offset);
    const Offset<Number> centre =
        circumcentre_numerator(b.lift, c.lift, d.lift, cd, cross(d.offset, b.offset), cross(b.offset, c.offset));
    const Number volume = dot(b.offset, cd);
    const Number denominator = Number(4) * volume * volume;
    return {dot(centre, centre) + lacking * denominator, denominator};
}

}  // namespace scanmill::alpha
