// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/accumulated_errors.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace scanmill::decimating {

void AccumulatedErrors::begin(std::span<const HoleCorner> corners, const Vec3& up,
                              std::span<const SignedErrors> old_errors, std::span<const OldEdge> old_edges,
                              std::span<const u32> ring_triangles, const Vec3* removed, const SignedErrors& line) {
    corners_ = corners;
    up_ = up;
    old_errors_ = old_errors;
    old_edges_ = old_edges;
    ring_triangles_ = ring_triangles;
    removed_ = removed;
    line_ = line;
}

bool AccumulatedErrors::add_edge(u32 i, u32 j, SignedErrors&) {
    return !surface_.mesh().has_edge(corners_[i].vertex, corners_[j].vertex);
}

bool AccumulatedErrors::add_triangle(u32 i, u32 k, u32 j, const Vec3& normal, SignedErrors& errors) {
    deltas_.assign(old_errors_.size(), {});
    overlaps_.assign(old_errors_.size(), false);
    const std::array<Vec3, 3> corners{corners_[i].position, corners_[k].position, corners_[j].position};
    const double slope = normal.dot(up_);
    if (!(slope > 0)) return false;
    // Adds the height of a point of the old surface over the new triangle, measured along `up`.
    const auto add = [&](u32 triangle, const Vec3& old) {
        const double height = normal.dot(old - corners[0]) / slope;
        deltas_[triangle].add(std::abs(height), height >= 0);
        overlaps_[triangle] = true;
    };
    const auto side = [&](const Vec3& from, const Vec3& to, const Vec3& point) {
        return up_.dot((to - from).cross(point - from));
    };
    if (removed_ != nullptr) {
        bool is_inside = true;
        for (std::size_t c = 0; c < 3; ++c)
            is_inside = is_inside && side(corners[c], corners[(c + 1) % 3], *removed_) >= 0;
        if (is_inside)
            for (u32 t = 0; t < old_errors_.size(); ++t) add(t, *removed_);
    }
    for (const OldEdge& edge : old_edges_)
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 &from = corners[c], &to = corners[(c + 1) % 3];
            const double begin = side(from, to, edge.from), end = side(from, to, edge.to);
            const double left = side(edge.from, edge.to, from), right = side(edge.from, edge.to, to);
            if (!(begin * end < 0) || !(left * right < 0)) continue;
            const Vec3 crossing = edge.from + begin / (begin - end) * (edge.to - edge.from);
            for (const u32 triangle : edge.triangles) add(triangle, crossing);
        }
    for (const auto& [from, to] : {std::pair(i, k), std::pair(k, j), std::pair(j, i)}) {
        const u32 triangle = ring_triangles_[from];
        if ((from + 1) % corners_.size() == to && triangle < overlaps_.size()) overlaps_[triangle] = true;
    }
    for (std::size_t t = 0; t < old_errors_.size(); ++t) {
        if (!overlaps_[t]) continue;
        errors.outside = std::max(errors.outside, old_errors_[t].outside + std::max(deltas_[t].outside, line_.outside));
        errors.inside = std::max(errors.inside, old_errors_[t].inside + std::max(deltas_[t].inside, line_.inside));
    }
    return errors.is_within(limits_.error);
}

}  // namespace scanmill::decimating
