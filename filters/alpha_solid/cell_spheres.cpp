// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "alpha_solid/facet_values.hpp"
#include "alpha_solid/sphere_polynomials.hpp"

namespace scanmill::alpha {

namespace {

/// A double result is accepted where cancellation has left at least this share of the terms, squared; the rest is
/// computed exactly.
constexpr double squared_share = 1e-12;

/// Within these sizes no intermediate overflows, nor underflows so far as to matter against the bounds.
constexpr double least_size = 1e-45, largest_size = 1e45;
bool is_moderate(double least_square, double largest_square) {
    return least_square > least_size * least_size && largest_square < largest_size * largest_size;
}

bool tie_broken_less(const Vec3& a, const Vec3& b) { return a.y() != b.y() ? a.y() < b.y() : a.z() < b.z(); }

/// A corner and its number, so that sorting by coordinates moves both.
struct Corner {
    const Vec3* position;
    u32 number;
};

/// Sorts two corners by coordinates, without a branch but for equal x.
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
    if (normal_squared > squared_share * product && is_moderate(std::min(uu, vv), std::max(uu, vv)))
        return product * dot(third, third) / (4 * normal_squared);
    return exact_squared_circumradius(a, b, c);
}

/// The cell in sorted corners a, b, c, d with offsets u, v, w from a.
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

    /// Opposite to a, b, c, d.
    std::array<double, 4> facet_values() const {
        const auto [cb, db] = offsets_from(b_, c_, d_);
        return {facet_value(cb, db, dot(cb, cb), dot(db, db), cross(cb, db), b_, c_, d_),
                facet_value(v_, w_, vv_, ww_, vw_, a_, c_, d_), facet_value(u_, w_, uu_, ww_, wu_, a_, b_, d_),
                facet_value(u_, v_, uu_, vv_, uv_, a_, b_, c_)};
    }

    double squared_radius() const {
        const double numerator = dot(centre_, centre_), denominator = volume_ * volume_, product = uu_ * vv_ * ww_;
        if (denominator > squared_share * product && numerator > 3 * squared_share * (product * (uu_ + vv_ + ww_)) &&
            is_moderate(std::min({uu_, vv_, ww_}), std::max({uu_, vv_, ww_})))
            return numerator / (4 * denominator);
        return exact_squared_circumradius(a_, b_, c_, d_);
    }

    /// Which of a, b, c, d lie inside the smallest sphere round the facet opposite to them.
    std::array<bool, 4> attached() const {
        // Barycentric coordinates of the circumcentre, times 2 volume². With u, v, w short for the offsets' largest
        // components: the monomials of the last three sum to at most 36 uvw (u + v + w) times vw, wu or uv in absolute
        // value, and pass at most 19 roundings each, the offsets' included; those of the first to at most
        // 44 uvw (u + v + w) (vw + wu + uv) and 22 roundings. 22 · 44 · 2^-53 < 1.1e-13 covers all four.
        const double u = largest(u_), v = largest(v_), w = largest(w_);
        const double bound = std::min({u, v, w}) > least_size && std::max({u, v, w}) < largest_size
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
        return exact_smallest_sphere_sign(*all[(corner + 1) % 4], *all[(corner + 2) % 4], *all[(corner + 3) % 4],
                                          *all[corner]) < 0;
    }

    const Vec3 &a_, &b_, &c_, &d_;
    Offset<double> u_, v_, w_;
    double uu_, vv_, ww_;
    Offset<double> vw_, wu_, uv_;
    double volume_;
    Offset<double> centre_;
};

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
    std::array<Corner, 4> corners{{{&p, 0}, {&q, 1}, {&r, 2}, {&s, 3}}};
    auto& [a, b, c, d] = corners;
    order(a, b);
    order(c, d);
    order(a, c);
    order(b, d);
    order(b, c);

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

}  // namespace scanmill::alpha
