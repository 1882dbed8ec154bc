// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/suitable_point.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "scanmill/geometry/growing/overlaps.hpp"

namespace scanmill::growing {

namespace {

/// Scores that differ by less than this, relative to 1 + |score|, are equal. This allows for rounding at points of a
/// grid.
constexpr double score_tolerance = 1e-9;

}  // namespace

OpenPoints::OpenPoints(const Surface& surface)
    : surface_(surface),
      leaves_(std::bit_ceil((surface.positions.size() + leaf_size - 1) / leaf_size)),
      nodes_(2 * leaves_ - 1) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (Node& node : nodes_) node = {Vec3::Constant(infinity), Vec3::Constant(-infinity), false};
    const auto extend = [](Node& node, const Node& by) {
        node = {node.low.cwiseMin(by.low), node.high.cwiseMax(by.high), node.open || by.open};
    };
    for (std::size_t point = 0; point < surface.positions.size(); ++point) {
        const Vec3& p = surface.positions[point];
        extend(nodes_[leaves_ - 1 + point / leaf_size], {p, p, true});
    }
    for (std::size_t node = leaves_ - 1; node-- > 0;) {
        extend(nodes_[node], nodes_[2 * node + 1]);
        extend(nodes_[node], nodes_[2 * node + 2]);
    }
}

void OpenPoints::within(u32 point, double squared, std::vector<u32>& found) { visit(0, point, squared, found); }

void OpenPoints::visit(std::size_t node, u32 point, double squared, std::vector<u32>& found) {
    Node& here = nodes_[node];
    if (!here.open) return;
    const Vec3& p = surface_.positions[point];
    if ((p.cwiseMax(here.low).cwiseMin(here.high) - p).squaredNorm() >= squared) return;
    if (node + 1 >= leaves_) {
        here.open = visit_leaf(node + 1 - leaves_, point, squared, found);
        return;
    }
    visit(2 * node + 1, point, squared, found);
    visit(2 * node + 2, point, squared, found);
    here.open = nodes_[2 * node + 1].open || nodes_[2 * node + 2].open;
}

bool OpenPoints::visit_leaf(std::size_t leaf, u32 point, double squared, std::vector<u32>& found) const {
    bool open = false;
    const std::size_t end = std::min((leaf + 1) * leaf_size, surface_.positions.size());
    for (u32 other = static_cast<u32>(leaf * leaf_size); other < end; ++other) {
        if (surface_.states[other] == PointState::interior) continue;
        open = true;
        if (other != point && (surface_.positions[other] - surface_.positions[point]).squaredNorm() < squared)
            found.push_back(other);
    }
    return open;
}

double PointChooser::search_radius(u32 from, u32 to) const {
    return std::max(surface_.search_radius[from], surface_.search_radius[to]);
}

double PointChooser::squared_search_range(double radius) const {
    // Two points of a circle through the edge's ends are at most its diameter apart.
    const double range = score_ == Score::midpoint ? radius : 2 * largest_empty_circle * radius;
    return range * range;
}

void PointChooser::collect(u32 from, u32 to, double radius, bool wide) {
    near_.clear();
    if (wide) {
        const double squared = squared_search_range(radius);
        surface_.neighbourhoods.within(from, squared, buffer_, near_);
        if (score_ == Score::midpoint) {
            surface_.neighbourhoods.within(to, squared, buffer_, near_);
            std::ranges::sort(near_);
            near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
        }
        return;
    }
    const auto first = surface_.neighbourhoods.of(from);
    near_.assign(first.begin(), first.end());
    for (u32 other : surface_.neighbourhoods.of(to))
        if (std::ranges::find(first, other) == first.end()) near_.push_back(other);
}

void PointChooser::rate(u32 from, u32 to, const Vec3& joined, const Limits& limits) {
    const Vec3 &a = surface_.positions[from], &b = surface_.positions[to];
    const Vec3 middle = (a + b) / 2;
    const double half_squared = (b - a).squaredNorm() / 4;
    const double radius = search_radius(from, to) * limits.radius_factor;
    const double largest = largest_empty_circle * radius;
    const double cotangent_squared = score_ == Score::midpoint ? std::numeric_limits<double>::infinity()
                                                               : std::max(0.0, largest * largest / half_squared - 1);
    const double normal_cosine = least_cosine_across(from, to, limits.normal_cosine);
    const double least_squared_cosine = normal_cosine * std::abs(normal_cosine);  // with its sign
    candidates_.clear();
    boundary_points_.clear();
    for (u32 point : near_) {
        if (point == from || point == to) continue;
        if (surface_.states[point] == PointState::front) boundary_points_.push_back(point);
        const Vec3 &d = surface_.positions[point], to_a = a - d, to_b = b - d;
        const Vec3 normal = to_b.cross(to_a);
        // Most points fail these tests, so roots and quotients come later.
        const double area_squared = normal.squaredNorm(), along = to_a.dot(to_b), cosine = joined.dot(normal);
        if (!(area_squared > 0) || along * along > cotangent_squared * area_squared) continue;
        if (cosine * std::abs(cosine) < least_squared_cosine * area_squared) continue;
        const double twice_area = std::sqrt(area_squared);
        // The signed distance of the circumcentre from the edge's middle, as a multiple of half the edge.
        const double cotangent = along / twice_area;
        if (score_ == Score::midpoint && std::min(to_a.squaredNorm(), to_b.squaredNorm()) > radius * radius) continue;
        const double score = score_ == Score::midpoint ? (d - middle).squaredNorm() / half_squared : cotangent;
        candidates_.push_back({score, point, normal / twice_area});
    }
}

bool PointChooser::may_find(u32 from, u32 to, const Vec3& joined, double radius, const Limits& limits) {
    const double squared = squared_search_range(radius);
    near_.clear();
    open_points_.within(from, squared, near_);
    if (score_ == Score::midpoint) open_points_.within(to, squared, near_);
    rate(from, to, joined, limits);
    const auto kept = std::partition(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
        return satisfies_limits(from, to, candidate, limits, false) &&
               sectors_are_free(surface_, {from, candidate.point, to}, candidate.normal, limits.pass != 0);
    });
    return std::any_of(candidates_.begin(), kept, [&](const Candidate& candidate) {
        // Candidates with lower scores are rejected before this one is considered, unless their scores may count as
        // equal.
        const double lower = candidate.score - 3 * score_tolerance * (1 + std::abs(candidate.score));
        rejected_.clear();
        std::copy_if(kept, candidates_.end(), std::back_inserter(rejected_),
                     [&](const Candidate& other) { return other.score < lower; });
        return !overlaps_others({from, candidate.point, to}, candidate.normal);
    });
}

void PointChooser::start_ranking() {
    equal_.clear();
    rejected_.clear();
    std::ranges::make_heap(candidates_, std::greater(), &Candidate::score);
}

PointChooser::Candidate PointChooser::take_best() {
    double least = std::numeric_limits<double>::infinity();
    if (equal_.empty()) least = candidates_.front().score;
    for (const Candidate& candidate : equal_) least = std::min(least, candidate.score);
    const double most = least + score_tolerance * (1 + std::abs(least));
    while (!candidates_.empty() && candidates_.front().score <= most) {
        std::ranges::pop_heap(candidates_, std::greater(), &Candidate::score);
        equal_.push_back(candidates_.back());
        candidates_.pop_back();
    }
    const auto best = std::ranges::min_element(equal_, {}, &Candidate::point);
    const Candidate taken = *best;
    *best = equal_.back();
    equal_.pop_back();
    return taken;
}

SuitablePoint PointChooser::choose(u32 from, u32 to, const Limits& limits, bool wide, bool in_space) {
    const Vec3 joined = surface_.facet_normal(from, to, surface_.fans.left_of(from, to));
    const double radius = search_radius(from, to) * limits.radius_factor;
    if (wide && !may_find(from, to, joined, radius, limits)) return {};
    collect(from, to, radius, wide);
    rate(from, to, joined, limits);
    start_ranking();
    const double half = (surface_.positions[to] - surface_.positions[from]).norm() / 2;
    while (has_candidates()) {
        const Candidate candidate = take_best();
        const auto faces_away = [&](u32 x) { return surface_.normals[x].dot(candidate.normal) < 0; };
        if (!is_suitable(from, to, candidate, limits, false) ||
            ((in_space || std::ranges::any_of(boundary_points_, faces_away)) &&
             intersects_surface({from, candidate.point, to}))) {
            rejected_.push_back(candidate);
            continue;
        }
        SuitablePoint result{candidate.point, false, false};
        if (!wide) {
            const double reach =
                std::min(surface_.neighbourhoods.squared_reach(from), surface_.neighbourhoods.squared_reach(to));
            const double s = candidate.score;
            // A better point is at most this far from the nearer end of the edge: at the top of the circle's arc, or of
            // the circle around the middle.
            const double sum = s + std::sqrt(1 + s * s);
            const double top = half * (score_ == Score::midpoint ? 1 + std::sqrt(s) : std::sqrt(1 + sum * sum));
            result.uncovered = top * top > reach;
        }
        const double usual =
            largest_empty_circle * std::max(surface_.density_radius[from], surface_.density_radius[to]);
        const double circumradius = half * std::sqrt(1 + candidate.score * candidate.score);
        result.certain = joined.dot(candidate.normal) > 0.75 && circumradius < 0.6 * usual && rejected_.empty();
        return result;
    }
    return {invalid_index, false, !wide};
}

u32 PointChooser::beyond_sharp_edge(u32 from, u32 to, const Limits& limits) {
    const Vec3 joined = surface_.facet_normal(from, to, surface_.fans.left_of(from, to));
    const double radius = search_radius(from, to) * limits.radius_factor;
    Limits any_angle = limits;
    any_angle.normal_cosine = fold_cosine;
    if (!may_find(from, to, joined, radius, any_angle)) return invalid_index;
    collect(from, to, radius, true);
    rate(from, to, joined, any_angle);
    start_ranking();
    while (has_candidates()) {
        const Candidate candidate = take_best();
        if (joined.dot(candidate.normal) < limits.normal_cosine &&
            surface_.states[candidate.point] == PointState::front && !is_neighbour(candidate.point, from) &&
            !is_neighbour(candidate.point, to) && is_suitable(from, to, candidate, limits, false))
            return candidate.point;
        rejected_.push_back(candidate);
    }
    return invalid_index;
}

u32 PointChooser::choose_third(u32 from, u32 to, const Limits& limits) {
    collect(from, to, search_radius(from, to) * limits.radius_factor, true);
    Limits any_side = limits;
    any_side.normal_cosine = -1;
    rate(from, to, Vec3::Zero(), any_side);
    u32 best = invalid_index;
    double least = std::numeric_limits<double>::infinity();
    for (Candidate& candidate : candidates_) {
        if (surface_.states[candidate.point] != PointState::unused) continue;
        if (surface_.normals[from].dot(candidate.normal) < 0) candidate.normal = -candidate.normal;
        if (!is_suitable(from, to, candidate, limits, true)) continue;
        const double margin = score_tolerance * (1 + std::abs(least));
        if (best != invalid_index &&
            (candidate.score > least + margin || (candidate.score >= least - margin && candidate.point > best)))
            continue;
        best = candidate.point;
        least = std::min(least, candidate.score);
    }
    return best;
}

bool PointChooser::intersects_surface(const Triangle& triangle) {
    near_triangles_.gather_near(surface_, triangle);
    return near_triangles_.intersect(surface_, triangle);
}

bool PointChooser::is_suitable(u32 from, u32 to, const Candidate& candidate, const Limits& limits, bool is_seed) {
    if (!satisfies_limits(from, to, candidate, limits, is_seed)) return false;
    if (is_seed) return true;
    const Triangle triangle{from, candidate.point, to};
    return sectors_are_free(surface_, triangle, candidate.normal, limits.pass != 0) &&
           !overlaps_others(triangle, candidate.normal);
}

bool PointChooser::satisfies_limits(u32 from, u32 to, const Candidate& candidate, const Limits& limits,
                                    bool is_seed) const {
    const u32 point = candidate.point;
    const Triangle triangle{from, point, to};
    if (surface_.edge_sides.apart(from, point) || surface_.edge_sides.apart(point, to)) return false;
    if (surface_.states[point] == PointState::interior || !has_angles_of(surface_, triangle, limits.least_sine))
        return false;
    if (!agrees_with_points(surface_, triangle, candidate.normal, limits.point_cosine, limits.sharp_cosine) ||
        crosses_fixed_edge(surface_, triangle, candidate.normal, near_))
        return false;
    if (is_seed) return true;
    const Fans& fans = surface_.fans;
    if (fans.left_of(from, point) != invalid_index || fans.left_of(point, to) != invalid_index) return false;
    if (!agrees_with_joined(from, point, candidate.normal, limits.normal_cosine) ||
        !agrees_with_joined(point, to, candidate.normal, limits.normal_cosine))
        return false;
    // The triangle shares only the point with the triangles at the point. Later triangles will connect them.
    const bool touches =
        !fans.empty(point) && fans.left_of(point, from) == invalid_index && fans.left_of(to, point) == invalid_index;
    return !touches || fan_normal(surface_, point, Vec3::Zero()).dot(candidate.normal) >= limits.touch_cosine;
}

bool PointChooser::agrees_with_joined(u32 from, u32 to, const Vec3& normal, double least_cosine) const {
    const u32 third = surface_.fans.left_of(to, from);
    return third == invalid_index ||
           surface_.facet_normal(to, from, third).dot(normal) >= least_cosine_across(from, to, least_cosine);
}

double PointChooser::least_cosine_across(u32 from, u32 to, double usual) const {
    return surface_.fixed_edges.contains(from, to) ? fold_cosine : usual;
}

bool PointChooser::overlaps_others(const Triangle& triangle, const Vec3& normal) {
    const auto& p = surface_.positions;
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, (p[triangle[(i + 1) % 3]] - p[triangle[i]]).norm());
    const double height = longest / 2;
    const auto on_this_sheet = [&](u32 x) {
        return (surface_.states[x] == PointState::unused && !surface_.oriented) || surface_.normals[x].dot(normal) > 0;
    };
    for (const Candidate& other : rejected_)
        if (on_this_sheet(other.point) && std::abs(normal.dot(p[other.point] - p[triangle[0]])) < height &&
            contains(surface_, triangle, normal, other.point))
            return true;
    for (u32 x : boundary_points_) {
        if (x == triangle[1] || !on_this_sheet(x)) continue;
        if (boundary_crosses(surface_, x, triangle[0], triangle[1], triangle[2], normal, height)) return true;
    }
    return false;
}

bool PointChooser::is_neighbour(u32 point, u32 vertex) const {
    return surface_.fans.any(vertex,
                             [&](const Fans::LinkEdge& edge) { return edge.first == point || edge.last == point; });
}

}  // namespace scanmill::growing
