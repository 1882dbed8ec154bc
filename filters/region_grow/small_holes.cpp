// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/small_holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace scanmill::growing {

namespace {

constexpr double least_fold_cosine = -0.8660254037844387;  // of 150 degrees
constexpr double impossible = std::numeric_limits<double>::infinity();

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

/// A hole's corners, counter-clockwise as its triangles will be, and the cheapest way to fill it.
class Filling {
public:
    Filling(const Surface& surface, std::vector<u32> corners)
        : surface_(surface),
          corners_(std::move(corners)),
          cost_(corners_.size() * corners_.size(), 0),
          through_(cost_.size(), 0) {}

    bool find() {
        const std::size_t count = corners_.size();
        for (std::size_t span = 2; span < count; ++span)
            for (std::size_t i = 0; i + span < count; ++i) solve(i, i + span);
        return cost(0, count - 1) < impossible;
    }
    void fill(Surface& surface) const { fill(surface, 0, corners_.size() - 1); }

private:
    double& cost(std::size_t i, std::size_t j) { return cost_[i * corners_.size() + j]; }

    void solve(std::size_t i, std::size_t j) {
        double least = impossible;
        const bool is_side = i == 0 && j + 1 == corners_.size();
        if (is_side || (surface_.fans.left_of(corners_[i], corners_[j]) == nobody &&
                        surface_.fans.left_of(corners_[j], corners_[i]) == nobody))
            for (std::size_t k = i + 1; k < j; ++k) {
                const double sum = cost(i, k) + cost(k, j) + area(i, k, j);
                if (sum < least) {
                    least = sum;
                    through_[i * corners_.size() + j] = k;
                }
            }
        cost(i, j) = least;
    }

    double area(std::size_t i, std::size_t k, std::size_t j) const {
        const auto& p = surface_.positions;
        const std::array<u32, 3> corner{corners_[i], corners_[k], corners_[j]};
        const Vec3 normal = (p[corner[1]] - p[corner[0]]).cross(p[corner[2]] - p[corner[0]]);
        const double length = normal.norm();
        if (!(length > 0)) return impossible;
        for (std::size_t side = 0; side < 3; ++side) {
            const u32 from = corner[(side + 1) % 3], to = corner[side];
            const u32 third = surface_.fans.left_of(from, to);
            if (third != nobody && surface_.facet_normal(from, to, third).dot(normal) < least_fold_cosine * length)
                return impossible;
        }
        return length;
    }

    void fill(Surface& surface, std::size_t i, std::size_t j) const {
        if (j - i < 2) return;
        const std::size_t k = through_[i * corners_.size() + j];
        fill(surface, i, k);
        fill(surface, k, j);
        surface.add({corners_[i], corners_[k], corners_[j]}, closing_pass);
    }

    const Surface& surface_;
    std::vector<u32> corners_;
    std::vector<double> cost_;
    std::vector<std::size_t> through_;
};

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

std::size_t close_small_holes(Surface& surface, std::size_t most_edges) {
    if (most_edges < 3) return 0;
    std::size_t closed = 0;
    // Each from its lowest corner. Filling others leaves them as impossible as they were: their border edges keep their
    // triangles, and edges across them can only be taken.
    std::set<std::vector<u32>> impossible_loops;
    const std::size_t count = surface.triangles.size();
    for (std::size_t row = 0; row < count; ++row) {
        const Triangle triangle = surface.triangles[row];
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3];
            if (surface.states[from] == PlaceState::interior || surface.states[to] == PlaceState::interior ||
                surface.fans.right_of(from, to) != nobody)
                continue;
            std::vector<u32> hole = hole_at(surface, from, to, most_edges);
            if (hole.size() < 3) continue;
            std::vector<u32> from_lowest = hole;
            std::ranges::rotate(from_lowest, std::ranges::min_element(from_lowest));
            if (impossible_loops.contains(from_lowest)) continue;
            Filling filling(surface, std::move(hole));
            if (!filling.find()) {
                impossible_loops.insert(std::move(from_lowest));
                continue;
            }
            filling.fill(surface);
            ++closed;
        }
    }
    return closed;
}

}  // namespace scanmill::growing
