// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/narrow_holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

#include "region_grow/filling.hpp"
#include "region_grow/small_holes.hpp"

namespace scanmill::growing {

namespace {

/// Of loops that are filled at all, and in place of one triangle, of two.
constexpr std::array<std::size_t, 3> most_corners{100, 30, 12};
constexpr double least_fold_cosine = -0.9902680687415704;  // of 172 degrees
/// Between the filling and the triangles round the loop, on average: of 120 and of 78 degrees.
constexpr double least_facing = -0.5, least_facing_of_long = 0.2;

/// The border edge that leaves the vertex, surface on its left. Pre: it is on the border, with one fan.
u32 next_on_border(const Surface& surface, u32 vertex) {
    u32 next = nobody;
    surface.fans.any(vertex, [&](const Fans::Pair& pair) {
        return surface.fans.right_of(vertex, pair.first) == nobody && (next = pair.first, true);
    });
    return next;
}

/// Where a loop is, and how the surface faces round it.
struct Rim {
    double farthest = 0;  ///< of its corners from the border's centre
    double facing = 0;  ///< mean cosine, along the border, between its triangles and a filling
    double mean_radius = 0;  ///< of search

    /// Corners counter-clockwise as a filling's triangles.
    Rim(const Surface& surface, std::span<const u32> corners) {
        const auto& p = surface.positions;
        const auto next = [&](std::size_t i) { return corners[i + 1 < corners.size() ? i + 1 : 0]; };
        Vec3 centre = Vec3::Zero(), area = Vec3::Zero();
        double length = 0;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vec3 &a = p[corners[i]], &b = p[next(i)];
            const double edge = (b - a).norm();
            length += edge;
            centre += edge * ((a + b) / 2);
            area += (a - p[corners[0]]).cross(b - p[corners[0]]);
        }
        centre /= length;
        const Vec3 facing_of_filling = area.normalized();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const u32 a = corners[i], b = next(i);
            const Vec3 normal = surface.facet_normal(b, a, surface.fans.left_of(b, a));
            facing += (p[b] - p[a]).norm() / length * normal.dot(facing_of_filling);
            farthest = std::max(farthest, (p[a] - centre).norm());
            mean_radius += surface.search_radius[a] / static_cast<double>(corners.size());
        }
    }
};

class Closing {
public:
    Closing(Surface& surface, double largest_circle, std::size_t most_edges)
        : surface_(surface),
          largest_circle_(largest_circle),
          most_edges_(most_edges) {}

    /// Corners counter-clockwise as the filling's triangles.
    bool close(const std::vector<u32>& corners) {
        const Rim rim(surface_, corners);
        const double circle = largest_circle_ * rim.mean_radius;
        const bool is_long = rim.farthest > 2 * circle;
        if (rim.facing < (is_long ? least_facing_of_long : least_facing)) return false;
        limits_ = {corners.size() <= most_edges_ ? std::numeric_limits<double>::infinity() : circle, least_fold_cosine};
        for (std::size_t in_place_of = 0; in_place_of < most_corners.size(); ++in_place_of)
            if (corners.size() <= most_corners[in_place_of] && fill(corners, in_place_of)) return true;
        return false;
    }

    std::vector<Triangle> replaced;

private:
    bool fill(const std::vector<u32>& corners, std::size_t in_place_of) {
        if (in_place_of > 0) return fill_in_place(corners, in_place_of);
        const std::vector<Triangle> filling = cheapest_filling(surface_, near_, corners, limits_);
        for (const Triangle& triangle : filling) surface_.add(triangle, closing_pass);
        return !filling.empty();
    }

    /// Takes the triangle at one edge after the other off and fills what is then the hole.
    bool fill_in_place(const std::vector<u32>& corners, std::size_t in_place_of) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const u32 from = corners[i], to = corners[i + 1 < corners.size() ? i + 1 : 0];
            const u32 third = surface_.fans.left_of(to, from);
            // Else it would be a corner of two loops, or twice of this one.
            if (surface_.states[third] != PlaceState::interior || std::ranges::find(corners, third) != corners.end())
                continue;
            const Triangle in_the_way{to, from, third};
            std::vector<u32> wider = corners;
            wider.insert(wider.begin() + static_cast<std::ptrdiff_t>(i) + 1, third);
            surface_.fans.remove(in_the_way);
            if (fill(wider, in_place_of - 1)) {
                replaced.push_back(in_the_way);
                return true;
            }
            surface_.fans.add(in_the_way);
        }
        return false;
    }

    Surface& surface_;
    double largest_circle_;
    std::size_t most_edges_;
    FillLimits limits_{};
    NearTriangles near_;
};

}  // namespace

NarrowHoles close_narrow_holes(Surface& surface, double largest_circle, std::size_t most_edges) {
    NarrowHoles result;
    Closing closing(surface, largest_circle, most_edges);
    std::vector<bool> passed(surface.states.size(), false);
    for (u32 begin = 0; begin < passed.size(); ++begin) {
        if (surface.states[begin] != PlaceState::front || passed[begin]) continue;
        std::vector<u32> loop;
        for (u32 vertex = begin; !passed[vertex]; vertex = next_on_border(surface, vertex)) {
            passed[vertex] = true;
            loop.push_back(vertex);
        }
        if (loop.size() < 3 || loop.size() > most_corners[0]) continue;
        std::ranges::reverse(loop);
        result.closed += closing.close(loop);
    }
    result.replaced = closing.replaced.size();
    surface.drop(std::move(closing.replaced));
    return result;
}

}  // namespace scanmill::growing
