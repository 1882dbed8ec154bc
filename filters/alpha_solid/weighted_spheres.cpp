// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/weighted_spheres.hpp"

#include <CGAL/Interval_nt.h>

#include <cmath>
#include <limits>

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
    return std::ilogb(size);
}

double quotient(const Fraction<Exact>& fraction, int exponent) {
    const double value =
        std::ldexp(CGAL::to_double(fraction.numerator) / CGAL::to_double(fraction.denominator), 2 * exponent);
    return std::isfinite(value) ? value : std::numeric_limits<double>::max();
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

struct Bounds {
    double low, high;
    /// Narrow enough for a value. Not when a bound is infinite or NaN.
    bool narrow() const { return low > 0 && high - low <= 1e-9 * low; }
    double middle() const { return low + (high - low) / 2; }
};
Bounds bounds(const Interval& interval) { return {interval.inf(), interval.sup()}; }
Bounds bounds(const Fraction<Interval>& fraction) { return bounds(fraction.numerator / fraction.denominator); }

struct CellBounds {
    std::array<Bounds, 4> values, powers;
    Bounds cell;
};

CellBounds cell_bounds(const Corners& corners, double largest) {
    const CGAL::Protect_FPU_rounding<true> upwards;
    CellBounds result;
    for (int i = 0; i < 4; ++i) {
        const Seen<Interval> seen(first_of(corners, i), 0);
        const FacetSphere<Interval> sphere = facet_sphere(corners, i, seen);
        result.values[i] = bounds(sphere.squared_radius(seen.lacking(largest)));
        result.powers[i] = bounds(sphere.power(seen(apex_of(corners, i))));
    }
    result.cell = bounds(cell_fraction(corners, Seen<Interval>(corners[0], 0), largest));
    return result;
}

}  // namespace

CellSpheres weighted_cell_spheres(const std::array<WeightedPoint, 4>& given, double largest) {
    // Sorted by coordinates, so that the arithmetic does not know the corners' numbers.
    std::array<int, 4> order{0, 1, 2, 3};
    std::ranges::sort(order, [&](int a, int b) {
        const Vec3 &p = *given[a].position, &q = *given[b].position;
        return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    });
    const Corners corners{given[order[0]], given[order[1]], given[order[2]], given[order[3]]};

    const CellBounds found = cell_bounds(corners, largest);
    CellSpheres result{};
    for (int i = 0; i < 4; ++i) {
        const bool known = found.powers[i].low > 0 || found.powers[i].high < 0;
        const bool attached = known ? found.powers[i].high < 0 : exactly_attached(corners, i);
        double value = found.values[i].narrow() ? found.values[i].middle() : exact_facet_value(corners, i, largest);
        if (attached)
            value = std::max(value, found.cell.narrow() ? found.cell.middle() : exact_cell_value(corners, largest));
        result.values[order[i]] = value;
        result.attached |= static_cast<u8>(attached << order[i]);
    }
    return result;
}

}  // namespace scanmill::alpha
