// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/edge_sides.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace scanmill::growing {

namespace {

// Lengths in spacings.
constexpr double reach = 3;
constexpr double beyond_end = 1;
constexpr double near_side = 1.0 / 3;
constexpr double normal_reach = 1.5;
constexpr double smooth_cosine = 0.8191520442889918;  // 35 degrees
constexpr double narrow_cosine = 0.9659258262890683;  // 15 degrees
constexpr std::size_t most_points = 48;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A point beside an edge.
struct Beside {
    u32 point;
    bool inside;
    double distance;  ///< from the edge's line
    Vec3 across;  ///< from its foot to the point
};

/// Distance of a point from the half-plane that begins at the edge's line with the unit vector `direction`.
double distance_from(const Beside& beside, const Vec3& direction) {
    const double along = beside.across.dot(direction);
    return along > 0 ? (beside.across - along * direction).norm() : beside.distance;
}

using Sides = std::array<Vec3, 2>;

/// The pair of half-planes with most points near it, each through the mean of its points.
std::optional<Sides> best_sides(std::span<const Beside> beside, double tolerance) {
    const std::size_t count = beside.size();
    std::vector<Vec3> directions;
    for (const Beside& b : beside) directions.push_back(b.across / b.distance);
    std::vector<double> weights(count * count);  // by direction and point
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < count; ++k) {
            const double share = distance_from(beside[k], directions[i]) / tolerance;
            weights[i * count + k] = std::max(0.0, 1 - share * share);
        }
    double most = 0;
    std::optional<Sides> best;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            double sum = 0;
            for (std::size_t k = 0; k < count; ++k) sum += std::max(weights[i * count + k], weights[j * count + k]);
            if (sum > most) {
                most = sum;
                best = {directions[j], directions[i]};
            }
        }
    if (!best) return std::nullopt;
    Sides sums{Vec3::Zero(), Vec3::Zero()};
    std::array<std::size_t, 2> counts{};
    for (const Beside& b : beside) {
        const double first = distance_from(b, (*best)[0]), second = distance_from(b, (*best)[1]);
        if (std::min(first, second) > tolerance) continue;
        sums[second < first] += b.across;
        ++counts[second < first];
    }
    if (std::min(counts[0], counts[1]) < 2) return std::nullopt;
    const Sides sides{sums[0].normalized(), sums[1].normalized()};
    return sides[0].dot(sides[1]) < narrow_cosine ? std::optional(sides) : std::nullopt;
}

/// Whether another fixed edge continues from → to beyond `to`, nearly straight.
bool continues(const DistinctPoints& points, const FixedEdges& fixed, u32 from, u32 to) {
    const Vec3 along = (points.positions[to] - points.positions[from]).normalized();
    return std::ranges::any_of(fixed.of(to), [&](u32 next) {
        return next != from && (points.positions[next] - points.positions[to]).normalized().dot(along) > smooth_cosine;
    });
}

}  // namespace

EdgeSides::EdgeSides(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, const FixedEdges& fixed,
                     std::span<const std::array<u32, 2>> edges, std::span<const double> spacings)
    : begin_(points.size() + 1, 0),
      normals_(points.size()) {
    std::ranges::fill(normals_, Vec3::Zero());
    std::vector<double> nearest(points.size(), infinity);
    std::vector<std::pair<u32, Label>> found;
    NeighbourBuffer buffer;
    std::vector<u32> near;
    std::vector<Beside> beside;
    for (u32 edge = 0; edge < edges.size(); ++edge) {
        const auto [from, to] = edges[edge];
        const Vec3 &a = points.positions[from], &b = points.positions[to];
        const double spacing = spacings[edge], length = (b - a).norm();
        const Vec3 along = (b - a) / length;
        const double before = continues(points, fixed, to, from) ? beyond_end * spacing : 0;
        const double after = continues(points, fixed, from, to) ? beyond_end * spacing : 0;
        near.clear();
        const double radius = reach * spacing + length + std::max(before, after);
        neighbourhoods.within(from, radius * radius, buffer, near);
        std::ranges::sort(near);
        beside.clear();
        for (const u32 point : near) {
            if (fixed.at(point)) continue;
            const Vec3 offset = points.positions[point] - a;
            const double foot = offset.dot(along);
            if (foot < -before || foot > length + after) continue;
            const Vec3 across = offset - foot * along;
            const double distance = across.norm();
            if (distance > 0 && distance <= reach * spacing)
                beside.push_back({point, foot >= 0 && foot <= length, distance, across});
        }
        std::ranges::stable_sort(beside, {}, &Beside::distance);
        const std::size_t used = std::min(beside.size(), most_points);
        const std::optional<Sides> sides = best_sides(std::span(beside).first(used), near_side * spacing);
        if (!sides) continue;
        for (const Beside& near_edge : beside) {
            const double first = distance_from(near_edge, (*sides)[0]), second = distance_from(near_edge, (*sides)[1]);
            if (std::min(first, second) > near_side * spacing) continue;
            const bool is_second = second < first;
            found.push_back({near_edge.point, {edge, is_second, near_edge.inside}});
            if (near_edge.inside && near_edge.distance < normal_reach * spacing &&
                near_edge.distance < nearest[near_edge.point]) {
                nearest[near_edge.point] = near_edge.distance;
                normals_[near_edge.point] = along.cross((*sides)[is_second]);
            }
        }
    }
    std::ranges::stable_sort(found, {}, [](const auto& entry) { return entry.first; });
    for (const auto& [point, label] : found) {
        ++begin_[point + 1];
        labels_.push_back(label);
    }
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
}

bool EdgeSides::apart(u32 a, u32 b) const {
    if (empty()) return false;
    const auto first = of(a), second = of(b);
    for (auto one = first.begin(), other = second.begin(); one != first.end() && other != second.end();) {
        if (one->edge < other->edge)
            ++one;
        else if (other->edge < one->edge)
            ++other;
        else {
            if (one->second != other->second && (one->inside || other->inside)) return true;
            ++one;
            ++other;
        }
    }
    return false;
}

}  // namespace scanmill::growing
