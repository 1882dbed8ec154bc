// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Medians and quantiles. The result is always one of the values, never a mean of two values.
///
/// Both functions reorder the values. Pre: at least one value, none is NaN. Cost: linear.

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace scanmill {

/// The median. For an even number of values, the larger of the two middle values.
template <class Values>
double median(Values&& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The smallest of the values v for which at least the fraction `share`, from 0 to 1, of all values is ≤ v.
template <class Values>
double quantile(Values&& values, double share) {
    const double rank = std::max(1.0, std::ceil(share * static_cast<double>(values.size())));
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

}  // namespace scanmill
