// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Powers of two that bring lengths near 1, so that their squares are numbers. Multiplying by one changes no digit.

#include <algorithm>
#include <cmath>

namespace scanmill {

/// Brings `length` to at least 1 and below 2; a subnormal one less far, for 2^1023 is the largest there is. Pre:
/// finite, above 0.
inline double unit_scale(double length) { return std::ldexp(1.0, std::min(1023, -std::ilogb(length))); }

}  // namespace scanmill
