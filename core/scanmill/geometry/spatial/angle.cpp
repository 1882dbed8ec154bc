// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/angle.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cassert>
#include <cmath>

namespace scanmill {

namespace {

/// The unevaluated sum of two doubles: about 32 digits.
struct DoubleDouble {
    double value, rest;
};

/// Exact (Knuth).
DoubleDouble sum_of(double a, double b) {
    const double sum = a + b, part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}

/// Exact (Dekker, Veltkamp).
DoubleDouble product_of(double a, double b) {
    const auto upper_half = [](double x) {
        const double shifted = 0x8000001p0 * x;
        return shifted - (shifted - x);
    };
    const double product = a * b, a_high = upper_half(a), a_low = a - a_high, b_high = upper_half(b),
                 b_low = b - b_high;
    return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

constexpr DoubleDouble pi{3.141592653589793, 1.2246467991473532e-16};

/// Entry i: arctan(i / 8).
constexpr std::array<DoubleDouble, 9> arctan_of_eighths{{{0.0, 0.0},
                                                         {0.12435499454676144, -3.1253241424539383e-18},
                                                         {0.24497866312686414, 1.0698755618734451e-17},
                                                         {0.35877067027057225, -2.4623815582638635e-17},
                                                         {0.4636476090008061, 2.2698777452961687e-17},
                                                         {0.5585993153435624, -5.4556305485916264e-18},
                                                         {0.6435011087932844, 1.5834785051444286e-17},
                                                         {0.7188299996216245, -2.1478388444456983e-17},
                                                         {0.7853981633974483, 3.061616997868383e-17}}};

/// arctan(low / high) = arctan q + arctan r with the multiple q of 1/8 nearest to low / high and
/// r = (low - q high) / (high + q low). As |r| ≤ 1/16, r^15 / 15, the first term of the Taylor series of arctan r that
/// is left out, is below 2^-59 r. The terms from r^3 on are below r / 768: plain doubles suffice for them.
/// Pre: 0 ≤ low ≤ high, high > 0.
DoubleDouble arctan(double low, double high) {
    std::size_t eighths = 0;
    for (const int sixteenths : {1, 3, 5, 7, 9, 11, 13, 15}) eighths += 16 * low > sixteenths * high;
    const double q = static_cast<double>(eighths) / 8;
    const DoubleDouble q_high = product_of(q, high), q_low = product_of(q, low);
    const DoubleDouble above = sum_of(low, -q_high.value), below = sum_of(high, q_low.value);
    const double r = above.value / below.value;
    const DoubleDouble product = product_of(r, below.value);
    const double r_rest =
        ((above.value - product.value) - product.rest + (above.rest - q_high.rest) - r * (below.rest + q_low.rest)) /
        below.value;
    const double square = r * r;
    double series = 0;
    for (int degree = 13; degree > 1; degree -= 2) series = 1.0 / degree - series * square;
    const DoubleDouble& at = arctan_of_eighths[eighths];
    const DoubleDouble sum = sum_of(at.value, r);
    return {sum.value, sum.rest + (at.rest + (r_rest - r * square * series))};
}

DoubleDouble difference(double value, double rest, const DoubleDouble& less) {
    const DoubleDouble sum = sum_of(value, -less.value);
    return {sum.value, sum.rest + (rest - less.rest)};
}

}  // namespace

double angle_of(double cosine, double sine) {
    assert(sine >= 0);
    const double adjacent = std::abs(cosine);
    const bool is_steep = sine > adjacent;
    const double low = is_steep ? adjacent : sine, high = is_steep ? sine : adjacent;
    if (high == 0) return 0;
    DoubleDouble angle = arctan(low, high);
    if (is_steep) angle = difference(pi.value / 2, pi.rest / 2, angle);
    if (cosine < 0) angle = difference(pi.value, pi.rest, angle);
    return angle.value + angle.rest;
}

double angle_between(const Vec3& a, const Vec3& b) { return angle_of(a.dot(b), a.cross(b).norm()); }

}  // namespace scanmill
