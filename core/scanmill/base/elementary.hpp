// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Elementary functions whose bits do not depend on the processor, as those of the C library do: of +, -, *, / and
/// powers of two, which IEEE 754 rounds in exactly one way. Angles: see geometry/spatial/angle.hpp.

#include <cmath>

namespace scanmill::elementary {

/// Pre: x is finite and above 0. Error: a few units in the last place.
inline double log2(double x) {
    int exponent;
    double mantissa = std::frexp(x, &exponent);
    if (mantissa < 0.70710678118654752) mantissa *= 2, --exponent;
    const double ratio = (mantissa - 1) / (mantissa + 1), square = ratio * ratio;
    double sum = 0;  // of ratio^2k / (2k + 1)
    for (int power = 23; power > 0; power -= 2) sum = sum * square + 1.0 / power;
    return exponent + 2.8853900817779268 * ratio * sum;  // 2 / ln 2
}

/// The same for the natural logarithm.
inline double log(double x) { return 0.69314718055994531 * log2(x); }

/// Pre: x is from 0 to π / 4. Error: a few units in the last place.
inline double tan(double x) {
    double fraction = 0;  // Lambert's: x² / (3 - x² / (5 - …
    for (int odd = 19; odd > 1; odd -= 2) fraction = x * x / (odd - fraction);
    return x / (1 - fraction);
}

}  // namespace scanmill::elementary
