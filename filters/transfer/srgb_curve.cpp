// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/srgb_curve.hpp"

#include <algorithm>

#include "scanmill/base/elementary.hpp"

namespace scanmill::transferring {

namespace {

double linear_light(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : elementary::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace

SrgbCurve::SrgbCurve(u32 levels) : linear_(levels), limits_(levels - 1) {
    for (u32 code = 0; code < levels; ++code) linear_[code] = linear_light(code / (levels - 1.0));
    for (u32 code = 0; code + 1 < levels; ++code) limits_[code] = linear_light((code + 0.5) / (levels - 1.0));
}

u32 SrgbCurve::code(double linear) const {
    return static_cast<u32>(std::ranges::upper_bound(limits_, linear) - limits_.begin());
}

}  // namespace scanmill::transferring
