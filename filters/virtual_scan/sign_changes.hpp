// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the sign changes of a polynomial, by bisection between those of its derivative. This is slower than Ferrari's
/// formulas, but loses no digits.

#include <array>
#include <cmath>
#include <vector>

namespace scanmill::scan {

/// Returns coefficients[0] + coefficients[1] x + …
template <std::size_t Size>
double evaluate(const std::array<double, Size>& coefficients, double x) {
    double value = 0;
    for (std::size_t i = Size; i-- > 0;) value = value * x + coefficients[i];
    return value;
}

/// Returns all x in (low, high] where the polynomial changes its sign, ascending, each to within `width`. Roots without
/// a change of sign are not found. Two sign changes nearer than `width` may be missed, like such a root.
template <std::size_t Size>
std::vector<double> sign_changes(const std::array<double, Size>& coefficients, double low, double high, double width) {
    if constexpr (Size < 2) {
        return {};
    } else {
        std::array<double, Size - 1> derivative;
        for (std::size_t i = 1; i < Size; ++i) derivative[i - 1] = static_cast<double>(i) * coefficients[i];
        std::vector<double> ends = sign_changes(derivative, low, high, width);
        ends.push_back(high);
        std::vector<double> roots;
        double begin = low;
        for (const double end : ends) {  // monotone from begin to end
            double a = begin, b = end;
            const bool negative = evaluate(coefficients, a) < 0;
            if (negative != (evaluate(coefficients, b) < 0)) {
                while (b - a > width) {
                    const double middle = 0.5 * (a + b);
                    ((evaluate(coefficients, middle) < 0) == negative ? a : b) = middle;
                }
                roots.push_back(b);
            }
            begin = end;
        }
        return roots;
    }
}

}  // namespace scanmill::scan
