// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/direct_errors.hpp"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>

#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::decimating {

void DirectErrors::begin(std::span<const HoleCorner> corners, const Vec3& up, std::span<const u32> points) {
    corners_ = corners;
    up_ = up;
    points_.clear();
    for (const u32 point : points) points_.push_back(surface_.point(point));
    words_ = (points.size() + 63) / 64;
    const u32 size = static_cast<u32>(corners.size());
    // All points are inside the polygon: left of its edges (i, i + 1), right of (0, last).
    left_.assign(size * size * words_, ~u64(0));
    std::fill_n(left_.begin() + static_cast<std::ptrdiff_t>(index(0, size - 1)), words_, 0);
    for (u32 i = 0; i < size; ++i)
        for (u32 j = i + 2; j < size; ++j) {
            if (i == 0 && j + 1 == size) continue;
            const Vec3 sideways = up.cross(corners[j].position - corners[i].position);
            const Vec3& origin = corners[i].position;
            for (std::size_t word = 0; word < words_; ++word) {
                u64 bits = 0;
                for (std::size_t p = 64 * word; p < std::min(64 * (word + 1), points_.size()); ++p)
                    bits |= u64(sideways.dot(points_[p] - origin) >= 0) << (p % 64);
                left_[index(i, j) + word] = bits;
            }
        }
}

bool DirectErrors::add_edge(u32 i, u32 j, SignedErrors& errors) {
    const u32 from = corners_[i].vertex, to = corners_[j].vertex;
    return !surface_.mesh().has_edge(from, to) && surface_.original.add_path(from, to, up_, limits_.error, errors);
}

template <class Action>
void DirectErrors::for_each_point(u32 i, u32 k, u32 j, Action&& action) const {
    const u64 *ik = left_.data() + index(i, k), *kj = left_.data() + index(k, j), *ij = left_.data() + index(i, j);
    for (std::size_t word = 0; word < words_; ++word) {
        const std::size_t first = 64 * word, count = std::min<std::size_t>(64, points_.size() - first);
        u64 bits = ik[word] & kj[word] & ~ij[word];
        if (count < 64) bits &= (u64(1) << count) - 1;
        for (; bits != 0; bits &= bits - 1) action(first + static_cast<std::size_t>(std::countr_zero(bits)));
    }
}

bool DirectErrors::add_triangle(u32 i, u32 k, u32 j, const Vec3& normal, SignedErrors& errors) {
    const Vec3& origin = corners_[i].position;
    for_each_point(i, k, j, [&](std::size_t p) {
        const double height = normal.dot(points_[p] - origin);
        errors.add(std::abs(height), height >= 0);
    });
    return errors.is_within(limits_.error);
}

bool DirectErrors::assign(std::vector<HoleTriangle>& triangles, u32 first, std::vector<u32>& owners) const {
    const std::size_t begin = owners.size();
    owners.resize(begin + points_.size());
    bool is_within = true;
    for (u32 t = 0; t < triangles.size(); ++t) {
        const auto& [i, k, j] = triangles[t].corners;
        const Vec3 &a = corners_[i].position, &b = corners_[k].position, &c = corners_[j].position;
        const Vec3 normal = area_vector(a, b, c);
        for_each_point(i, k, j, [&](std::size_t p) {
            owners[begin + p] = first + t;
            const double distance = (points_[p] - nearest_on_triangle(points_[p], a, b, c)).norm();
            triangles[t].errors.add(distance, normal.dot(points_[p] - a) >= 0);
        });
        is_within = is_within && triangles[t].errors.is_within(limits_.error);
    }
    return is_within;
}

}  // namespace scanmill::decimating
