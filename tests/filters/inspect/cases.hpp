// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Calls of inspect, for its tests.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "inspect/inspect.hpp"
#include "scanmill/base/random.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {

/// Everything within 1000 is near enough, and few labels.
inline InspectParams params_with(double low = -0.1, double high = 0.1) {
    InspectParams params;
    params.tolerance = {low, high};
    params.max_distance = 1000;
    params.label_distance = 0;
    params.labels = 3;
    return params;
}

template <class Scan>
Inspection inspected(const Scan& scan, const TriangleMesh& nominal, const InspectParams& params = params_with(),
                     unsigned threads = 2) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return inspect(scan, nominal, nullptr, params, context);
}

inline PointCloud cloud(Array<Vec3> positions) {
    PointCloud result;
    result.positions = std::move(positions);
    return result;
}

/// The deviation of one point; NaN if it is not counted.
inline double deviation_at(const Vec3& point, const TriangleMesh& nominal, InspectParams params = params_with()) {
    // A second point, which is always counted, so that the first may be left out.
    const auto& [a, b, c] = nominal.triangles[0];
    const Vec3 inside = (nominal.positions[a] + nominal.positions[b] + nominal.positions[c]) / 3;
    return inspected(cloud({point, inside}), nominal, params).deviations[0];
}

/// n × n cells of [0, size]², two triangles each, facing up; the height of a vertex is height(x, y).
template <class Height>
TriangleMesh sheet(u32 n, double size, Height&& height) {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 i = 0; i <= n; ++i)
        for (u32 j = 0; j <= n; ++j) {
            const double x = size * i / n, y = size * j / n;
            positions.emplace_back(x, y, height(x, y));
        }
    for (u32 i = 0; i < n; ++i)
        for (u32 j = 0; j < n; ++j) {
            const u32 a = i * (n + 1) + j, b = a + n + 1;
            triangles.push_back({a, b, b + 1});
            triangles.push_back({a, b + 1, a + 1});
        }
    return soup(std::move(positions), std::move(triangles));
}

/// Points on the surface of [0, size], `per_edge`² in the middle of cells on every face, moved by offset(face,
/// position) along the outward normal. Faces: 2 axis + (1 for the upper one).
template <class Offset>
PointCloud points_on_box(const Vec3& size, u32 per_edge, Offset&& offset) {
    Array<Vec3> positions;
    for (int axis = 0; axis < 3; ++axis)
        for (int upper = 0; upper < 2; ++upper)
            for (u32 i = 0; i < per_edge; ++i)
                for (u32 j = 0; j < per_edge; ++j) {
                    Vec3 p;
                    p[axis] = upper * size[axis];
                    p[(axis + 1) % 3] = (i + 0.5) / per_edge * size[(axis + 1) % 3];
                    p[(axis + 2) % 3] = (j + 0.5) / per_edge * size[(axis + 2) % 3];
                    p[axis] += (upper ? 1 : -1) * offset(2 * axis + upper, p);
                    positions.push_back(p);
                }
    return cloud(std::move(positions));
}

/// [0, size].
inline TriangleMesh box(const Vec3& size) {
    return with_positions(cube(), [&](const Vec3& p) -> Vec3 { return p.cwiseProduct(size); });
}

/// Seeded points in a box that is larger than [low, high] by `margin`.
inline Array<Vec3> random_points(std::size_t count, const Vec3& low, const Vec3& high, double margin,
                                 std::uint64_t seed) {
    Random random(seed);
    Array<Vec3> points(count);
    for (Vec3& point : points)
        for (int axis = 0; axis < 3; ++axis)
            point[axis] = low[axis] - margin + random.uniform() * (high[axis] - low[axis] + 2 * margin);
    return points;
}

}  // namespace scanmill::test
