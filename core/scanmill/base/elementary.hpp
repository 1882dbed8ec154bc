// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Elementary functions whose bits depend neither on the processor nor on the C library.
///
/// The C library selects variants of sin, exp and similar functions for each processor; their last bits differ. These
/// functions consist of +, -, *, / and powers of two, which IEEE 754 rounds in exactly one way. (All of Scanmill is
/// compiled with -ffp-contract=off.) Arctangents are in geometry/spatial/angle.hpp.

#include <cmath>
#include <numbers>

namespace scanmill::elementary {

/// Parts of the logarithm to any base b: log_b x = exponent log_b 2 + 2 ratio sum / ln b. The series of the inverse
/// hyperbolic tangent, artanh(ratio), is ratio sum.
struct LogarithmParts {
    int exponent;
    double ratio, sum;
};
inline LogarithmParts logarithm_parts(double x) {
    int exponent;
    double mantissa = std::frexp(x, &exponent);
    if (mantissa < 1 / std::numbers::sqrt2) mantissa *= 2, --exponent;
    const double ratio = (mantissa - 1) / (mantissa + 1), square = ratio * ratio;
    double sum = 0;  // sum of ratio^2k / (2k + 1)
    for (int power = 23; power > 0; power -= 2) sum = sum * square + 1.0 / power;
    return {exponent, ratio, sum};
}

/// Pre: x is finite and above 0. Error: at most 4 units in the last place or 2^-53, whichever is larger. Logarithms of
/// powers of two are exact.
inline double log2(double x) {
    const auto [exponent, ratio, sum] = logarithm_parts(x);
    return exponent + 2 / std::numbers::ln2 * ratio * sum;
}

/// The natural logarithm. Pre and error as for log2(), but logarithms of powers of two are not exact.
inline double log(double x) {
    const auto [exponent, ratio, sum] = logarithm_parts(x);
    return exponent * std::numbers::ln2 + 2 * ratio * sum;
}

/// Pre: x is finite and above 0; 2^-1022 ≤ x^power < 2^1023.
/// Error: at most 4 + 4 |log2 x^power| units in the last place.
inline double pow(double x, double power) {
    const double exponent = power * log2(x), whole = std::nearbyint(exponent);
    const double rest = std::numbers::ln2 * (exponent - whole);
    double sum = 1;  // sum of rest^k / k!
    for (int k = 18; k > 0; --k) sum = 1 + sum * rest / k;
    return std::ldexp(sum, static_cast<int>(whole));
}

struct Turn {
    double cosine, sine;
};
/// Cosine and sine of an angle in radians. Pre: |angle| ≤ 3.9, an eighth of a turn beyond π. Error: at most 2 units in
/// the last place. The results for angle 0 are exact.
inline Turn turn_of(double angle) {
    // A quarter turn is the sum of two numbers, so that the remainder x keeps its digits.
    constexpr double quarter = 1.5707963267948966, quarter_rest = 6.123233995736766e-17;
    const double quarters = std::floor(angle / quarter + 0.5);
    const double x = (angle - quarters * quarter) - quarters * quarter_rest, square = x * x;
    double sine = 0, cosine = 0;  // Taylor series; the terms left out are below 1e-19 for |x| ≤ π/4
    for (int degree = 19; degree > 1; degree -= 2) {
        sine = (1 - sine) * square / (degree * (degree - 1));
        cosine = (1 - cosine) * square / ((degree - 1) * (degree - 2 > 0 ? degree - 2 : 1));
    }
    sine = x * (1 - sine);
    cosine = 1 - cosine;
    switch (static_cast<int>(quarters - 4 * std::floor(quarters / 4))) {
        case 0: return {cosine, sine};
        case 1: return {-sine, cosine};
        case 2: return {-cosine, -sine};
        default: return {sine, -cosine};
    }
}

}  // namespace scanmill::elementary
