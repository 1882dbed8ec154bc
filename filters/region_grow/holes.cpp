// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "region_grow/intersections.hpp"

namespace scanmill::growing {

namespace {

constexpr double impossible = std::numeric_limits<double>::infinity();

/// A hole's corners, counter-clockwise as its triangles will be. The part between corners i and j is filled by a
/// triangle over the chord from i to j, and by the parts beyond its other sides.
class Filling {
public:
    Filling(const Surface& surface, const NearTriangles& near, const std::vector<u32>& corners,
            const FillLimits& limits)
        : surface_(surface),
          near_(near),
          corners_(corners),
          limits_(limits),
          parts_(corners_.size() * corners_.size()) {}

    std::vector<Triangle> find() {
        const std::size_t count = corners_.size();
        for (std::size_t span = 2; span < count; ++span)
            for (std::size_t i = 0; i + span < count; ++i) solve(i, i + span);
        std::vector<Triangle> triangles;
        if (part(0, count - 1).cost < impossible) collect(0, count - 1, triangles);
        return triangles;
    }

private:
    struct Part {
        double cost = 0;
        std::size_t apex = 0;
        /// Of the triangle over the chord.
        Vec3 normal = Vec3::Zero();
    };
    Part& part(std::size_t i, std::size_t j) { return parts_[i * corners_.size() + j]; }

    bool is_free(u32 a, u32 b) const {
        return surface_.fans.left_of(a, b) == nobody && surface_.fans.left_of(b, a) == nobody;
    }

    void solve(std::size_t i, std::size_t j) {
        Part best{impossible, 0, Vec3::Zero()};
        const bool is_side = i == 0 && j + 1 == corners_.size();
        if (is_side || is_free(corners_[i], corners_[j]))
            for (std::size_t k = i + 1; k < j; ++k) {
                const double others = part(i, k).cost + part(k, j).cost;
                if (others < best.cost) try_apex(i, k, j, others, best);
            }
        part(i, j) = best;
    }

    void try_apex(std::size_t i, std::size_t k, std::size_t j, double others, Part& best) {
        const auto& p = surface_.positions;
        const Triangle triangle{corners_[i], corners_[k], corners_[j]};
        const Vec3 u = p[triangle[1]] - p[triangle[0]], w = p[triangle[2]] - p[triangle[0]];
        const Vec3 across = u.cross(w);
        const double twice_area = across.norm();
        if (!(twice_area > 0) || !(others + twice_area < best.cost)) return;
        const double squared = squared_circle(u.squaredNorm(), w.squaredNorm(), (w - u).squaredNorm(), twice_area);
        if (squared > limits_.largest_circle * limits_.largest_circle) return;
        const Vec3 normal = across / twice_area;
        if (folds(i, k, normal) || folds(k, j, normal) || (i == 0 && j + 1 == corners_.size() && folds(j, i, normal)))
            return;
        if (near_.meet(surface_, triangle)) return;
        best = {others + twice_area, k, normal};
    }

    /// Back on what lies beyond the chord: the surface, or the part filled before.
    bool folds(std::size_t i, std::size_t j, const Vec3& normal) {
        const u32 from = corners_[j], to = corners_[i], third = surface_.fans.left_of(from, to);
        if (third != nobody) return surface_.facet_normal(from, to, third).dot(normal) < limits_.bend_cosine;
        return part(i, j).normal.dot(normal) < limits_.bend_cosine;
    }

    void collect(std::size_t i, std::size_t j, std::vector<Triangle>& triangles) {
        if (j - i < 2) return;
        const std::size_t k = part(i, j).apex;
        collect(i, k, triangles);
        collect(k, j, triangles);
        triangles.push_back({corners_[i], corners_[k], corners_[j]});
    }

    const Surface& surface_;
    const NearTriangles& near_;
    const std::vector<u32>& corners_;
    FillLimits limits_;
    std::vector<Part> parts_;
};

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

bool can_be_filled(const Surface& surface, const std::vector<u32>& corners, const FillLimits& limits) {
    const NearTriangles nothing;
    return !Filling(surface, nothing, corners, limits).find().empty();
}

std::vector<Triangle> cheapest_filling(const Surface& surface, NearTriangles& near, const std::vector<u32>& corners,
                                       const FillLimits& limits) {
    // Seldom is anything in the way, and when there is no filling at all there is none past it either.
    const NearTriangles nothing;
    std::vector<Triangle> triangles = Filling(surface, nothing, corners, limits).find();
    if (triangles.empty()) return {};
    near.gather_round(surface, corners);
    if (std::ranges::any_of(triangles, [&](const Triangle& t) { return near.meet(surface, t); }))
        triangles = Filling(surface, near, corners, limits).find();
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (meet(surface.positions, triangles[i], triangles[j])) return {};
    return triangles;
}

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
