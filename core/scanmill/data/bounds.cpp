// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/bounds.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

/// The smallest power of two not below `value`. Pre: value > 0. Exact, unlike the C library's log2, whose last bit
/// depends on the processor.
double power_of_two_from(double value) {
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);
    return std::ldexp(1.0, fraction == 0.5 ? exponent - 1 : exponent);
}

}  // namespace

BoundingBox bounding_box(std::span<const Vec3> positions) {
    BoundingBox box;
    for (const Vec3& p : positions) {
        if (p.allFinite()) box.add(p);
    }
    return box;
}

bool is_too_long(const BoundingBox& box) { return !box.empty() && !((box.high - box.low).maxCoeff() <= largest_side); }

void require_supported_range(const BoundingBox& box) {
    if (box.empty()) return;
    const Vec3 sides = box.high - box.low;
    int axis = 0;
    const double side = sides.maxCoeff(&axis);
    if (side == 0 || (side >= least_side && !is_too_long(box))) return;
    throw Error(
        "the longest side of the scan's box is {:.3g} u, from {:.3g} to {:.3g} in {}; supported are {:g} to {:g} u",
        side, box.low[axis], box.high[axis], "xyz"[axis], least_side, largest_side)
        .hint(is_too_long(box) ? "remove stray points, or scale the scan" : "scale the scan to a larger unit");
}

Vec3 distant_origin(const BoundingBox& box) {
    Vec3 origin = Vec3::Zero();
    const double diagonal = box.diagonal();
    if (box.empty() || !box.low.allFinite() || !box.high.allFinite() || !std::isfinite(diagonal)) return origin;
    for (int axis = 0; axis < 3; ++axis) {
        const double middle = 0.5 * box.low[axis] + 0.5 * box.high[axis];
        if (!(std::abs(middle) > distant_diagonals * diagonal)) continue;
        // The origin is a multiple of a power of two, `step`, that is at least as large as the last bit of any
        // coordinate. Coordinates are near the origin, so p - origin has few digits and no bit is lost. The step is a
        // normal number: a step of 0 would make the origin NaN.
        const double last_bit = std::max(std::ldexp(std::abs(middle), -50), std::numeric_limits<double>::min());
        const double step = power_of_two_from(std::max(diagonal, last_bit));
        origin[axis] = std::round(middle / step) * step;
    }
    return origin;
}

void FiniteBounds::add(const FiniteBounds& more) {
    box.low = box.low.cwiseMin(more.box.low);
    box.high = box.high.cwiseMax(more.box.high);
    finite = finite && more.finite;
}

bool FiniteBounds::are_within(const BoundingBox& outer) const {
    return finite && (box.low.array() >= outer.low.array()).all() && (box.high.array() <= outer.high.array()).all();
}

FiniteBounds finite_bounds(std::span<const Vec3> positions) {
    FiniteBounds bounds;
    Vec3 zero = Vec3::Zero();  // NaN after a NaN or infinite coordinate
    for (const Vec3& p : positions) {
        bounds.box.add(p);
        zero += p * 0.0;
    }
    bounds.finite = zero == Vec3::Zero();
    return bounds;
}

}  // namespace scanmill
