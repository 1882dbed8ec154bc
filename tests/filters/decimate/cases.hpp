// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Calls of decimate for its tests, meshes with known results, and laws that every result obeys.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "decimate/decimate.hpp"
#include "filters/features/cases.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {

inline DecimateParams within(double max_error) {
    DecimateParams params;
    params.max_error = max_error;
    return params;
}

/// Without a least angle, for shapes whose lightest mesh has thin triangles.
inline DecimateParams with_any_angle(double max_error) {
    DecimateParams params = within(max_error);
    params.min_angle = Angle::degrees(0);
    return params;
}

inline DecimateResult decimated(const TriangleMesh& mesh, const DecimateParams& params,
                                const PointCloud* points = nullptr, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return decimate(mesh, points, params, context);
}

inline DecimateResult decimated(const TriangleMesh& mesh, double max_error) {
    return decimated(mesh, within(max_error));
}

inline std::vector<std::string> warnings_of_decimate(const TriangleMesh& mesh, const DecimateParams& params) {
    Context context;
    decimate(mesh, nullptr, params, context);
    return context.warnings();
}

/// The unit cube, every face a k × k grid: 6 k² + 2 vertices, 12 k² triangles.
inline TriangleMesh gridded_cube(int k) {
    MeshBuilder builder;
    const double step = 1.0 / k;
    for (int axis = 0; axis < 3; ++axis)
        for (const int side : {0, k})
            for (int i = 0; i < k; ++i)
                for (int j = 0; j < k; ++j) {
                    const auto at = [&](int u, int v) {
                        Vec3 p;
                        p[axis] = side * step;
                        p[(axis + 1) % 3] = u * step;
                        p[(axis + 2) % 3] = v * step;
                        return p;
                    };
                    const Vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
                    if (side > 0)
                        builder.quad(a, b, c, d);
                    else
                        builder.quad(a, d, c, b);
                }
    return builder.mesh();
}

/// Around the z axis, from z = 0 to `height`: `rows` rings of quadrilaterals on the wall, caps of `rings` rings.
inline TriangleMesh cylinder(double radius, double height, u32 sides, u32 rows, u32 rings) {
    MeshBuilder builder;
    for (u32 i = 0; i < sides; ++i) {
        for (u32 row = 0; row < rows; ++row) {
            const double low = height * row / rows, high = height * (row + 1) / rows;
            builder.quad(on_circle(radius, i, sides, low), on_circle(radius, i + 1, sides, low),
                         on_circle(radius, i + 1, sides, high), on_circle(radius, i, sides, high));
        }
        for (u32 ring = 0; ring < rings; ++ring) {
            const double inner = radius * ring / rings, outer = radius * (ring + 1) / rings;
            for (const double z : {0.0, height}) {
                const Vec3 a = on_circle(inner, i, sides, z), b = on_circle(outer, i, sides, z),
                           c = on_circle(outer, i + 1, sides, z), d = on_circle(inner, i + 1, sides, z);
                if (ring == 0)
                    z > 0 ? builder.triangle(Vec3(0, 0, z), b, c) : builder.triangle(Vec3(0, 0, z), c, b);
                else
                    z > 0 ? builder.quad(a, b, c, d) : builder.quad(d, c, b, a);
            }
        }
    }
    return builder.mesh();
}

/// Around the z axis, open below: the apex at z = 0, `rings` rings of eight times their number of vertices, `step`
/// apart along the wall.
inline TriangleMesh cone(double half_angle_degrees, u32 rings, double step) {
    const double half = half_angle_degrees * std::numbers::pi / 180;
    MeshBuilder builder;
    const auto at = [&](u32 ring, u32 i) {
        return ring == 0 ? Vec3(0, 0, 0)
                         : on_circle(ring * step * std::sin(half), i, 8 * ring, -(ring * step * std::cos(half)));
    };
    for (u32 ring = 0; ring < rings; ++ring)
        for (u32 sector = 0; sector < 8; ++sector)
            for (u32 i = 0; i <= ring; ++i) {
                const Vec3 outer = at(ring + 1, sector * (ring + 1) + i),
                           next = at(ring + 1, sector * (ring + 1) + i + 1);
                const Vec3 inner = at(ring, sector * ring + i);
                builder.triangle(inner, outer, next);
                if (i < ring) builder.triangle(inner, next, at(ring, sector * ring + i + 1));
            }
    return builder.mesh();
}

/// A sphere of radius 1 whose vertices are moved along their normals by up to `noise`.
inline TriangleMesh bumpy_sphere(u32 frequency, double noise, std::uint64_t seed) {
    Random random(seed);
    return with_positions(geodesic_sphere(1, frequency),
                          [&](const Vec3& p) -> Vec3 { return p * (1 + random.uniform(-noise, noise)); });
}

/// m × n unit squares with heights up to `noise` either way, open.
inline TriangleMesh bumpy_grid(int m, int n, double noise, std::uint64_t seed) {
    Random random(seed);
    return with_positions(grid(m, n),
                          [&](const Vec3& p) -> Vec3 { return p + Vec3(0, 0, random.uniform(-noise, noise)); });
}

inline std::span<const u8> classes_of(const TriangleMesh& mesh) {
    return mesh.vertex_columns.find("class")->values<u8>();
}

inline std::size_t count_of(const TriangleMesh& mesh, VertexClass kind) {
    return static_cast<std::size_t>(std::ranges::count(classes_of(mesh), static_cast<u8>(kind)));
}

inline double largest_in(const TriangleMesh& mesh, const char* column) {
    return std::ranges::max(mesh.face_columns.find(column)->values<double>());
}

/// The normal in the column `corner-normals` at a corner of a triangle.
inline Vec3 corner_normal(const TriangleMesh& mesh, std::size_t triangle, std::size_t corner) {
    const auto all = mesh.face_columns.find("corner-normals")->values<double>();
    const std::size_t first = 9 * triangle + 3 * corner;
    return {all[first], all[first + 1], all[first + 2]};
}

/// Rows of the input's vertices by the result's: those with the same position, bit for bit, each used once. A result
/// with other vertices fails the test.
inline std::vector<u32> input_rows(const TriangleMesh& input, const TriangleMesh& result) {
    std::multimap<std::tuple<double, double, double>, u32> by_position;
    for (u32 v = 0; v < input.positions.size(); ++v) {
        const Vec3& p = input.positions[v];
        by_position.emplace(std::tuple(p.x(), p.y(), p.z()), v);
    }
    std::vector<u32> rows;
    for (const Vec3& p : result.positions) {
        const auto found = by_position.lower_bound({p.x(), p.y(), p.z()});
        if (found == by_position.end() || found->first != std::tuple(p.x(), p.y(), p.z())) {
            ADD_FAILURE() << "a vertex of the result is not a vertex of the input: " << p.transpose();
            return rows;
        }
        rows.push_back(found->second);
        by_position.erase(found);
    }
    return rows;
}

/// The largest distance from samples on `from`, its vertices among them, to the surface `to`.
inline double sampled_distance(const TriangleMesh& from, const TriangleMesh& to, u32 cuts = 4) {
    const TriangleTree tree(to.positions.span(), to.triangles.span(), 1);
    double largest = 0;
    u32 hint = NearestTriangle::none;
    for (const auto& [a, b, c] : from.triangles)
        for (u32 i = 0; i <= cuts; ++i)
            for (u32 j = 0; i + j <= cuts; ++j) {
                const Vec3 p = (i * from.positions[a] + j * from.positions[b] + (cuts - i - j) * from.positions[c]) /
                               static_cast<double>(cuts);
                const NearestTriangle nearest = tree.nearest(p, hint);
                hint = nearest.slot;
                largest = std::max(largest, nearest.squared_distance);
            }
    return std::sqrt(largest);
}

/// What holds for every result: vertices of the input, same topology, distance in both directions, no fold.
inline void expect_laws(const TriangleMesh& input, const DecimateResult& result, double max_error) {
    const std::vector<u32> rows = input_rows(input, result.mesh);
    EXPECT_TRUE(std::ranges::is_sorted(rows)) << "vertices are in input order";
    const MeshTopology before = topology(input), after = topology(result.mesh);
    EXPECT_EQ(after.euler, before.euler);
    EXPECT_EQ(after.components, before.components);
    EXPECT_EQ(after.boundary_loops, before.boundary_loops);
    EXPECT_EQ(after.closed, before.closed);
    EXPECT_EQ(after.genus, before.genus);
    EXPECT_EQ(after.nonmanifold_edges + after.nonmanifold_vertices + after.misoriented_edges, 0u);
    EXPECT_EQ(after.degenerate_triangles + after.unused_vertices, 0u);
    EXPECT_EQ(before.vertices - after.vertices, result.removed);
    const double scale = surface_box(input).high.cwiseAbs().maxCoeff() + surface_box(input).low.cwiseAbs().maxCoeff();
    const double rounding = 1e-12 * scale;
    EXPECT_LE(result.certificate.upper, max_error + rounding);
    const double there = sampled_distance(input, result.mesh), back = sampled_distance(result.mesh, input);
    EXPECT_LE(std::max(there, back), result.certificate.upper + rounding);
    EXPECT_LE(result.certificate.lower, result.certificate.upper);
    for (const char* column : {"error-outside", "error-inside"}) {
        EXPECT_LE(largest_in(result.mesh, column), max_error * (1 + 1e-6) + rounding) << column;
        EXPECT_EQ(result.mesh.face_columns.find(column)->length_exponent(), 1);
    }
    EXPECT_EQ(classes_of(result.mesh).size(), result.mesh.positions.size());
    EXPECT_TRUE(std::ranges::is_sorted(result.mesh.sharp_edges));
}

inline bool same_mesh(const TriangleMesh& a, const TriangleMesh& b) {
    return same_bytes(a.positions, b.positions) && same_bytes(a.triangles, b.triangles) &&
           same_bytes(a.sharp_edges, b.sharp_edges) && a.vertex_columns == b.vertex_columns &&
           a.face_columns == b.face_columns;
}

/// The distance from a point to the nearest of the edges.
inline double distance_to_edges(const Vec3& point, const TriangleMesh& mesh, std::span<const Edge> edges) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : edges)
        least = std::min(least, (point - nearest_on_segment(point, mesh.positions[a], mesh.positions[b])).norm());
    return least;
}

inline std::size_t intersections_of(const TriangleMesh& mesh) {
    Execution execution;
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    return self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, execution, 0).count;
}

}  // namespace scanmill::test
