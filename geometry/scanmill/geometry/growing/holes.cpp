// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "scanmill/base/elementary.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "scanmill/geometry/mesh/hole_triangulation.hpp"

namespace scanmill::growing {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Largest number of edges of a narrow loop that is closed with no, one or two replaced triangles. The first number is
/// the most that callers offer as a parameter. The other two keep the number of attempts (edges⁴ and edges⁵) below the
/// cost of the longest loop.
constexpr std::array<std::size_t, 3> most_corners{100, 30, 12};
/// Cosine of 172 degrees. The sides of a cone of half angle 12 differ by 156 degrees, and a triangulation over its tip
/// divides this angle unevenly. The margin of 8 degrees to 180 degrees prevents that rounding makes triangles coincide.
constexpr double tip_cosine = -0.9902680687415704;
/// Least mean cosine between the normals of the triangulation and of the triangles around the loop. The sides of a tip
/// face the same way as the triangulation that closes it. At a narrow strip along a fold that is open on all sides, the
/// triangles face away from the triangulation by 120 degrees or more.
constexpr double least_facing = -0.5;
/// Replaces least_facing for long loops. The walls of a channel are at 90 degrees to the triangulation; noise reduces
/// this angle. The limit of 78 degrees lies between such walls and a slit across a fold of 120 degrees.
constexpr double least_facing_of_long = 0.2;
/// A loop is long if a corner is farther than this many radii from its centre. A triangulation with all corners around
/// a hole's centre extends one radius from the centre; noise and folds add less than another radius.
constexpr double long_in_radii = 2;

/// Triangles of least total area that keep the limits and intersect none of `near`; empty if none were found.
std::vector<Triangle> least_triangulation(const Surface& surface, const NearTriangles& near,
                                          const std::vector<u32>& corners, const TriangulationLimits& limits) {
    const auto& p = surface.positions;
    const Fans& fans = surface.fans;
    const u32 count = static_cast<u32>(corners.size());
    std::vector<Vec3> normals(corners.size() * corners.size(),
                              Vec3::Zero());  // by edge i j: normal of the triangle at it
    const auto edge_cost = [&](u32 i, u32 j) {
        const u32 a = corners[i], b = corners[j];
        const bool is_free = fans.left_of(a, b) == invalid_index && fans.left_of(b, a) == invalid_index;
        return is_free && (p[b] - p[a]).norm() < limits.longest_edge ? 0 : infinity;
    };
    const auto across = [&](u32 i, u32 k, u32 j) -> Vec3 {
        return (p[corners[k]] - p[corners[i]]).cross(p[corners[j]] - p[corners[i]]);
    };
    const auto triangle_cost = [&](u32 i, u32 k, u32 j) {
        const double twice_area = across(i, k, j).norm();
        return twice_area > 0 ? twice_area : infinity;
    };
    // Whether the dihedral deviation at edge i j exceeds the limit. The neighbour is a triangle of the surface or, at a
    // new edge, the triangle already chosen there.
    const auto folds = [&](u32 i, u32 j, const Vec3& normal) {
        const u32 from = corners[j], to = corners[i], third = fans.left_of(from, to);
        const Vec3 other = third != invalid_index ? surface.facet_normal(from, to, third) : normals[i * count + j];
        return other.dot(normal) < limits.dihedral_cosine;
    };
    const auto accepts = [&](u32 i, u32 k, u32 j) {
        const Vec3 &a = p[corners[i]], &b = p[corners[k]], &c = p[corners[j]];
        const Vec3 doubled = across(i, k, j);
        const double twice_area = doubled.norm();
        const double squared = squared_enclosing_radius((b - a).squaredNorm(), (c - a).squaredNorm(),
                                                        ((c - a) - (b - a)).squaredNorm(), twice_area);
        if (squared > limits.largest_radius * limits.largest_radius) return false;
        const Vec3 normal = doubled / twice_area;
        if (folds(i, k, normal) || folds(k, j, normal) || (j - i + 1 == count && folds(j, i, normal))) return false;
        if (near.intersect(surface, {corners[i], corners[k], corners[j]})) return false;
        normals[i * count + j] = normal;
        return true;
    };
    HoleTriangulation best;
    std::vector<Triangle> triangles;
    if (best.solve(count, edge_cost, triangle_cost, accepts))
        for (const auto& [i, k, j] : best.triangles()) triangles.push_back({corners[i], corners[k], corners[j]});
    return triangles;
}

/// Returns a number from 0 to 4 that increases with the angle from `ref` to `direction`, counter-clockwise seen against
/// `axis`.
double pseudo_angle(const Vec3& ref, const Vec3& direction, const Vec3& axis) {
    const double along = ref.dot(direction), across = axis.dot(ref.cross(direction));
    const double share = along / (std::abs(along) + std::abs(across));
    return across >= 0 ? 1 - share : 3 + share;
}

/// The end of the boundary edge that follows edge from → vertex around the hole on its right.
u32 next_on_hole(const Surface& surface, u32 from, u32 vertex) {
    const auto& p = surface.positions;
    const Vec3 back = p[from] - p[vertex];
    u32 next = invalid_index;
    double least = infinity;
    surface.fans.any(vertex, [&](const Fans::LinkEdge& edge) {
        if (surface.fans.right_of(vertex, edge.first) != invalid_index) return false;
        const double angle = pseudo_angle(back, p[edge.first] - p[vertex], surface.normals[vertex]);
        if (next == invalid_index || angle < least || (angle == least && edge.first < next)) {
            next = edge.first;
            least = angle;
        }
        return false;
    });
    return next;
}

/// The vertices of the loop that starts with edge from → to, in reverse order. Empty if the loop has more than
/// `most_edges` edges or passes a vertex twice.
std::vector<u32> hole_at(const Surface& surface, u32 from, u32 to, std::size_t most_edges) {
    std::vector<u32> loop{from};
    for (u32 before = from, vertex = to; vertex != from;) {
        if (loop.size() == most_edges || std::ranges::find(loop, vertex) != loop.end()) return {};
        loop.push_back(vertex);
        before = std::exchange(vertex, next_on_hole(surface, before, vertex));
    }
    // Where several fans meet, the walk may return to its first vertex in another fan.
    if (next_on_hole(surface, loop.back(), from) != to) return {};
    std::ranges::reverse(loop);
    return loop;
}

/// The extent of a boundary loop, and the orientation of the triangles around it.
struct LoopShape {
    double farthest = 0;  ///< largest distance of a corner from the loop's centre
    double facing = 0;  ///< mean cosine, weighted by length, between a lid's normal and those around the loop
    double largest_radius = 0;  ///< largest search radius of the corners
    /// Least cosine between the normals of any two triangles around the loop; 1 without `compare`.
    double least_cosine = 1;

    /// The lid is the set of triangles that would close the loop. `corners` have its counter-clockwise order.
    LoopShape(const Surface& surface, std::span<const u32> corners, bool compare) {
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
        const Vec3 lid_normal = area.normalized();
        std::vector<Vec3> normals;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const u32 a = corners[i], b = next(i);
            const Vec3 normal = surface.facet_normal(b, a, surface.fans.left_of(b, a));
            for (const Vec3& other : normals) least_cosine = std::min(least_cosine, normal.dot(other));
            if (compare) normals.push_back(normal);
            facing += (p[b] - p[a]).norm() / length * normal.dot(lid_normal);
            farthest = std::max(farthest, (p[a] - centre).norm());
            largest_radius = std::max(largest_radius, surface.search_radius[a]);
        }
    }
};

class NarrowHoleCloser {
public:
    NarrowHoleCloser(Surface& surface, const NarrowHoleLimits& limits, const Execution& execution)
        : surface_(surface),
          narrow_(limits),
          dihedral_cosine_(std::max(tip_cosine, elementary::turn_of(limits.largest_dihedral).cosine - 1e-9)),
          execution_(execution) {}

    /// Closes the loop if possible; returns whether it did. `corners` have the counter-clockwise order of the new
    /// triangles.
    bool close(const std::vector<u32>& corners) {
        execution_.check_cancelled();
        const bool of_any_size = corners.size() <= narrow_.most_edges;
        const bool ends_at_sharp_edges = !of_any_size && dihedral_cosine_ > tip_cosine;
        const LoopShape loop(surface_, corners, ends_at_sharp_edges);
        const double radius = narrow_.largest_radius * loop.largest_radius;
        const bool is_long = loop.farthest > long_in_radii * radius;
        if (loop.facing < (is_long ? least_facing_of_long : least_facing)) return false;
        if (ends_at_sharp_edges && loop.least_cosine < dihedral_cosine_) return false;
        limits_ = {of_any_size ? infinity : radius, of_any_size ? tip_cosine : dihedral_cosine_, narrow_.longest_edge};
        if (triangulate(corners, 0)) return true;
        // If every triangulation needs larger triangles, replacing a triangle makes the hole even larger.
        if (corners.size() > most_corners[1] ||
            !can_be_triangulated(surface_, corners, {limits_.largest_radius, any_dihedral, narrow_.longest_edge}))
            return false;
        return triangulate(corners, 1) || (corners.size() <= most_corners[2] && triangulate(corners, 2));
    }

    std::vector<Triangle> replaced;

private:
    bool triangulate(const std::vector<u32>& corners, std::size_t replacements) {
        if (replacements > 0) return replace(corners, replacements);
        const std::vector<Triangle> triangles = triangulate_hole(surface_, near_, corners, limits_);
        for (const Triangle& triangle : triangles) surface_.add(triangle, closing_pass);
        return !triangles.empty();
    }

    /// Removes the triangle at each edge in turn and triangulates the larger hole.
    bool replace(const std::vector<u32>& corners, std::size_t replacements) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const u32 from = corners[i], to = corners[i + 1 < corners.size() ? i + 1 : 0];
            const u32 third = surface_.fans.left_of(to, from);
            // A point on the boundary would become a corner of two loops, or twice a corner of this one.
            if (surface_.states[third] != PointState::interior || std::ranges::find(corners, third) != corners.end())
                continue;
            const Triangle obstacle{to, from, third};
            std::vector<u32> larger = corners;
            larger.insert(larger.begin() + static_cast<std::ptrdiff_t>(i) + 1, third);
            execution_.check_cancelled();
            surface_.fans.remove(obstacle);
            if (triangulate(larger, replacements - 1)) {
                replaced.push_back(obstacle);
                return true;
            }
            surface_.fans.add(obstacle);
        }
        return false;
    }

    Surface& surface_;
    NarrowHoleLimits narrow_;
    double dihedral_cosine_;
    const Execution& execution_;
    TriangulationLimits limits_{};
    NearTriangles near_;
};

}  // namespace

bool can_be_triangulated(const Surface& surface, const std::vector<u32>& corners, const TriangulationLimits& limits) {
    const NearTriangles none;
    return !least_triangulation(surface, none, corners, limits).empty();
}

std::vector<Triangle> triangulate_hole(const Surface& surface, NearTriangles& near, const std::vector<u32>& corners,
                                       const TriangulationLimits& limits) {
    // The first attempt ignores obstacles, because obstacles are rare. If it finds no triangulation, none exists with
    // obstacles.
    const NearTriangles none;
    std::vector<Triangle> triangles = least_triangulation(surface, none, corners, limits);
    if (triangles.empty()) return {};
    near.gather_around(surface, corners);
    if (std::ranges::any_of(triangles, [&](const Triangle& t) { return near.intersect(surface, t); }))
        triangles = least_triangulation(surface, near, corners, limits);
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (triangles_intersect(surface.positions, triangles[i], triangles[j])) return {};
    return triangles;
}

std::size_t close_small_holes(Surface& surface, std::size_t most_edges, const Execution& execution,
                              double longest_edge) {
    if (most_edges < 3) return 0;
    const TriangulationLimits limits{infinity, fold_cosine, longest_edge};
    std::size_t closed = 0;
    // Each loop starts with its lowest corner. Closing other loops cannot make these loops possible: their boundary
    // edges keep their triangles, and free edges across them only become fewer.
    std::set<std::vector<u32>> impossible_loops;
    NearTriangles near;
    const std::size_t count = surface.triangles.size();
    for (std::size_t row = 0; row < count; ++row) {
        if (row % 1024 == 0) execution.check_cancelled();
        const Triangle triangle = surface.triangles[row];
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3];
            if (surface.states[from] == PointState::interior || surface.states[to] == PointState::interior ||
                surface.fans.right_of(from, to) != invalid_index)
                continue;
            const std::vector<u32> hole = hole_at(surface, from, to, most_edges);
            if (hole.size() < 3) continue;
            std::vector<u32> from_lowest = hole;
            std::ranges::rotate(from_lowest, std::ranges::min_element(from_lowest));
            if (impossible_loops.contains(from_lowest)) continue;
            execution.check_cancelled();  // a long loop takes as long as a million triangles
            const std::vector<Triangle> lid = triangulate_hole(surface, near, hole, limits);
            for (const Triangle& added : lid) surface.add(added, closing_pass);
            if (lid.empty())
                impossible_loops.insert(std::move(from_lowest));
            else
                ++closed;
        }
    }
    return closed;
}

NarrowHoles close_narrow_holes(Surface& surface, const NarrowHoleLimits& limits, const Execution& execution) {
    NarrowHoles result;
    NarrowHoleCloser closer(surface, limits, execution);
    surface.for_each_boundary_loop([&](std::vector<u32> loop) {
        if (loop.size() < 3 || loop.size() > most_corners[0]) return;
        std::ranges::reverse(loop);
        result.closed += closer.close(loop);
    });
    result.replaced = closer.replaced.size();
    surface.drop(std::move(closer.replaced));
    return result;
}

}  // namespace scanmill::growing
