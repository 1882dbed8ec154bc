// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/weighted_spheres.hpp"

#include <CGAL/Interval_nt.h>

#include <bit>
#include <cmath>

#include "alpha_solid/exact_number.hpp"
#include "alpha_solid/weighted_polynomials.hpp"

namespace scanmill::alpha {

namespace {

/// Rounds outwards while the processor's rounding mode is upwards.
using Interval = CGAL::Interval_nt<false>;

using Corners = std::array<WeightedPoint, 4>;

/// The corners of facet i of a cell, the one with the lowest number first, then the opposite corner.
constexpr std::array<std::array<int, 4>, 4> facet_and_apex{{{1, 2, 3, 0}, {0, 2, 3, 1}, {0, 1, 3, 2}, {0, 1, 2, 3}}};

/// Corners of a cell or facet from their first one, in some number type and in units of 2^exponent.
template <class Number>
class Seen {
public:
    Seen(const WeightedPoint& from, int exponent)
        : from_(from),
          length_(std::ldexp(1.0, -exponent)),
          scaled_(exponent != 0) {}

    Lifted<Number> operator()(const WeightedPoint& corner) const {
        Offset<Number> offset = offsets_from<Number>(*from_.position, *corner.position)[0];
        if (scaled_)
            for (Number& component : offset) component = component * length_;
        return {offset, dot(offset, offset) + scaled(Number(from_.weight) - Number(corner.weight))};
    }
    /// What the first corner's weight lacks to the largest.
    Number lacking(double largest) const { return scaled(Number(largest) - Number(from_.weight)); }

private:
    Number scaled(const Number& weight) const { return scaled_ ? weight * length_ * length_ : weight; }

    const WeightedPoint& from_;
    Number length_;
    bool scaled_;
};

// The three questions, for facets as in facet_and_apex.

template <class Number>
FacetSphere<Number> facet_sphere(const Corners& corners, int facet, const Seen<Number>& seen) {
    const auto& [a, b, c, apex] = facet_and_apex[static_cast<std::size_t>(facet)];
    return {seen(corners[b]), seen(corners[c])};
}
template <class Number>
Fraction<Number> cell_fraction(const Corners& corners, const Seen<Number>& seen, double largest) {
    return cell_squared_radius(seen(corners[1]), seen(corners[2]), seen(corners[3]), seen.lacking(largest));
}

/// So that products of many offsets stay within double's range.
int exponent_of(const Corners& corners) {
    double size = 0;
    for (const WeightedPoint& corner : corners)
        size = std::max({size, largest(offsets_from(*corners[0].position, *corner.position)[0]),
                         std::sqrt(std::abs(corner.weight - corners[0].weight))});
    return exponent_near(size);
}

double quotient(const Fraction<Exact>& fraction, int exponent) {
    return exact_quotient(fraction.numerator, fraction.denominator, exponent);
}

const WeightedPoint& first_of(const Corners& corners, int facet) {
    return corners[static_cast<std::size_t>(facet_and_apex[static_cast<std::size_t>(facet)][0])];
}
const WeightedPoint& apex_of(const Corners& corners, int facet) {
    return corners[static_cast<std::size_t>(facet_and_apex[static_cast<std::size_t>(facet)][3])];
}

bool exactly_attached(const Corners& corners, int facet) {
    const Seen<Exact> seen(first_of(corners, facet), exponent_of(corners));
    return CGAL::sign(facet_sphere(corners, facet, seen).power(seen(apex_of(corners, facet)))) == CGAL::NEGATIVE;
}
double exact_facet_value(const Corners& corners, int facet, double largest) {
    const int exponent = exponent_of(corners);
    const Seen<Exact> seen(first_of(corners, facet), exponent);
    return quotient(facet_sphere(corners, facet, seen).squared_radius(seen.lacking(largest)), exponent);
}
double exact_cell_value(const Corners& corners, double largest) {
    const int exponent = exponent_of(corners);
    return quotient(cell_fraction(corners, Seen<Exact>(corners[0], exponent), largest), exponent);
}

/// Within these no product overflows, nor underflows so far as to matter against the bound.
constexpr double least_size = 1e-45, largest_size = 1e45, largest_lift = 1e100;

/// Whether corner i attaches the facet opposite to it: whether the centre of the cell's sphere lies beyond that facet.
std::array<bool, 4> attachments(const Corners& corners) {
    const Seen<double> seen(corners[0], 0);
    const Lifted<double> u = seen(corners[1]), v = seen(corners[2]), w = seen(corners[3]);
    const Offset<double> vw = cross(v.offset, w.offset), wu = cross(w.offset, u.offset), uv = cross(u.offset, v.offset);
    const Offset<double> centre = circumcentre_numerator(u.lift, v.lift, w.lift, vw, wu, uv);
    const double volume = dot(u.offset, vw);
    const Offset<double> sum{vw[0] + wu[0] + uv[0], vw[1] + wu[1] + uv[1], vw[2] + wu[2] + uv[2]};
    // Barycentric coordinates of the centre, times 2 volume².
    const std::array<double, 4> coordinates{2 * volume * volume - dot(centre, sum), dot(centre, vw), dot(centre, wu),
                                            dot(centre, uv)};
    // With U, V, W short for the offsets' largest components and L for three times their squares plus what the weights
    // differ by, the monomials sum to at most 20 (L_u VW + L_v WU + L_w UV) (VW + WU + UV) in absolute value, and pass
    // at most 23 roundings each, the offsets' included. 20 · 23 · 2^-53 < 5.2e-14.
    const double su = largest(u.offset), sv = largest(v.offset), sw = largest(w.offset);
    const auto most = [&](double size, const WeightedPoint& corner) {
        return 3 * size * size + std::abs(corners[0].weight - corner.weight);
    };
    const double lu = most(su, corners[1]), lv = most(sv, corners[2]), lw = most(sw, corners[3]);
    const bool is_moderate = std::min({su, sv, sw}) > least_size && std::max({su, sv, sw}) < largest_size &&
                             std::max({lu, lv, lw}) < largest_lift;
    const double bound = is_moderate
                             ? 5.5e-14 * ((lu * sv * sw + lv * sw * su + lw * su * sv) * (sv * sw + sw * su + su * sv))
                             : std::numeric_limits<double>::infinity();
    std::array<bool, 4> attached;
    for (int i = 0; i < 4; ++i)
        attached[i] = std::abs(coordinates[i]) > bound ? coordinates[i] < 0 : exactly_attached(corners, i);
    return attached;
}

struct Bounds {
    double low, high;
    /// Narrow enough for a value. Not when a bound is infinite or NaN.
    bool narrow() const { return low > 0 && high - low <= 1e-9 * low; }
    double middle() const { return low + (high - low) / 2; }
};
Bounds bounds(const Interval& interval) { return {interval.inf(), interval.sup()}; }
Bounds bounds(const Fraction<Interval>& fraction) { return bounds(fraction.numerator / fraction.denominator); }

struct CellBounds {
    std::array<Bounds, 4> facets;
    Bounds cell;
};

/// Of the facets in the mask, and of the cell if that is asked for.
CellBounds cell_bounds(const Corners& corners, double largest, unsigned facets, bool with_cell) {
    const CGAL::Protect_FPU_rounding<true> upwards;
    CellBounds result;
    for (unsigned left = facets; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        const Seen<Interval> seen(first_of(corners, i), 0);
        result.facets[i] = bounds(facet_sphere(corners, i, seen).squared_radius(seen.lacking(largest)));
    }
    if (with_cell) result.cell = bounds(cell_fraction(corners, Seen<Interval>(corners[0], 0), largest));
    return result;
}

}  // namespace

CellSpheres weighted_cell_spheres(const std::array<WeightedPoint, 4>& given, double largest, unsigned facets) {
    // Sorted by coordinates, so that the arithmetic does not know the corners' numbers.
    std::array<int, 4> order{0, 1, 2, 3};
    std::ranges::sort(order, [&](int a, int b) {
        const Vec3 &p = *given[a].position, &q = *given[b].position;
        return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    });
    const Corners corners{given[order[0]], given[order[1]], given[order[2]], given[order[3]]};
    unsigned asked = 0;
    for (int i = 0; i < 4; ++i) asked |= (facets >> order[i] & 1u) << i;

    const std::array<bool, 4> attached = attachments(corners);
    const bool any_attached = std::ranges::find(attached, true) != attached.end();
    const CellBounds found = cell_bounds(corners, largest, asked, any_attached);
    double own = 0;
    if (any_attached) own = found.cell.narrow() ? found.cell.middle() : exact_cell_value(corners, largest);
    CellSpheres result{};
    for (int i = 0; i < 4; ++i) {
        double value = 0;
        if ((asked >> i & 1u) != 0)
            value = found.facets[i].narrow() ? found.facets[i].middle() : exact_facet_value(corners, i, largest);
        result.values[order[i]] = attached[i] ? std::max(value, own) : value;
        result.attached |= static_cast<u8>(attached[i] << order[i]);
    }
    return result;
}

}  // namespace scanmill::alpha
