// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/surface_samples.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "measure/compensated_sum.hpp"
#include "scanmill/base/parallel.hpp"

namespace scanmill::measuring {

namespace {

/// Entry i: area of triangles 0 … i.
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

/// Uniform on the triangle: the root makes up for its narrowing towards the first corner.
Vec3 point_on(const TriangleMesh& mesh, u32 row, Random random) {
    const auto& [a, b, c] = mesh.triangles[row];
    const double away = std::sqrt(random.uniform()), across = random.uniform();
    const Vec3& origin = mesh.positions[a];
    return origin + away * (1 - across) * (mesh.positions[b] - origin) + away * across * (mesh.positions[c] - origin);
}

}  // namespace

SurfaceSamples sample_surface(const TriangleMesh& mesh, std::size_t count, const Random& random, unsigned threads) {
    const Array<double> areas = cumulated_areas(mesh);
    assert(count > 0 && areas.back() > 0);
    const double start = Random(random).uniform();
    // First of those that reach the whole area: no sample lies on a triangle without area.
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

}  // namespace scanmill::measuring
