// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/circumspheres.hpp"

#include <CGAL/Interval_nt.h>
#include <CGAL/MP_Float.h>
#include <CGAL/Mpzf.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/geometry/tets/sphere_polynomials.hpp"

namespace scanmill {

namespace {

using namespace spheres;

/// Offsets as short as this occur only between near-duplicates. Products of shorter offsets could underflow, which the
/// error bounds below do not cover.
constexpr double least_size = 1e-45;

// Exact arithmetic, for the few cases that doubles cannot decide; a thousand times slower.

/// A number type that holds every double and is closed under + − ×. Mpzf is faster and needs GMP.
#ifdef CGAL_HAS_MPZF
using Exact = CGAL::Mpzf;
#else
using Exact = CGAL::MP_Float;
#endif

/// The number mantissa · 2^exponent. The mantissa is 0 or far from the ends of double's range.
struct Leading {
    double mantissa;
    int exponent;
};

/// The first digits of a number. Products of many lengths can lie far outside double's range if one cell has short and
/// long offsets.
Leading leading(Exact number) {
    constexpr int step = 512;
    Leading result{CGAL::to_double(number), 0};
    if (CGAL::sign(number) == CGAL::ZERO) return {0, 0};
    while (!(std::abs(result.mantissa) > 1e-150 && std::abs(result.mantissa) < 1e150)) {
        const int shift = std::abs(result.mantissa) < 1 ? step : -step;
        number = number * Exact(std::ldexp(1.0, shift));
        result = {CGAL::to_double(number), result.exponent - shift};
    }
    return result;
}

/// numerator / denominator · 4^exponent; at most the largest double. Pre: numerator not negative, denominator above 0.
double exact_quotient(const Exact& numerator, const Exact& denominator, int exponent) {
    const Leading n = leading(numerator), d = leading(denominator);
    const double value = std::ldexp(n.mantissa / d.mantissa, n.exponent - d.exponent + 2 * exponent);
    return std::min(value, std::numeric_limits<double>::max());
}

/// numerator / denominator · 2^exponent, within the range of double. Pre: the denominator is not 0.
double exact_ratio(const Exact& numerator, const Exact& denominator, int exponent) {
    const Leading n = leading(numerator), d = leading(denominator);
    constexpr double most = std::numeric_limits<double>::max();
    return std::clamp(std::ldexp(n.mantissa / d.mantissa, n.exponent - d.exponent + exponent), -most, most);
}

/// The exponent of a power of two that brings a size near 1. The reciprocal of that power is a double.
int exponent_near(double size) { return size > 0 ? std::max(std::ilogb(size), -1000) : 0; }

/// Divides the offsets by the power of two near their size. Returns its exponent.
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

double exact_squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    Offsets<Exact, 3> offsets = offsets_from<Exact>(a, b, c, d);
    const int exponent = normalise(offsets);
    const auto& [u, v, w] = offsets;
    const Offset<Exact> vw = cross(v, w);
    const Exact determinant = dot(u, vw);
    const Offset<Exact> centre = circumcentre_numerator(dot(u, u), dot(v, v), dot(w, w), vw, cross(w, u), cross(u, v));
    return exact_quotient(dot(centre, centre), Exact(4) * determinant * determinant, exponent);
}

/// The offset of the circumcentre from a.
Vec3 exact_centre_offset(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    Offsets<Exact, 3> offsets = offsets_from<Exact>(a, b, c, d);
    const int exponent = normalise(offsets);
    const auto& [u, v, w] = offsets;
    const Offset<Exact> vw = cross(v, w);
    const Exact twice = Exact(2) * dot(u, vw);
    const Offset<Exact> centre = circumcentre_numerator(dot(u, u), dot(v, v), dot(w, w), vw, cross(w, u), cross(u, v));
    return {exact_ratio(centre[0], twice, exponent), exact_ratio(centre[1], twice, exponent),
            exact_ratio(centre[2], twice, exponent)};
}

double exact_squared_circumradius(const Vec3& a, const Vec3& b, const Vec3& c) {
    Offsets<Exact, 2> offsets = offsets_from<Exact>(a, b, c);
    const int exponent = normalise(offsets);
    const auto& [u, v] = offsets;
    const Offset<Exact> normal = cross(u, v), third = minus(v, u);
    return exact_quotient(dot(u, u) * dot(v, v) * dot(third, third), Exact(4) * dot(normal, normal), exponent);
}

/// Whether d is strictly inside the smallest sphere through a, b, c.
bool exactly_inside(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return CGAL::sign(smallest_sphere_power(offsets_from<Exact>(a, b, c, d))) == CGAL::NEGATIVE;
}

// Without weights.

/// A result in doubles is accepted if cancellation leaves at least this share of the terms; both are squared. Other
/// results are computed exactly.
constexpr double squared_share = 1e-12;

bool can_underflow(double least_square) { return !(least_square > least_size * least_size); }

bool tie_broken_less(const Vec3& a, const Vec3& b) { return a.y() != b.y() ? a.y() < b.y() : a.z() < b.z(); }

/// A corner and its number, so that sorting by coordinates moves both.
struct Corner {
    const Vec3* position;
    u32 number;
};

/// Sorts two corners by coordinates. Branches only if their x are equal.
void order(Corner& a, Corner& b) {
    const double ax = a.position->x(), bx = b.position->x();
    const bool swap = ax == bx ? tie_broken_less(*b.position, *a.position) : bx < ax;
    const Corner low = swap ? b : a, high = swap ? a : b;
    a = low;
    b = high;
}

/// The squared circumradius of the triangle with these offsets from its first corner a; `normal` is u×v.
double facet_value(const Offset<double>& u, const Offset<double>& v, double uu, double vv, const Offset<double>& normal,
                   const Vec3& a, const Vec3& b, const Vec3& c) {
    const Offset<double> third = minus(v, u);
    const double normal_squared = dot(normal, normal), product = uu * vv;
    if (normal_squared > squared_share * product && !can_underflow(std::min(uu, vv)))
        return product * dot(third, third) / (4 * normal_squared);
    return exact_squared_circumradius(a, b, c);
}

/// A cell with sorted corners a, b, c, d. The offsets of b, c and d from a are u, v and w.
class SortedCell {
public:
    explicit SortedCell(const std::array<Corner, 4>& corners)
        : a_(*corners[0].position),
          b_(*corners[1].position),
          c_(*corners[2].position),
          d_(*corners[3].position) {
        const Offsets<double, 3> offsets = offsets_from(a_, b_, c_, d_);
        u_ = offsets[0];
        v_ = offsets[1];
        w_ = offsets[2];
        uu_ = dot(u_, u_);
        vv_ = dot(v_, v_);
        ww_ = dot(w_, w_);
        vw_ = cross(v_, w_);
        wu_ = cross(w_, u_);
        uv_ = cross(u_, v_);
        volume_ = dot(u_, vw_);
        centre_ = circumcentre_numerator(uu_, vv_, ww_, vw_, wu_, uv_);
    }

    /// The squared circumradii of the facets opposite to a, b, c, d.
    std::array<double, 4> facet_values() const {
        const auto [cb, db] = offsets_from(b_, c_, d_);
        return {facet_value(cb, db, dot(cb, cb), dot(db, db), cross(cb, db), b_, c_, d_),
                facet_value(v_, w_, vv_, ww_, vw_, a_, c_, d_), facet_value(u_, w_, uu_, ww_, wu_, a_, b_, d_),
                facet_value(u_, v_, uu_, vv_, uv_, a_, b_, c_)};
    }

    double squared_radius() const {
        const double numerator = dot(centre_, centre_), denominator = volume_ * volume_, product = uu_ * vv_ * ww_;
        if (denominator > squared_share * product && numerator > 3 * squared_share * (product * (uu_ + vv_ + ww_)) &&
            !can_underflow(std::min({uu_, vv_, ww_})))
            return numerator / (4 * denominator);
        return exact_squared_circumradius(a_, b_, c_, d_);
    }

    Vec3 circumcentre() const {
        // Let U, V, W be the lengths of the offsets and R the circumradius. The numerator's error is below 10 · 2^-53
        // UVW (U + V + W) per coordinate, the volume's below 8 · 2^-53 UVW. With a volume above 1e-6 UVW, and U, V, W
        // at most 2R, the centre's error is below 1e-8 R.
        if (volume_ * volume_ > squared_share * (uu_ * vv_ * ww_) && !can_underflow(std::min({uu_, vv_, ww_})))
            return a_ + Vec3(centre_[0], centre_[1], centre_[2]) / (2 * volume_);
        return a_ + exact_centre_offset(a_, b_, c_, d_);
    }

    /// For a, b, c, d: whether the corner lies inside the smallest sphere around the facet opposite to it.
    std::array<bool, 4> attached() const {
        // Barycentric coordinates of the circumcentre, times 2 volume². Let u, v, w be the largest components of the
        // offsets. In each of the last three coordinates, the absolute values of the monomials sum to at most 36 uvw (u
        // + v + w) times vw, wu or uv. Each monomial has at most 19 roundings, including those of the offsets. In the
        // first coordinate, they sum to at most 44 uvw (u + v + w) (vw + wu + uv), with at most 22 roundings. 22 · 44 ·
        // 2^-53 < 1.1e-13 covers all four coordinates.
        const double u = largest(u_), v = largest(v_), w = largest(w_);
        const double bound = std::min({u, v, w}) > least_size
                                 ? 1.1e-13 * (u * v * w * (u + v + w) * (v * w + w * u + u * v))
                                 : std::numeric_limits<double>::infinity();
        const Offset<double> sum{vw_[0] + wu_[0] + uv_[0], vw_[1] + wu_[1] + uv_[1], vw_[2] + wu_[2] + uv_[2]};
        const std::array<double, 4> coordinates{2 * volume_ * volume_ - dot(centre_, sum), dot(centre_, vw_),
                                                dot(centre_, wu_), dot(centre_, uv_)};
        std::array<bool, 4> result;
        for (int i = 0; i < 4; ++i)
            result[i] = std::abs(coordinates[i]) > bound ? coordinates[i] < 0 : exactly_attached(i);
        return result;
    }

private:
    bool exactly_attached(int corner) const {
        const std::array<const Vec3*, 4> all{&a_, &b_, &c_, &d_};
        return exactly_inside(*all[(corner + 1) % 4], *all[(corner + 2) % 4], *all[(corner + 3) % 4], *all[corner]);
    }

    const Vec3 &a_, &b_, &c_, &d_;
    Offset<double> u_, v_, w_;
    double uu_, vv_, ww_;
    Offset<double> vw_, wu_, uv_;
    double volume_;
    Offset<double> centre_;
};

// With weights.

/// An interval that rounds outwards while the processor's rounding mode is upwards.
using Interval = CGAL::Interval_nt<false>;

using WeightedCorners = std::array<WeightedPoint, 4>;

/// For facet i of a cell: its three corners, ascending, then the opposite corner.
constexpr std::array<std::array<int, 4>, 4> facet_and_apex{{{1, 2, 3, 0}, {0, 2, 3, 1}, {0, 1, 3, 2}, {0, 1, 2, 3}}};

/// Corners of a cell or facet relative to their first one, in some number type and in units of 2^exponent.
template <class Number>
class RelativeTo {
public:
    RelativeTo(const WeightedPoint& from, int exponent)
        : from_(from),
          length_(std::ldexp(1.0, -exponent)),
          scaled_(exponent != 0) {}

    Lifted<Number> operator()(const WeightedPoint& corner) const {
        Offset<Number> offset = offsets_from<Number>(*from_.position, *corner.position)[0];
        if (scaled_)
            for (Number& component : offset) component = component * length_;
        return {offset, dot(offset, offset) + scaled(Number(from_.weight) - Number(corner.weight))};
    }
    /// The amount by which the first corner's weight is below the largest.
    Number deficit(double largest) const { return scaled(Number(largest) - Number(from_.weight)); }

private:
    Number scaled(const Number& weight) const { return scaled_ ? weight * length_ * length_ : weight; }

    const WeightedPoint& from_;
    Number length_;
    bool scaled_;
};

// Facets are numbered as in facet_and_apex.

template <class Number>
FacetSphere<Number> facet_sphere(const WeightedCorners& corners, int facet, const RelativeTo<Number>& relative) {
    const auto& [a, b, c, apex] = facet_and_apex[static_cast<std::size_t>(facet)];
    return {relative(corners[b]), relative(corners[c])};
}
template <class Number>
Fraction<Number> cell_fraction(const WeightedCorners& corners, const RelativeTo<Number>& relative, double largest) {
    return cell_squared_radius(relative(corners[1]), relative(corners[2]), relative(corners[3]),
                               relative.deficit(largest));
}

int exponent_of(const WeightedCorners& corners) {
    double size = 0;
    for (const WeightedPoint& corner : corners)
        size = std::max({size, largest(offsets_from(*corners[0].position, *corner.position)[0]),
                         std::sqrt(std::abs(corner.weight - corners[0].weight))});
    return exponent_near(size);
}

double quotient(const Fraction<Exact>& fraction, int exponent) {
    return exact_quotient(fraction.numerator, fraction.denominator, exponent);
}

const WeightedPoint& first_of(const WeightedCorners& corners, int facet) {
    return corners[static_cast<std::size_t>(facet_and_apex[static_cast<std::size_t>(facet)][0])];
}
const WeightedPoint& apex_of(const WeightedCorners& corners, int facet) {
    return corners[static_cast<std::size_t>(facet_and_apex[static_cast<std::size_t>(facet)][3])];
}

bool exactly_attached(const WeightedCorners& corners, int facet) {
    const RelativeTo<Exact> relative(first_of(corners, facet), exponent_of(corners));
    return CGAL::sign(facet_sphere(corners, facet, relative).power(relative(apex_of(corners, facet)))) ==
           CGAL::NEGATIVE;
}
double exact_facet_value(const WeightedCorners& corners, int facet, double largest) {
    const int exponent = exponent_of(corners);
    const RelativeTo<Exact> relative(first_of(corners, facet), exponent);
    return quotient(facet_sphere(corners, facet, relative).squared_radius(relative.deficit(largest)), exponent);
}
double exact_cell_value(const WeightedCorners& corners, double largest) {
    const int exponent = exponent_of(corners);
    return quotient(cell_fraction(corners, RelativeTo<Exact>(corners[0], exponent), largest), exponent);
}

/// For each corner: whether it attaches the facet opposite to it. It does if the centre of the cell's sphere lies
/// beyond that facet.
std::array<bool, 4> attachments(const WeightedCorners& corners) {
    const RelativeTo<double> relative(corners[0], 0);
    const Lifted<double> u = relative(corners[1]), v = relative(corners[2]), w = relative(corners[3]);
    const Offset<double> vw = cross(v.offset, w.offset), wu = cross(w.offset, u.offset), uv = cross(u.offset, v.offset);
    const Offset<double> centre = circumcentre_numerator(u.lift, v.lift, w.lift, vw, wu, uv);
    const double volume = dot(u.offset, vw);
    const Offset<double> sum{vw[0] + wu[0] + uv[0], vw[1] + wu[1] + uv[1], vw[2] + wu[2] + uv[2]};
    // Barycentric coordinates of the centre, times 2 volume².
    const std::array<double, 4> coordinates{2 * volume * volume - dot(centre, sum), dot(centre, vw), dot(centre, wu),
                                            dot(centre, uv)};
    // Let U, V, W be the largest components of the offsets. L_u, L_v, L_w are three times the squares of these plus the
    // absolute difference of the weights. The absolute values of the monomials sum to at most 20 (L_u VW + L_v WU + L_w
    // UV) (VW + WU + UV). Each monomial has at most 23 roundings, including those of the offsets. 20 · 23 · 2^-53 <
    // 5.2e-14.
    const double su = largest(u.offset), sv = largest(v.offset), sw = largest(w.offset);
    const auto most = [&](double size, const WeightedPoint& corner) {
        return 3 * size * size + std::abs(corners[0].weight - corner.weight);
    };
    const double lu = most(su, corners[1]), lv = most(sv, corners[2]), lw = most(sw, corners[3]);
    const double bound = std::min({su, sv, sw}) > least_size
                             ? 5.5e-14 * ((lu * sv * sw + lv * sw * su + lw * su * sv) * (sv * sw + sw * su + su * sv))
                             : std::numeric_limits<double>::infinity();
    std::array<bool, 4> attached;
    for (int i = 0; i < 4; ++i)
        attached[i] = std::abs(coordinates[i]) > bound ? coordinates[i] < 0 : exactly_attached(corners, i);
    return attached;
}

struct Bounds {
    double low, high;
    /// Whether the bounds are close enough together to give a value. False if a bound is infinite or NaN.
    bool narrow() const { return low > 0 && high - low <= 1e-9 * low; }
    double middle() const { return low + (high - low) / 2; }
};
Bounds bounds(const Interval& interval) { return {interval.inf(), interval.sup()}; }
Bounds bounds(const Fraction<Interval>& fraction) { return bounds(fraction.numerator / fraction.denominator); }

struct CellBounds {
    std::array<Bounds, 4> facets;
    Bounds cell;
};

/// Bounds for the facets in the mask, and for the cell if `with_cell`.
CellBounds cell_bounds(const WeightedCorners& corners, double largest, unsigned facets, bool with_cell) {
    const CGAL::Protect_FPU_rounding<true> upwards;
    CellBounds result;
    for (unsigned left = facets; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        const RelativeTo<Interval> relative(first_of(corners, i), 0);
        result.facets[i] = bounds(facet_sphere(corners, i, relative).squared_radius(relative.deficit(largest)));
    }
    if (with_cell) result.cell = bounds(cell_fraction(corners, RelativeTo<Interval>(corners[0], 0), largest));
    return result;
}

std::array<Corner, 4> sorted(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    std::array<Corner, 4> corners{{{&p, 0}, {&q, 1}, {&r, 2}, {&s, 3}}};
    auto& [a, b, c, d] = corners;
    order(a, b);
    order(c, d);
    order(a, c);
    order(b, d);
    order(b, c);
    return corners;
}

}  // namespace

double squared_circumradius(const Vec3& p, const Vec3& q, const Vec3& r) {
    Corner a{&p, 0}, b{&q, 1}, c{&r, 2};
    order(a, b);
    order(b, c);
    order(a, b);
    const auto [u, v] = offsets_from(*a.position, *b.position, *c.position);
    return facet_value(u, v, dot(u, u), dot(v, v), cross(u, v), *a.position, *b.position, *c.position);
}

CellSpheres cell_spheres(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    const std::array<Corner, 4> corners = sorted(p, q, r, s);
    const SortedCell cell(corners);
    const std::array<double, 4> values = cell.facet_values();
    const std::array<bool, 4> attached = cell.attached();
    double own = 0;
    if (attached[0] || attached[1] || attached[2] || attached[3]) own = cell.squared_radius();
    CellSpheres result{};
    for (int i = 0; i < 4; ++i) {
        result.values[corners[i].number] = attached[i] ? std::max(values[i], own) : values[i];
        result.attached |= static_cast<u8>(attached[i] << corners[i].number);
    }
    return result;
}

Vec3 circumcentre(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return SortedCell(sorted(a, b, c, d)).circumcentre();
}

Array<Vec3> circumcentres(const TetMesh& tets, Execution& execution) {
    constexpr std::size_t chunk = 1 << 14;
    Array<Vec3> centres(tets.cells.size());
    for_each_chunk(execution.threads(), centres.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t cell = begin; cell < end; ++cell) {
            const auto& [a, b, c, d] = tets.cells[cell];
            const auto& p = tets.positions;
            centres[cell] = circumcentre(p[a], p[b], p[c], p[d]);
        }
    });
    return centres;
}

CellSpheres weighted_cell_spheres(const std::array<WeightedPoint, 4>& given, double largest, unsigned facets) {
    // The corners are sorted by coordinates, so that the result does not depend on their numbers.
    std::array<int, 4> by_position{0, 1, 2, 3};
    std::ranges::sort(by_position, is_lower, [&](int i) -> const Vec3& { return *given[i].position; });
    const WeightedCorners corners{given[by_position[0]], given[by_position[1]], given[by_position[2]],
                                  given[by_position[3]]};
    unsigned requested = 0;
    for (int i = 0; i < 4; ++i) requested |= (facets >> by_position[i] & 1u) << i;

    const std::array<bool, 4> attached = attachments(corners);
    const bool any_attached = std::ranges::find(attached, true) != attached.end();
    const CellBounds found = cell_bounds(corners, largest, requested, any_attached);
    double own = 0;
    if (any_attached) own = found.cell.narrow() ? found.cell.middle() : exact_cell_value(corners, largest);
    CellSpheres result{};
    for (int i = 0; i < 4; ++i) {
        double value = 0;
        if ((requested >> i & 1u) != 0)
            value = found.facets[i].narrow() ? found.facets[i].middle() : exact_facet_value(corners, i, largest);
        result.values[by_position[i]] = attached[i] ? std::max(value, own) : value;
        result.attached |= static_cast<u8>(attached[i] << by_position[i]);
    }
    return result;
}

}  // namespace scanmill
