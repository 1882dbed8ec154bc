// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/narrow_holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "region_grow/filling.hpp"
#include "region_grow/small_holes.hpp"

namespace scanmill::growing {

namespace {

/// Of loops that are filled at all, and in place of one triangle, of two. The first is what close-holes may ask for;
/// the others keep what is tried (edges⁴ and edges⁵) below what the longest loop costs.
constexpr std::array<std::size_t, 3> most_corners{100, 30, 12};
/// Of 172 degrees: the sides of a cone of half angle 12 differ by 156, and a filling over its tip splits that unevenly.
/// What is left of 180 keeps rounding from laying triangles on each other.
constexpr double least_fold_cosine = -0.9902680687415704;
/// Between the filling and the triangles round the loop, on average. A tip's sides face the way that its lid does; the
/// strips beside a scrap, a fold with rims all round, face away from what would close it by 120 degrees or more.
constexpr double least_facing = -0.5;
/// Along a channel or a wall's end the sides stand across what would close it, at 90 degrees less what noise makes of
/// them; 78 lies between those and a slit across a bend of 120.
constexpr double least_facing_of_long = 0.2;
/// A filling through points all round a hole's centre reaches one circle from it; noise and bends make it less than
/// two.
constexpr double long_in_circles = 2;

/// Where a loop is, and how the surface faces round it.
struct Rim {
    double farthest = 0;  ///< of its corners from the border's centre
    double facing = 0;  ///< mean cosine, along the border, between its triangles and a filling
    double mean_radius = 0;  ///< of search
    /// Between the normals of any two triangles at the border, the least; of a loop that is not asked for it, 1.
    double least_cosine = 1;

    /// Corners counter-clockwise as a filling's triangles.
    Rim(const Surface& surface, std::span<const u32> corners, bool compare) {
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
        std::vector<Vec3> normals;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const u32 a = corners[i], b = next(i);
            const Vec3 normal = surface.facet_normal(b, a, surface.fans.left_of(b, a));
            for (const Vec3& other : normals) least_cosine = std::min(least_cosine, normal.dot(other));
            if (compare) normals.push_back(normal);
            facing += (p[b] - p[a]).norm() / length * normal.dot(facing_of_filling);
            farthest = std::max(farthest, (p[a] - centre).norm());
            mean_radius += surface.search_radius[a] / static_cast<double>(corners.size());
        }
    }
};

class Closing {
public:
    Closing(Surface& surface, const NarrowLimits& limits, const Context& context)
        : surface_(surface),
          narrow_(limits),
          bend_cosine_(std::max(least_fold_cosine, std::cos(limits.largest_bend) - 1e-9)),
          context_(context) {}

    /// Corners counter-clockwise as the filling's triangles.
    bool close(const std::vector<u32>& corners) {
        context_.check_cancelled();
        const bool of_any_size = corners.size() <= narrow_.most_edges;
        const bool ends_at_bends = !of_any_size && bend_cosine_ > least_fold_cosine;
        const Rim rim(surface_, corners, ends_at_bends);
        const double circle = narrow_.largest_circle * rim.mean_radius;
        const bool is_long = rim.farthest > long_in_circles * circle;
        if (rim.facing < (is_long ? least_facing_of_long : least_facing)) return false;
        if (ends_at_bends && rim.least_cosine < bend_cosine_) return false;
        limits_ = of_any_size ? FillLimits{std::numeric_limits<double>::infinity(), least_fold_cosine}
                              : FillLimits{circle, bend_cosine_};
        if (fill(corners, 0)) return true;
        // Where only larger triangles would do, taking one off leaves more to fill with them.
        if (corners.size() > most_corners[1] || !can_be_filled(surface_, corners, {limits_.largest_circle, any_bend}))
            return false;
        return fill(corners, 1) || (corners.size() <= most_corners[2] && fill(corners, 2));
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
            context_.check_cancelled();
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
    NarrowLimits narrow_;
    double bend_cosine_;
    const Context& context_;
    FillLimits limits_{};
    NearTriangles near_;
};

}  // namespace

NarrowHoles close_narrow_holes(Surface& surface, const NarrowLimits& limits, const Context& context) {
    NarrowHoles result;
    Closing closing(surface, limits, context);
    std::vector<bool> passed(surface.states.size(), false);
    for (u32 begin = 0; begin < passed.size(); ++begin) {
        if (surface.states[begin] != PlaceState::front || passed[begin]) continue;
        std::vector<u32> loop;
        for (u32 vertex = begin; !passed[vertex]; vertex = surface.next_on_border(vertex)) {
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
