// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/angle.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cassert>
#include <cmath>

namespace scanmill {

namespace {

/// Two numbers that the processor computes with at the same time. Comparisons select values without branches, because
/// such branches cannot be predicted.
using Pair = double __attribute__((vector_size(16)));

/// Sums of two doubles that are not added up; they have about 32 digits.
struct DoubleDouble {
    Pair value, rest;
};

/// The exact sum (Knuth).
DoubleDouble sum_of(Pair a, Pair b) {
    const Pair sum = a + b, part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}

/// The upper 26 bits of the significand (Veltkamp).
Pair upper_half(Pair x) {
    const Pair shifted = 0x8000001p0 * x;
    return shifted - (shifted - x);
}

/// The exact product (Dekker).
DoubleDouble product_of(Pair a, Pair b) {
    const Pair product = a * b, a_high = upper_half(a), a_low = a - a_high, b_high = upper_half(b), b_low = b - b_high;
    return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}
/// The exact product for an `a` of at most 26 bits.
DoubleDouble product_of_short(Pair a, Pair b) {
    const Pair product = a * b, b_high = upper_half(b), b_low = b - b_high;
    return {product, (a * b_high - product) + a * b_low};
}

struct Constant {
    double value, rest;
};
constexpr Constant pi{3.141592653589793, 1.2246467991473532e-16};

/// Entry i: arctan(i / 8).
constexpr std::array<Constant, 9> arctan_of_eighths{{{0.0, 0.0},
                                                     {0.12435499454676144, -3.1253241424539383e-18},
                                                     {0.24497866312686414, 1.0698755618734451e-17},
                                                     {0.35877067027057225, -2.4623815582638635e-17},
                                                     {0.4636476090008061, 2.2698777452961687e-17},
                                                     {0.5585993153435624, -5.4556305485916264e-18},
                                                     {0.6435011087932844, 1.5834785051444286e-17},
                                                     {0.7188299996216245, -2.1478388444456983e-17},
                                                     {0.7853981633974483, 3.061616997868383e-17}}};

/// Computes arctan(low / high) = arctan q + arctan r. Here q is the multiple of 1/8 nearest to low / high, and r = (low
/// - q high) / (high + q low). So |r| ≤ 1/16. The Taylor series of arctan r ends before r^15 / 15, which is below 2^-59
/// r. The terms from r^3 on are below r / 768, so plain doubles are accurate enough for them. Pre: 0 ≤ low ≤ high, high
/// > 0.
DoubleDouble arctan(Pair low, Pair high) {
    const Pair zero{}, one = zero + 1;
    Pair eighths = zero;
    for (const int sixteenths : {1, 3, 5, 7, 9, 11, 13, 15}) eighths += 16 * low > sixteenths * high ? one : zero;
    const Pair q = eighths / 8;
    const DoubleDouble q_high = product_of_short(q, high), q_low = product_of_short(q, low);
    const DoubleDouble above = sum_of(low, -q_high.value), below = sum_of(high, q_low.value);
    const Pair r = above.value / below.value;
    const DoubleDouble product = product_of(r, below.value);
    const Pair r_rest =
        ((above.value - product.value) - product.rest + (above.rest - q_high.rest) - r * (below.rest + q_low.rest)) /
        below.value;
    const Pair square = r * r;
    Pair series = zero;
    for (int degree = 13; degree > 1; degree -= 2) series = 1.0 / degree - series * square;
    const Constant &first = arctan_of_eighths[static_cast<std::size_t>(eighths[0])],
                   &second = arctan_of_eighths[static_cast<std::size_t>(eighths[1])];
    const DoubleDouble at{{first.value, second.value}, {first.rest, second.rest}}, sum = sum_of(at.value, r);
    return {sum.value, sum.rest + (at.rest + (r_rest - r * square * series))};
}

/// `turn` - `angle` where `reflected`, else `angle`.
template <class Mask>
DoubleDouble reflected_where(Mask reflected, const Constant& turn, const DoubleDouble& angle) {
    const Pair zero{}, one = reflected ? zero + 1 : zero, sign = 1 - 2 * one;
    const DoubleDouble sum = sum_of(one * turn.value, sign * angle.value);
    return {sum.value, sum.rest + (one * turn.rest + sign * angle.rest)};
}

Pair angles_of(Pair cosine, Pair sine) {
    const Pair zero{}, adjacent = cosine < zero ? -cosine : cosine;
    const auto is_steep = sine > adjacent;
    const Pair low = is_steep ? adjacent : sine, high = is_steep ? sine : adjacent;
    const auto is_zero = high == zero;
    DoubleDouble angle = arctan(low, is_zero ? zero + 1 : high);
    angle = reflected_where(is_steep, {pi.value / 2, pi.rest / 2}, angle);
    angle = reflected_where(cosine < zero, pi, angle);
    return is_zero ? zero : angle.value + angle.rest;
}

}  // namespace

double angle_of(double cosine, double sine) {
    assert(sine >= 0);
    return angles_of(Pair{cosine, 1}, Pair{sine, 0})[0];
}

double angle_between(const Vec3& a, const Vec3& b) { return angle_of(a.dot(b), a.cross(b).norm()); }

std::array<double, 2> angles_between(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Pair angles = angles_of(Pair{a.dot(b), c.dot(d)}, Pair{a.cross(b).norm(), c.cross(d).norm()});
    return {angles[0], angles[1]};
}

}  // namespace scanmill
