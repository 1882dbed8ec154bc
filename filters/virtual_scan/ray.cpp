// SPDX-License-Identifier: GPL-3.0-or-later
#include "virtual_scan/ray.hpp"

#include <algorithm>
#include <limits>

namespace scanmill::scan {

std::optional<Passage> passage_through(const Ray& ray, const BoundingBox& box) {
    double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
    Vec3 normal = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
        const double speed = ray.direction[axis];
        if (speed == 0) {
            if (ray.start[axis] < box.low[axis] || ray.start[axis] > box.high[axis]) return {};
            continue;
        }
        const double near = ((speed > 0 ? box.low : box.high)[axis] - ray.start[axis]) / speed;
        const double far = ((speed > 0 ? box.high : box.low)[axis] - ray.start[axis]) / speed;
        if (near > enter) {
            enter = near;
            normal = Vec3::Zero();
            normal[axis] = speed > 0 ? -1 : 1;
        }
        leave = std::min(leave, far);
    }
    if (!(enter <= leave)) return {};
    return Passage{enter, leave, normal};
}

Hit entry_of(const Ray& ray, const BoundingBox& box, const Passage& passage) {
    const auto outwards = passage.normal.array();
    const Vec3 within = ray.at(passage.enter);
    return {(outwards > 0).select(box.high, (outwards < 0).select(box.low, within)), passage.normal};
}

}  // namespace scanmill::scan
