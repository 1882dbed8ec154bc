// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/restored_edges.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <vector>

#include "scanmill/geometry/growing/holes.hpp"
#include "scanmill/geometry/growing/intersections.hpp"

namespace scanmill::growing {

namespace {

constexpr std::size_t longest_strip = 8;
constexpr std::size_t most_corners = 8;
/// Cosine of 172 degrees; the margin prevents that rounding makes triangles coincide.
constexpr double tip_cosine = -0.9902680687415704;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The corners of a strip of triangles on both sides of the line between its ends, without these ends.
struct Strip {
    std::vector<u32> left, right;
    std::vector<Triangle> triangles;
    /// Largest distance of an inner edge's middle from the line.
    double farthest = 0;
};

class EdgeRestorer {
public:
    EdgeRestorer(Surface& surface, double largest_circle, const Execution& execution)
        : surface_(surface),
          largest_circle_(largest_circle),
          execution_(execution) {}

    std::size_t restore_all() {
        for (u32 point = 0; point < surface_.points.size(); ++point)
            if (surface_.fixed_edges.at(point) && surface_.fans.empty(point)) insert(point);
        for (u32 from = 0; from < surface_.points.size(); ++from)
            for (u32 to : surface_.fixed_edges.of(from))
                if (from < to && is_missing(from, to)) restore(from, to);
        const std::size_t count = removed_.size();
        surface_.drop(std::move(removed_));
        return count;
    }

private:
    const Vec3& at(u32 point) const { return surface_.positions[point]; }

    bool is_missing(u32 a, u32 b) const {
        return surface_.fans.left_of(a, b) == invalid_index && surface_.fans.left_of(b, a) == invalid_index;
    }

    /// Replaces the triangles by others, which cover the polygons. Each polygon has the counter-clockwise order of its
    /// triangles. Changes nothing and returns false if a polygon cannot be triangulated.
    bool replace(const std::vector<Triangle>& old, const std::vector<std::vector<u32>>& polygons,
                 double largest_radius) {
        execution_.check_cancelled();
        for (const Triangle& triangle : old) surface_.fans.remove(triangle);
        std::vector<Triangle> added;
        bool done = true;
        for (const std::vector<u32>& polygon : polygons) {
            const std::vector<Triangle> triangles =
                triangulate_hole(surface_, near_, polygon, {largest_radius, tip_cosine});
            done = !triangles.empty();
            if (!done) break;
            for (const Triangle& triangle : triangles) surface_.fans.add(triangle);
            added.insert(added.end(), triangles.begin(), triangles.end());
        }
        for (const Triangle& triangle : added) surface_.fans.remove(triangle);
        if (!done) {
            for (const Triangle& triangle : old) surface_.fans.add(triangle);
            return false;
        }
        for (const Triangle& triangle : added) surface_.add(triangle, closing_pass);
        removed_.insert(removed_.end(), old.begin(), old.end());
        return true;
    }

    bool restore(u32 from, u32 to) {
        if (surface_.fans.empty(from) || surface_.fans.empty(to)) return false;
        for (std::size_t length = 2; length <= longest_strip; ++length) {
            std::vector<Strip> strips;
            surface_.fans.any(from, [&](const Fans::LinkEdge& edge) {
                extend({{edge.last}, {edge.first}, {{from, edge.first, edge.last}}, 0}, from, to, length, strips);
                return false;
            });
            std::ranges::stable_sort(strips, {}, &Strip::farthest);
            for (const Strip& strip : strips) {
                std::vector<u32> right{from}, left{to};
                right.insert(right.end(), strip.right.begin(), strip.right.end());
                right.push_back(to);
                left.insert(left.end(), strip.left.rbegin(), strip.left.rend());
                left.push_back(from);
                if (replace(strip.triangles, {right, left}, infinity)) return true;
            }
        }
        return divide_loop(from, to);
    }

    /// Continues the strip over its last inner edge, in all ways that reach `to` with `length` triangles.
    void extend(Strip strip, u32 from, u32 to, std::size_t length, std::vector<Strip>& found) const {
        const u32 left = strip.left.back(), right = strip.right.back();
        if (surface_.fixed_edges.contains(left, right)) return;
        const u32 third = surface_.fans.left_of(left, right);
        if (third == invalid_index || third == from || std::ranges::count(strip.left, third) > 0 ||
            std::ranges::count(strip.right, third) > 0)
            return;
        const Vec3 along = at(to) - at(from), middle = (at(left) + at(right)) / 2 - at(from);
        const double share = std::clamp(middle.dot(along) / along.squaredNorm(), 0.0, 1.0);
        strip.farthest = std::max(strip.farthest, (middle - share * along).norm());
        strip.triangles.push_back({left, right, third});
        if (third == to) {
            if (strip.triangles.size() == length) found.push_back(std::move(strip));
            return;
        }
        if (strip.triangles.size() == length) return;
        Strip over_right = strip;
        over_right.left.push_back(third);
        extend(std::move(over_right), from, to, length, found);
        strip.right.push_back(third);
        extend(std::move(strip), from, to, length, found);
    }

    /// The boundary loop through a vertex, in the order of the triangles that would close it.
    std::vector<u32> loop_at(u32 vertex) const {
        std::vector<u32> loop;
        u32 next = vertex;
        do {
            loop.push_back(next);
            next = surface_.next_on_boundary(next);
        } while (next != vertex && next != invalid_index);
        std::ranges::reverse(loop);
        return loop;
    }

    bool divide_loop(u32 from, u32 to) {
        if (surface_.states[from] != PointState::front || surface_.states[to] != PointState::front) return false;
        std::vector<u32> loop = loop_at(from);
        std::ranges::rotate(loop, std::ranges::find(loop, from));
        const auto end = std::ranges::find(loop, to);
        if (end == loop.end()) return false;
        const std::vector<u32> one(loop.begin(), end + 1);
        std::vector<u32> other(end, loop.end());
        other.push_back(from);
        const double radius = largest_circle_ * std::max(surface_.search_radius[from], surface_.search_radius[to]);
        bool closed = false;
        for (const std::vector<u32>& part : {one, other})
            if (part.size() <= most_corners && replace({}, {part}, radius)) closed = true;
        return closed;
    }

    /// Joins an unused point to the surface.
    void insert(u32 point) {
        struct Cavity {
            double distance;
            std::vector<Triangle> triangles;
            std::vector<u32> corners;
        };
        std::vector<Cavity> cavities;
        const auto consider = [&](u32 a, u32 b, u32 c) {
            const double distance = ((at(a) + at(b) + at(c)) / 3 - at(point)).norm();
            cavities.push_back({distance, {{a, b, c}}, {a, b, c}});
            // The two triangles of edge a – b.
            const u32 d = surface_.fans.left_of(b, a);
            if (d == invalid_index || surface_.fixed_edges.contains(a, b)) return;
            cavities.push_back({((at(a) + at(b)) / 2 - at(point)).norm(), {{a, b, c}, {b, a, d}}, {a, d, b, c}});
        };
        for (u32 other : surface_.neighbourhoods.of(point))
            surface_.fans.any(other, [&](const Fans::LinkEdge& edge) {
                consider(other, edge.first, edge.last);
                return false;
            });
        std::ranges::stable_sort(cavities, {}, &Cavity::distance);
        for (const Cavity& cavity : cavities) {
            if (cavity.distance > largest_circle_ * surface_.search_radius[point]) return;
            if (fill_around(point, cavity.triangles, cavity.corners)) return;
        }
    }

    /// Replaces the triangles by a fan round the point. Changes nothing and returns false if the fan would fold back or
    /// intersect the surface.
    bool fill_around(u32 point, const std::vector<Triangle>& old, const std::vector<u32>& corners) {
        execution_.check_cancelled();
        for (const Triangle& triangle : old) surface_.fans.remove(triangle);
        std::vector<Triangle> fan;
        for (std::size_t i = 0; i < corners.size(); ++i)
            fan.push_back({point, corners[i], corners[(i + 1) % corners.size()]});
        const auto is_good = [&](std::size_t i) {
            const auto& [apex, a, b] = fan[i];
            const Vec3 normal = surface_.facet_normal(apex, a, b);
            const auto& [next_apex, next_a, next_b] = fan[(i + 1) % fan.size()];
            const u32 outer = surface_.fans.left_of(b, a);
            near_.gather_near(surface_, fan[i]);
            return normal.allFinite() && normal.norm() > 0.5 &&
                   surface_.facet_normal(next_apex, next_a, next_b).dot(normal) > fold_cosine &&
                   (outer == invalid_index || surface_.facet_normal(b, a, outer).dot(normal) > fold_cosine) &&
                   !near_.intersect(surface_, fan[i]);
        };
        for (std::size_t i = 0; i < fan.size(); ++i)
            if (!is_good(i)) {
                for (const Triangle& triangle : old) surface_.fans.add(triangle);
                return false;
            }
        for (const Triangle& triangle : fan) surface_.add(triangle, closing_pass);
        removed_.insert(removed_.end(), old.begin(), old.end());
        return true;
    }

    Surface& surface_;
    double largest_circle_;
    const Execution& execution_;
    NearTriangles near_;
    std::vector<Triangle> removed_;
};

}  // namespace

std::size_t restore_fixed_edges(Surface& surface, double largest_circle, const Execution& execution) {
    return EdgeRestorer(surface, largest_circle, execution).restore_all();
}

}  // namespace scanmill::growing
