// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The number type of exact decisions: it holds every double and is closed under + − ×.

#include <CGAL/MP_Float.h>
#include <CGAL/Mpzf.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanmill::alpha {

// Mpzf is faster and needs GMP.
#ifdef CGAL_HAS_MPZF
using Exact = CGAL::Mpzf;
#else
using Exact = CGAL::MP_Float;
#endif

/// mantissa · 2^exponent, the mantissa 0 or far from the ends of double's range.
struct Leading {
    double mantissa;
    int exponent;
};

/// The first digits of a number that may be far beyond double's range either way: products of many lengths, where large
/// and small ones meet in one cell, are.
inline Leading leading(Exact number) {
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

/// numerator / denominator · 4^exponent; what no double holds becomes the largest one. Pre: numerator not negative,
/// denominator above 0.
inline double exact_quotient(const Exact& numerator, const Exact& denominator, int exponent) {
    const Leading n = leading(numerator), d = leading(denominator);
    const double value = std::ldexp(n.mantissa / d.mantissa, n.exponent - d.exponent + 2 * exponent);
    return std::min(value, std::numeric_limits<double>::max());
}

/// The exponent of a power of two that brings a size near 1, and that is a double like its reciprocal.
inline int exponent_near(double size) { return size > 0 ? std::clamp(std::ilogb(size), -1000, 1000) : 0; }

}  // namespace scanmill::alpha
