// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/finite_bounds.hpp"

namespace scanmill {

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
    Vec3 zero = Vec3::Zero();  // unless some x * 0 is NaN
    for (const Vec3& p : positions) {
        bounds.box.low = bounds.box.low.cwiseMin(p);
        bounds.box.high = bounds.box.high.cwiseMax(p);
        zero += p * 0.0;
    }
    bounds.finite = zero == Vec3::Zero();
    return bounds;
}

}  // namespace scanmill
