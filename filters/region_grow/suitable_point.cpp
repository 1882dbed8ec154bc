// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/suitable_point.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "region_grow/sectors.hpp"

namespace scanmill::growing {

namespace {

/// Scores no farther apart than this, relative to 1 or to themselves, are equal: what rounding does to points of a
/// grid.
constexpr double same_score = 1e-9;

/// Of the neighbours' variance, across their plane: above this a point's normal tells nothing, at a tip.
constexpr float shapeless = 0.18f;

}  // namespace

LivePlaces::LivePlaces(const Surface& surface)
    : surface_(surface),
      leaves_(std::bit_ceil((surface.positions.size() + leaf_size - 1) / leaf_size)),
      nodes_(2 * leaves_ - 1) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (Node& node : nodes_) node = {Vec3::Constant(infinity), Vec3::Constant(-infinity), false};
    const auto widen = [](Node& node, const Node& by) {
        node = {node.low.cwiseMin(by.low), node.high.cwiseMax(by.high), node.live || by.live};
    };
    for (std::size_t place = 0; place < surface.positions.size(); ++place) {
        const Vec3& p = surface.positions[place];
        widen(nodes_[leaves_ - 1 + place / leaf_size], {p, p, true});
    }
    for (std::size_t node = leaves_ - 1; node-- > 0;) {
        widen(nodes_[node], nodes_[2 * node + 1]);
        widen(nodes_[node], nodes_[2 * node + 2]);
    }
}

void LivePlaces::within(u32 place, double squared, std::vector<u32>& found) { visit(0, place, squared, found); }

void LivePlaces::visit(std::size_t node, u32 place, double squared, std::vector<u32>& found) {
    Node& here = nodes_[node];
    if (!here.live) return;
    const Vec3& p = surface_.positions[place];
    if ((p.cwiseMax(here.low).cwiseMin(here.high) - p).squaredNorm() >= squared) return;
    if (node + 1 >= leaves_) {
        here.live = visit_leaf(node + 1 - leaves_, place, squared, found);
        return;
    }
    visit(2 * node + 1, place, squared, found);
    visit(2 * node + 2, place, squared, found);
    here.live = nodes_[2 * node + 1].live || nodes_[2 * node + 2].live;
}

bool LivePlaces::visit_leaf(std::size_t leaf, u32 place, double squared, std::vector<u32>& found) const {
    bool live = false;
    const std::size_t end = std::min((leaf + 1) * leaf_size, surface_.positions.size());
    for (u32 other = static_cast<u32>(leaf * leaf_size); other < end; ++other) {
        if (surface_.states[other] == PlaceState::interior) continue;
        live = true;
        if (other != place && (surface_.positions[other] - surface_.positions[place]).squaredNorm() < squared)
            found.push_back(other);
    }
    return live;
}

double PointChooser::search_radius(u32 from, u32 to) const {
    return std::max(surface_.search_radius[from], surface_.search_radius[to]);
}

void PointChooser::collect(u32 from, u32 to, double reach, bool far) {
    near_.clear();
    if (far) {
        const double squared = squared_range(reach);
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

bool PointChooser::may_find(u32 from, u32 to, const Vec3& joined, double reach, const Limits& limits) {
    const double squared = squared_range(reach);
    near_.clear();
    live_.within(from, squared, near_);
    if (score_ == Score::midpoint) live_.within(to, squared, near_);
    rate(from, to, joined, limits);
    const auto kept = std::partition(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
        return keeps_limits(from, to, candidate, limits, false) &&
               sectors_are_free({from, candidate.point, to}, candidate.normal, limits.pass);
    });
    return std::any_of(candidates_.begin(), kept, [&](const Candidate& candidate) {
        // The others are turned down before it is looked at, unless their scores might count as equal.
        const double lower = candidate.score - 3 * same_score * (1 + std::abs(candidate.score));
        turned_down_.clear();
        std::copy_if(kept, candidates_.end(), std::back_inserter(turned_down_),
                     [&](const Candidate& other) { return other.score < lower; });
        return !lies_over_others({from, candidate.point, to}, candidate.normal);
    });
}

double PointChooser::squared_range(double reach) const {
    // In a circle through the edge's ends no two points are farther apart than its diameter.
    const double radius = score_ == Score::midpoint ? reach : 2 * largest_circle * reach;
    return radius * radius;
}

void PointChooser::rate(u32 from, u32 to, const Vec3& joined, const Limits& limits) {
    const Vec3 &a = surface_.positions[from], &b = surface_.positions[to];
    const Vec3 middle = (a + b) / 2;
    const double half_squared = (b - a).squaredNorm() / 4;
    const double reach = search_radius(from, to) * limits.reach;
    const double largest = largest_circle * reach;
    const double cotangent_squared = score_ == Score::midpoint ? std::numeric_limits<double>::infinity()
                                                               : std::max(0.0, largest * largest / half_squared - 1);
    const double least_bend = limits.normal_cosine * std::abs(limits.normal_cosine);
    candidates_.clear();
    fronts_.clear();
    for (u32 point : near_) {
        if (point == from || point == to) continue;
        if (surface_.states[point] == PlaceState::front) fronts_.push_back(point);
        const Vec3 &d = surface_.positions[point], to_a = a - d, to_b = b - d;
        const Vec3 normal = to_b.cross(to_a);
        // Most places fall here, so roots and quotients come later.
        const double area_squared = normal.squaredNorm(), along = to_a.dot(to_b), bend = joined.dot(normal);
        if (!(area_squared > 0) || along * along > cotangent_squared * area_squared) continue;
        if (bend * std::abs(bend) < least_bend * area_squared) continue;
        const double twice_area = std::sqrt(area_squared);
        // The circumcentre lies this many halves of the edge beyond its middle.
        const double cotangent = along / twice_area;
        if (score_ == Score::midpoint && std::min(to_a.squaredNorm(), to_b.squaredNorm()) > reach * reach) continue;
        const double score = score_ == Score::midpoint ? (d - middle).squaredNorm() / half_squared : cotangent;
        candidates_.push_back({score, point, normal / twice_area});
    }
}

PointChooser::Candidate PointChooser::take_best() {
    double least = std::numeric_limits<double>::infinity();
    if (equal_.empty()) least = candidates_.front().score;
    for (const Candidate& candidate : equal_) least = std::min(least, candidate.score);
    const double most = least + same_score * (1 + std::abs(least));
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

void PointChooser::put_in_order() {
    equal_.clear();
    turned_down_.clear();
    std::ranges::make_heap(candidates_, std::greater(), &Candidate::score);
}

SuitablePoint PointChooser::choose(u32 from, u32 to, const Limits& limits, bool far, bool in_space) {
    const Vec3 joined = surface_.facet_normal(from, to, surface_.fans.left_of(from, to));
    const double reach_here = search_radius(from, to) * limits.reach;
    if (far && !may_find(from, to, joined, reach_here, limits)) return {};
    collect(from, to, reach_here, far);
    rate(from, to, joined, limits);
    put_in_order();
    const double half = (surface_.positions[to] - surface_.positions[from]).norm() / 2;
    while (has_candidates()) {
        const Candidate candidate = take_best();
        const auto faces_away = [&](u32 x) { return surface_.normals[x].dot(candidate.normal) < 0; };
        if (!is_suitable(from, to, candidate, limits, false) ||
            ((in_space || std::ranges::any_of(fronts_, faces_away)) &&
             passes_through_others({from, candidate.point, to}))) {
            turned_down_.push_back(candidate);
            continue;
        }
        SuitablePoint result{candidate.point, false, false};
        if (!far) {
            const double reach =
                std::min(surface_.neighbourhoods.squared_reach(from), surface_.neighbourhoods.squared_reach(to));
            const double s = candidate.score;
            // How far from the edge's ends the nearest of them lets a better point be: the top of the circle's arc, or
            // the circle round the middle.
            const double top = score_ == Score::midpoint ? half * (1 + std::sqrt(s))
                                                         : half * std::hypot(1.0, s + std::sqrt(1 + s * s));
            result.uncovered = top * top > reach;
        }
        const double usual = largest_circle * std::max(surface_.usual_radius[from], surface_.usual_radius[to]);
        const double radius = half * std::sqrt(1 + candidate.score * candidate.score);
        result.plain = joined.dot(candidate.normal) > 0.75 && radius < 0.6 * usual && turned_down_.empty();
        return result;
    }
    return {nobody, false, !far};
}

u32 PointChooser::beyond_sharp_edge(u32 from, u32 to, const Limits& limits) {
    const Vec3 joined = surface_.facet_normal(from, to, surface_.fans.left_of(from, to));
    const double reach = search_radius(from, to) * limits.reach;
    Limits bent = limits;
    bent.normal_cosine = least_bend_cosine;
    if (!may_find(from, to, joined, reach, bent)) return nobody;
    collect(from, to, reach, true);
    rate(from, to, joined, bent);
    put_in_order();
    while (has_candidates()) {
        const Candidate candidate = take_best();
        if (joined.dot(candidate.normal) < limits.normal_cosine &&
            surface_.states[candidate.point] == PlaceState::front && !is_neighbour(candidate.point, from) &&
            !is_neighbour(candidate.point, to) && is_suitable(from, to, candidate, limits, false))
            return candidate.point;
        turned_down_.push_back(candidate);
    }
    return nobody;
}

u32 PointChooser::choose_third(u32 from, u32 to, const Limits& limits) {
    collect(from, to, search_radius(from, to) * limits.reach, true);
    Limits any_side = limits;
    any_side.normal_cosine = -1;
    rate(from, to, Vec3::Zero(), any_side);
    u32 best = nobody;
    double least = std::numeric_limits<double>::infinity();
    for (Candidate& candidate : candidates_) {
        if (surface_.states[candidate.point] != PlaceState::unused) continue;
        if (surface_.normals[from].dot(candidate.normal) < 0) candidate.normal = -candidate.normal;
        if (!is_suitable(from, to, candidate, limits, true)) continue;
        const double margin = same_score * (1 + std::abs(least));
        if (best != nobody &&
            (candidate.score > least + margin || (candidate.score >= least - margin && candidate.point > best)))
            continue;
        best = candidate.point;
        least = std::min(least, candidate.score);
    }
    return best;
}

bool PointChooser::agrees_with_points(const Triangle& triangle, const Vec3& normal, const Limits& limits) const {
    return std::ranges::all_of(triangle, [&](u32 corner) {
        const double cosine = surface_.normals[corner].dot(normal);
        const bool sign_counts = surface_.oriented || surface_.states[corner] != PlaceState::unused;
        const float roughness = surface_.roughness[corner];
        if (roughness > shapeless) return true;
        const double least = roughness > rough ? limits.rough_cosine : limits.point_cosine;
        return (sign_counts ? cosine : std::abs(cosine)) >= least;
    });
}

bool PointChooser::agrees_with_joined(u32 from, u32 to, const Vec3& normal, double least) const {
    const u32 third = surface_.fans.left_of(to, from);
    return third == nobody || surface_.facet_normal(to, from, third).dot(normal) >= least;
}

Vec3 PointChooser::fan_axis(u32 vertex, const Vec3& more) const {
    Vec3 sum = more;
    surface_.fans.any(vertex, [&](const Fans::Pair& pair) {
        sum += surface_.facet_normal(vertex, pair.first, pair.last);
        return false;
    });
    return sum.normalized();
}

bool PointChooser::sectors_are_free(const Triangle& triangle, const Vec3& normal, Pass pass) const {
    for (std::size_t i = 0; i < 3; ++i) {
        const u32 corner = triangle[i];
        if (surface_.fans.empty(corner)) continue;
        const Vec3 axis = pass == 0 ? surface_.normals[corner] : fan_axis(corner, normal);
        if (!sector_is_free(surface_, corner, triangle[(i + 1) % 3], triangle[(i + 2) % 3], axis)) return false;
    }
    return true;
}

bool PointChooser::lies_over_others(const Triangle& triangle, const Vec3& normal) {
    const auto& p = surface_.positions;
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, (p[triangle[(i + 1) % 3]] - p[triangle[i]]).norm());
    const double height = longest / 2;
    const auto on_this_sheet = [&](u32 x) {
        return (surface_.states[x] == PlaceState::unused && !surface_.oriented) || surface_.normals[x].dot(normal) > 0;
    };
    for (const Candidate& other : turned_down_)
        if (on_this_sheet(other.point) && std::abs(normal.dot(p[other.point] - p[triangle[0]])) < height &&
            lies_over(surface_, triangle, normal, other.point))
            return true;
    for (u32 x : fronts_) {
        if (x == triangle[1] || !on_this_sheet(x)) continue;
        if (border_crosses(surface_, x, triangle[0], triangle[1], triangle[2], normal, height)) return true;
    }
    return false;
}

bool PointChooser::has_good_angles(u32 from, u32 to, u32 point, const Limits& limits) const {
    const auto& p = surface_.positions;
    const double a = (p[point] - p[to]).norm(), b = (p[point] - p[from]).norm(), c = (p[to] - p[from]).norm();
    // The smallest angle is opposite the shortest side; its sine is that side over the diameter of the circumcircle.
    const double twice_area = (p[point] - p[from]).cross(p[to] - p[from]).norm();
    return std::min({a, b, c}) * twice_area >= limits.least_sine * a * b * c;
}

bool PointChooser::keeps_limits(u32 from, u32 to, const Candidate& candidate, const Limits& limits,
                                bool new_surface) const {
    const u32 point = candidate.point;
    if (surface_.states[point] == PlaceState::interior || !has_good_angles(from, to, point, limits)) return false;
    const Triangle triangle{from, point, to};
    if (!agrees_with_points(triangle, candidate.normal, limits)) return false;
    if (new_surface) return true;
    const Fans& fans = surface_.fans;
    if (fans.left_of(from, point) != nobody || fans.left_of(point, to) != nobody) return false;
    if (!agrees_with_joined(from, point, candidate.normal, limits.normal_cosine) ||
        !agrees_with_joined(point, to, candidate.normal, limits.normal_cosine))
        return false;
    // A triangle that joins those at the point in nothing but the point: the next ones will join them at edges.
    const bool touches = !fans.empty(point) && fans.left_of(point, from) == nobody && fans.left_of(to, point) == nobody;
    return !touches || fan_axis(point, Vec3::Zero()).dot(candidate.normal) >= limits.touch_cosine;
}

bool PointChooser::is_suitable(u32 from, u32 to, const Candidate& candidate, const Limits& limits, bool new_surface) {
    if (!keeps_limits(from, to, candidate, limits, new_surface)) return false;
    if (new_surface) return true;
    const Triangle triangle{from, candidate.point, to};
    return sectors_are_free(triangle, candidate.normal, limits.pass) && !lies_over_others(triangle, candidate.normal);
}

bool PointChooser::passes_through_others(const Triangle& triangle) {
    near_triangles_.gather_near(surface_, triangle);
    return near_triangles_.meet(surface_, triangle);
}

bool PointChooser::is_neighbour(u32 point, u32 vertex) const {
    return surface_.fans.any(vertex, [&](const Fans::Pair& pair) { return pair.first == point || pair.last == point; });
}

}  // namespace scanmill::growing
