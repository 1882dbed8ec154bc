// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/sampled_distances.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "measure/distance_numbers.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill::measuring {

namespace {

/// Entry i: total area of the triangles 0 to i.
Array<double> cumulated_areas(const TriangleMesh& mesh) {
    Array<double> areas(mesh.triangles.size());
    CompensatedSum sum;
    for (std::size_t row = 0; row < areas.size(); ++row) {
        const auto& [a, b, c] = mesh.triangles[row];
        const Vec3& origin = mesh.positions[a];
        sum.add((mesh.positions[b] - origin).cross(mesh.positions[c] - origin).norm() / 2);
        areas[row] = sum.value();
    }
    return areas;
}

/// A point with uniform distribution on the triangle. The square root compensates for the triangle's narrowing towards
/// its first corner.
Vec3 point_on(const TriangleMesh& mesh, u32 row, Random random) {
    const auto& [a, b, c] = mesh.triangles[row];
    const double away = std::sqrt(random.uniform()), across = random.uniform();
    const Vec3& origin = mesh.positions[a];
    return origin + away * (1 - across) * (mesh.positions[b] - origin) + away * across * (mesh.positions[c] - origin);
}

/// The boundary of a mesh.
struct Borders {
    Array<u8> has_edge;    ///< by number of the half-edge
    Array<u8> has_vertex;  ///< by vertex

    explicit Borders(const TriangleMesh& mesh)
        : has_edge(3 * mesh.triangles.size(), u8(0)),
          has_vertex(mesh.positions.size(), u8(0)) {
        const half_edges::ByVertex all = half_edges::by_smaller_vertex(mesh);
        for (std::size_t vertex = 0; vertex + 1 < all.begin.size(); ++vertex)
            for (u32 i = all.begin[vertex]; i < all.begin[vertex + 1]; ++i) {
                const u32 other = all.half_edges[i].other;
                const bool is_like_previous = i > all.begin[vertex] && all.half_edges[i - 1].other == other;
                const bool is_like_next = i + 1 < all.begin[vertex + 1] && all.half_edges[i + 1].other == other;
                if (is_like_previous || is_like_next) continue;
                has_edge[all.half_edges[i].number] = 1;
                has_vertex[vertex] = has_vertex[other] = 1;
            }
    }
};

bool is_on_border(const Borders& borders, const TriangleMesh& mesh, const Vec3& point, u32 row, double rounding) {
    const Triangle& triangle = mesh.triangles[row];
    const auto corner = [&](u32 i) -> const Vec3& { return mesh.positions[triangle[i % 3]]; };
    const Vec3 foot = nearest_on_triangle(point, corner(0), corner(1), corner(2));
    const auto is_foot = [&](const Vec3& other) { return (other - foot).squaredNorm() <= rounding * rounding; };
    for (u32 i = 0; i < 3; ++i) {
        if (borders.has_vertex[triangle[i]] && is_foot(corner(i))) return true;
        if (borders.has_edge[3 * row + i] && is_foot(nearest_on_segment(foot, corner(i), corner(i + 1)))) return true;
    }
    return false;
}

}  // namespace

SurfaceSamples sample_surface(const TriangleMesh& mesh, std::size_t count, const Random& random, unsigned threads) {
    const Array<double> areas = cumulated_areas(mesh);
    assert(count > 0 && areas.back() > 0);
    const double start = Random(random).uniform();
    // The first triangle at which the whole area is reached. Later triangles have no area and get no sample.
    const auto last = std::ranges::lower_bound(areas, areas.back());
    SurfaceSamples samples;
    samples.positions.resize(count);
    samples.triangles.resize(count);
    for_each_chunk(threads, count, 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double at = areas.back() * ((static_cast<double>(i) + start) / static_cast<double>(count));
            const auto found = std::min(std::upper_bound(areas.begin(), last, at), last);
            samples.triangles[i] = static_cast<u32>(found - areas.begin());
            samples.positions[i] = point_on(mesh, samples.triangles[i], random.stream(i));
        }
    });
    return samples;
}

std::size_t leave_out_borders(NearestDistances& nearest, std::span<const Vec3> points, const TriangleMesh& mesh,
                              double rounding) {
    const Borders borders(mesh);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_on_border(borders, mesh, points[i], nearest.triangles[i], rounding)) continue;
        nearest.distances[kept] = nearest.distances[i];
        nearest.triangles[kept] = nearest.triangles[i];
        nearest.slots[kept] = nearest.slots[i];
        ++kept;
    }
    if (kept == 0)
        throw Error("{} nearest to a border of the mesh; no point is left to measure",
                    points.size() == 1 ? "the only point of the truth is"
                                       : fmt::format("all {} points of the truth are", points.size()))
            .hint("set borders: include");
    nearest.distances.resize(kept);
    nearest.triangles.resize(kept);
    nearest.slots.resize(kept);
    return points.size() - kept;
}

}  // namespace scanmill::measuring
