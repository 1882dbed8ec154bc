// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/certificate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill::a_patches {

namespace {

constexpr std::size_t chunk = 1024;
constexpr u32 segments = 4;
constexpr u32 neighbours = 6;  // whose distance is the spacing at a point
constexpr double noise_factor = 3, deviation_per_median = 1.4826;  // of the magnitudes of normal numbers

Certificate::Farthest farthest(std::span<const double> distances, std::span<const Vec3> places) {
    const auto at = static_cast<std::size_t>(std::ranges::max_element(distances) - distances.begin());
    return {distances[at], places[at]};
}

/// By distinct position: its distance from the surface, and that of the nearest other one; NaN if unknown.
std::vector<std::array<double, 2>> pairs_of(const PatchDistances& distances, const PointTree& tree) {
    std::vector<std::array<double, 2>> pairs(tree.positions().size(), {std::nan(""), std::nan("")});
    for (std::size_t i = 0; i < distances.of_points.size(); ++i)
        pairs[tree.index_of_row()[i]][0] = distances.of_points[i];
    NeighbourBuffer buffer;
    for (u32 i = 0; i < pairs.size(); ++i)
        for (const Neighbour& nearest : tree.nearest(i, 1, buffer)) pairs[i][1] = pairs[nearest.index][0];
    return pairs;
}

/// Standard deviation of the points' noise.
double noise_of(std::span<const std::array<double, 2>> pairs) {
    std::vector<double> differences;
    for (const auto& [here, there] : pairs)
        if (const double d = std::abs(here - there); !std::isnan(d)) differences.push_back(d);
    return differences.empty() ? 0 : deviation_per_median * quantile(differences, 0.5) / std::sqrt(2.0);
}

}  // namespace

Certificate certify(const PatchComplex& patches, const PatchDistances& distances, std::span<const Vec3> points,
                    const PointTree& tree, bool is_closed, double limit, Execution& execution) {
    Certificate result;
    std::vector<double> of_points;
    for (const double d : distances.of_points)
        of_points.push_back(std::isnan(d) ? (is_closed ? distances.limit : 0) : std::abs(d));
    result.point = farthest(of_points, points);
    result.beyond = static_cast<std::size_t>(std::ranges::count_if(of_points, [&](double d) { return d > limit; }));

    const TriangleMesh surface = tessellate(patches, {segments, {}}, execution);
    std::vector<double> of_surface(surface.positions.size());
    for_each_chunk(execution.threads(), of_surface.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        NeighbourBuffer buffer;
        for (std::size_t i = begin; i < end; ++i) {
            const Neighbour nearest = tree.nearest_to(surface.positions[i], 1, buffer).front();
            const auto around = tree.nearest(nearest.index, neighbours, buffer);
            const double spacing = around.empty() ? 0 : std::sqrt(around.back().squared);
            of_surface[i] = std::max(0.0, std::sqrt(nearest.squared) - spacing);
        }
    });
    result.surface = farthest(of_surface, surface.positions.span());
    return result;
}

std::vector<u32> far_triangles(const TriangleMesh& mesh, const PatchDistances& distances, const PointTree& tree,
                               double limit, Execution& execution) {
    const std::vector<std::array<double, 2>> pairs = pairs_of(distances, tree);
    const double beyond = std::max(limit, noise_factor * noise_of(pairs));
    const TriangleTree triangles(mesh.positions.span(), mesh.triangles.span(), execution.threads());
    std::vector<u32> far;
    u32 hint = NearestTriangle::none;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto [here, there] = pairs[i];
        if (!(std::abs(here) > beyond && here * there > 0 && std::abs(there) > beyond / 2)) continue;
        execution.check_cancelled();
        const NearestTriangle nearest = triangles.nearest(tree.positions()[i], hint);
        hint = nearest.slot;
        far.push_back(nearest.triangle);
    }
    std::ranges::sort(far);
    const auto repeats = std::ranges::unique(far);
    far.erase(repeats.begin(), repeats.end());
    return far;
}

}  // namespace scanmill::a_patches
