// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The middle of some numbers.

#include <algorithm>
#include <iterator>

namespace scanmill::growing {

/// The upper one of two middles; reorders the values. Pre: at least one, none NaN. Cost: linear.
template <class Values>
double median(Values& values) {
    const auto middle = std::next(values.begin(), static_cast<std::ptrdiff_t>(values.size() / 2));
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace scanmill::growing
