// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/scanner_side.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "register/reduced_view.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/registration/thinning.hpp"

namespace scanmill::registration {

namespace {

constexpr double points_per_radius = 20;  ///< of the view's root mean square radius
constexpr std::size_t neighbours = 16, linked = 5, least_points = 50;
/// Neighbours with normals at a larger angle, 60 degrees, may be on two surfaces.
constexpr double least_cosine = 0.5;
constexpr double tolerance = 0.01;  ///< of the links
/// From -1, for concave, to 1, for convex surfaces.
constexpr double clearly_concave = -0.3;

/// Points with normals of unknown side, and links between neighbours.
struct Surface {
    Array<Vec3> points, normals;
    std::vector<std::pair<u32, u32>> links;
};

Surface surface_of(std::span<const Vec3> points) {
    Surface surface;
    const double distance = extent_of(points).radius / points_per_radius;
    if (!(distance > 0)) return surface;
    const Array<Vec3> means = thinned_means(points, distance);
    const PointTree tree(means);
    const std::span<const Vec3> positions = tree.positions();
    surface.points.assign(positions.begin(), positions.end());
    std::vector<std::pair<u32, u32>> links;
    NeighbourBuffer buffer;
    Array<Vec3> around;
    for (u32 i = 0; i < positions.size(); ++i) {
        around.assign(1, Vec3::Zero());
        for (const Neighbour& n : tree.nearest(i, neighbours, buffer)) {
            if (around.size() <= linked) links.emplace_back(i, n.index);
            around.push_back(positions[n.index] - positions[i]);
        }
        surface.normals.push_back(scatter_of(around).normal);
    }
    for (auto [i, j] : links)
        if (std::abs(surface.normals[i].dot(surface.normals[j])) > least_cosine) surface.links.emplace_back(i, j);
    return surface;
}

/// The share of links along which the normals turn over if all are turned towards `direction`: the surface is seen
/// edge-on there.
double turned_over(const Surface& surface, const Vec3& direction) {
    Array<double> cosines;
    for (const Vec3& normal : surface.normals) cosines.push_back(normal.dot(direction));
    std::size_t count = 0;
    for (const auto& [i, j] : surface.links)
        count += (cosines[i] * cosines[j] < 0) != (surface.normals[i].dot(surface.normals[j]) < 0);
    return static_cast<double>(count) / static_cast<double>(surface.links.size());
}

/// The mean of the normals turned towards `direction`.
Vec3 mean_normal(const Surface& surface, const Vec3& direction) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& normal : surface.normals) sum += normal.dot(direction) < 0 ? Vec3(-normal) : normal;
    return sum.normalized();
}

/// The surface with normals towards `direction`: 1 if all pairs of points are convex, -1 if all are concave. Every
/// point is paired with those that follow it by a power of two.
double convexity(const Surface& surface, const Vec3& direction) {
    const std::size_t count = surface.points.size();
    const auto normal = [&](std::size_t i) -> Vec3 {
        return surface.normals[i].dot(direction) < 0 ? Vec3(-surface.normals[i]) : surface.normals[i];
    };
    double sum = 0, all = 0;
    for (std::size_t step = 1; step < count; step *= 2)
        for (std::size_t i = 0; i + step < count; ++i) {
            const double bend = (normal(i) - normal(i + step)).dot(surface.points[i] - surface.points[i + step]);
            sum += bend;
            all += std::abs(bend);
        }
    return all > 0 ? sum / all : 0;
}

/// Directions through a grid on the surface of a cube, one of each pair of opposites.
std::vector<Vec3> directions_all_round() {
    constexpr int half = 4;
    std::vector<Vec3> directions;
    for (int x = -half; x <= half; ++x)
        for (int y = -half; y <= half; ++y)
            for (int z = -half; z <= half; ++z) {
                if (std::max({std::abs(x), std::abs(y), std::abs(z)}) < half) continue;
                const Vec3 direction(x, y, z);
                if (with_positive_sign(direction) == direction) directions.push_back(direction.normalized());
            }
    return directions;
}

}  // namespace

Vec3 scanner_side(std::span<const Vec3> points) {
    const Vec3 assumed = Vec3::UnitZ();
    const Surface surface = surface_of(points);
    if (surface.points.size() < least_points || surface.links.empty()) return assumed;
    double least = turned_over(surface, assumed) - tolerance;
    std::optional<Vec3> best;
    for (const Vec3& direction : directions_all_round())
        if (const double its = turned_over(surface, direction); its < least) least = its, best = direction;
    if (!best) return convexity(surface, assumed) < clearly_concave ? Vec3(-assumed) : assumed;
    const Vec3 side = mean_normal(surface, *best);
    return convexity(surface, side) < 0 ? Vec3(-side) : side;
}

}  // namespace scanmill::registration
