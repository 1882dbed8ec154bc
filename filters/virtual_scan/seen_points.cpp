// SPDX-License-Identifier: GPL-3.0-or-later
#include "virtual_scan/seen_points.hpp"

#include <bit>
#include <cmath>

namespace scanmill::scan {

namespace {
constexpr u32 end_of_list = ~u32(0);
}

SeenPoints::Cell SeenPoints::cell_of(const Vec3& point) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
        cell[axis] = static_cast<std::int64_t>(std::floor((point[axis] - origin_[axis]) / radius_));
    return cell;
}

std::size_t SeenPoints::slot_of(const Cell& cell) const {
    u64 hash = 0;
    for (const std::int64_t number : cell) hash = (hash ^ static_cast<u64>(number)) * 0x9e3779b97f4a7c15u;
    return (hash ^ (hash >> 32)) & (first_.size() - 1);
}

bool SeenPoints::near(const Vec3& point) const {
    if (points_.empty()) return false;
    const Cell cell = cell_of(point);
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                for (u32 i = first_[slot_of({cell[0] + x, cell[1] + y, cell[2] + z})]; i != end_of_list; i = next_[i])
                    if ((points_[i] - point).squaredNorm() < radius_ * radius_) return true;
    return false;
}

void SeenPoints::add(std::span<const Vec3> points) {
    points_.insert(points_.end(), points.begin(), points.end());
    first_.assign(std::bit_ceil(2 * points_.size() + 1), end_of_list);
    next_.resize(points_.size());
    for (u32 i = 0; i < points_.size(); ++i) {
        u32& first = first_[slot_of(cell_of(points_[i]))];
        next_[i] = first;
        first = i;
    }
}

}  // namespace scanmill::scan
