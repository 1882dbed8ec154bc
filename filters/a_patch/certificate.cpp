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
constexpr double noise_factor = 5;
constexpr double deviation_per_median = 1.4826;  // standard deviation per median magnitude of normal numbers

Certificate::Farthest farthest(std::span<const double> distances, std::span<const Vec3> positions) {
    const auto at = static_cast<std::size_t>(std::ranges::max_element(distances) - distances.begin());
    return {distances[at], positions[at]};
}

/// By distinct position: its distance from the surface, and that of the nearest other one; NaN if unknown.
std::vector<std::array<double, 2>> pairs_of(const PatchDistances& distances, const PointTree& tree,
                                            Execution& execution) {
    std::vector<std::array<double, 2>> pairs(tree.positions().size(), {std::nan(""), std::nan("")});
    for (std::size_t i = 0; i < distances.of_points.size(); ++i)
        pairs[tree.index_of_row()[i]][0] = distances.of_points[i];
    tree.for_each_nearest(1, execution.threads(), [&](const NeighbourBatch& batch) {
        execution.check_cancelled();
        for (std::size_t i = 0; i < batch.indices.size(); ++i)
            for (const Neighbour& nearest : batch.of(i)) pairs[batch.indices[i]][1] = pairs[nearest.index][0];
    });
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
                    const PointTree& tree, bool is_closed, double max_error, Execution& execution) {
    const TriangleMesh surface = tessellate(patches, {segments, {}}, execution);
    const TriangleTree triangles(surface.positions.span(), surface.triangles.span(), execution.threads());
    std::vector<double> of_points;
    u32 hint = NearestTriangle::none;
    for (std::size_t i = 0; i < points.size(); ++i) {
        double distance = std::abs(distances.of_points[i]);
        if (std::isnan(distance)) {
            const NearestTriangle nearest = triangles.nearest(points[i], hint);
            hint = nearest.slot;
            distance = std::sqrt(nearest.squared_distance);
            if (!is_closed && distance <= distances.limit) distance = 0;  // beside the boundary
        }
        of_points.push_back(distance);
    }
    Certificate result;
    result.point = farthest(of_points, points);
    result.beyond = static_cast<std::size_t>(std::ranges::count_if(of_points, [&](double d) { return d > max_error; }));

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
                               double max_error, Execution& execution) {
    const std::vector<std::array<double, 2>> pairs = pairs_of(distances, tree, execution);
    const double beyond = std::max(max_error, noise_factor * noise_of(pairs));
    const TriangleTree triangles(mesh.positions.span(), mesh.triangles.span(), execution.threads());
    std::vector<u32> far;
    u32 hint = NearestTriangle::none;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto [here, there] = pairs[i];
        if (!(std::abs(here) > beyond && here * there > 0 && std::abs(there) > beyond / 2)) continue;
        const NearestTriangle nearest = triangles.nearest(tree.positions()[i], hint);
        hint = nearest.slot;
        const Triangle& t = mesh.triangles[nearest.triangle];
        double longest = 0;
        for (std::size_t k = 0; k < 3; ++k)
            longest = std::max(longest, (mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]]).squaredNorm());
        if (nearest.squared_distance <= longest) far.push_back(nearest.triangle);
    }
    std::ranges::sort(far);
    const auto repeats = std::ranges::unique(far);
    far.erase(repeats.begin(), repeats.end());
    return far;
}

}  // namespace scanmill::a_patches
