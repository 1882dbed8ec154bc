// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/small_holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "region_grow/filling.hpp"

namespace scanmill::growing {

namespace {

constexpr double impossible = std::numeric_limits<double>::infinity();

constexpr FillLimits any_size{impossible, least_bend_cosine};

/// Grows with the angle from `ref` to `direction`, counter-clockwise seen against `axis`, from 0 to 4.
double turn(const Vec3& ref, const Vec3& direction, const Vec3& axis) {
    const double along = ref.dot(direction), across = axis.dot(ref.cross(direction));
    const double share = along / (std::abs(along) + std::abs(across));
    return across >= 0 ? 1 - share : 3 + share;
}

/// The border edge that follows from → vertex round the hole on its right.
u32 next_on_hole(const Surface& surface, u32 from, u32 vertex) {
    const auto& p = surface.positions;
    const Vec3 back = p[from] - p[vertex];
    u32 next = nobody;
    double least = impossible;
    surface.fans.any(vertex, [&](const Fans::Pair& pair) {
        if (surface.fans.right_of(vertex, pair.first) != nobody) return false;
        const double angle = turn(back, p[pair.first] - p[vertex], surface.normals[vertex]);
        if (next == nobody || angle < least || (angle == least && pair.first < next)) {
            next = pair.first;
            least = angle;
        }
        return false;
    });
    return next;
}

/// The loop's vertices, each once, against its direction; empty when it is longer or passes a vertex twice.
std::vector<u32> hole_at(const Surface& surface, u32 from, u32 to, std::size_t most_edges) {
    std::vector<u32> loop{from};
    for (u32 before = from, vertex = to; vertex != from;) {
        if (loop.size() == most_edges || std::ranges::find(loop, vertex) != loop.end()) return {};
        loop.push_back(vertex);
        before = std::exchange(vertex, next_on_hole(surface, before, vertex));
    }
    // Where fans meet the walk may have come back by another edge than it left by.
    if (next_on_hole(surface, loop.back(), from) != to) return {};
    std::ranges::reverse(loop);
    return loop;
}

}  // namespace

std::size_t close_small_holes(Surface& surface, std::size_t most_edges, const Context& context) {
    if (most_edges < 3) return 0;
    std::size_t closed = 0;
    // Each from its lowest corner. Filling others leaves them as impossible as they were: their border edges keep their
    // triangles, and edges across them can only be taken.
    std::set<std::vector<u32>> impossible_loops;
    NearTriangles near;
    const std::size_t count = surface.triangles.size();
    for (std::size_t row = 0; row < count; ++row) {
        if (row % 1024 == 0) context.check_cancelled();
        const Triangle triangle = surface.triangles[row];
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3];
            if (surface.states[from] == PlaceState::interior || surface.states[to] == PlaceState::interior ||
                surface.fans.right_of(from, to) != nobody)
                continue;
            const std::vector<u32> hole = hole_at(surface, from, to, most_edges);
            if (hole.size() < 3) continue;
            std::vector<u32> from_lowest = hole;
            std::ranges::rotate(from_lowest, std::ranges::min_element(from_lowest));
            if (impossible_loops.contains(from_lowest)) continue;
            context.check_cancelled();  // a long loop takes as long as a million triangles
            const std::vector<Triangle> filling = cheapest_filling(surface, near, hole, any_size);
            for (const Triangle& filled : filling) surface.add(filled, closing_pass);
            if (filling.empty())
                impossible_loops.insert(std::move(from_lowest));
            else
                ++closed;
        }
    }
    return closed;
}

}  // namespace scanmill::growing
