// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/shapes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "scanmill/base/random.hpp"

namespace scanmill::test {

namespace {

TriangleMesh mesh_of(Array<Vec3> positions, Array<Triangle> triangles) {
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

/// A prism over a polygon (counter-clockwise seen from +z) whose cap is given as triangles: bottom, top, walls.
TriangleMesh prism(const std::vector<Vec3>& base, const std::vector<Triangle>& cap, double height) {
    const u32 corners = static_cast<u32>(base.size());
    Array<Vec3> positions;
    for (const Vec3& p : base) positions.push_back(p);
    for (const Vec3& p : base) positions.push_back(p + Vec3(0, 0, height));
    Array<Triangle> triangles;
    for (const auto& [a, b, c] : cap) triangles.push_back({a, c, b});
    for (const auto& [a, b, c] : cap) triangles.push_back({a + corners, b + corners, c + corners});
    for (u32 a = 0; a < corners; ++a) {
        const u32 b = (a + 1) % corners;
        triangles.push_back({a, b, b + corners});
        triangles.push_back({a, b + corners, a + corners});
    }
    return mesh_of(std::move(positions), std::move(triangles));
}

}  // namespace

TriangleMesh cube(double edge) {
    return prism({{0, 0, 0}, {edge, 0, 0}, {edge, edge, 0}, {0, edge, 0}}, {{0, 1, 2}, {0, 2, 3}}, edge);
}

TriangleMesh l_block(double size) {
    const double s = size;
    return prism({{0, 0, 0}, {2 * s, 0, 0}, {2 * s, s, 0}, {s, s, 0}, {s, 2 * s, 0}, {0, 2 * s, 0}},
                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, s);
}

TriangleMesh cube_of_squares(int squares) {
    std::map<std::array<int, 3>, u32> numbers;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    const auto number_of = [&](const std::array<int, 3>& p) {
        const auto [found, is_new] = numbers.emplace(p, static_cast<u32>(positions.size()));
        if (is_new) positions.emplace_back(p[0], p[1], p[2]);
        return found->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const bool upper : {false, true})
            for (int i = 0; i < squares; ++i)
                for (int j = 0; j < squares; ++j) {
                    const auto at = [&](int u, int v) {
                        std::array<int, 3> p;
                        p[axis] = upper ? squares : 0;
                        p[(axis + 1) % 3] = u;
                        p[(axis + 2) % 3] = v;
                        return number_of(p);
                    };
                    u32 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
                    if (!upper) std::swap(b, d);
                    triangles.push_back({a, b, c});
                    triangles.push_back({a, c, d});
                }
    return mesh_of(std::move(positions), std::move(triangles));
}

TriangleMesh regular_tetrahedron(double edge) {
    const double s = edge / (2 * std::numbers::sqrt2);
    return mesh_of({{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
}

TriangleMesh icosahedron(double radius) {
    const double golden = std::numbers::phi;
    const double scale = radius / std::sqrt(1 + golden * golden);
    const double a = scale, b = golden * scale;
    return mesh_of({{-a, b, 0},
                    {a, b, 0},
                    {-a, -b, 0},
                    {a, -b, 0},
                    {0, -a, b},
                    {0, a, b},
                    {0, -a, -b},
                    {0, a, -b},
                    {b, 0, -a},
                    {b, 0, a},
                    {-b, 0, -a},
                    {-b, 0, a}},
                   {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}});
}

TriangleMesh geodesic_sphere(double radius, u32 frequency) {
    assert(frequency > 0);
    const TriangleMesh coarse = icosahedron(1);
    // A lattice point is named by its weights on the face's corners, so that faces share their edges' points.
    using Weights = std::array<std::pair<u32, u32>, 3>;
    std::map<Weights, u32> vertex_of;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (const Triangle& face : coarse.triangles) {
        const auto lattice_point = [&](u32 i, u32 j) {
            const std::array<u32, 3> amounts{frequency - i - j, i, j};
            Weights weights;
            Vec3 sum = Vec3::Zero();
            for (int corner = 0; corner < 3; ++corner)
                weights[corner] =
                    amounts[corner] ? std::pair(face[corner], amounts[corner]) : std::pair(~u32(0), u32(0));
            std::ranges::sort(weights);
            for (const auto& [vertex, amount] : weights)
                if (amount) sum += static_cast<double>(amount) * coarse.positions[vertex];
            const auto [found, is_new] = vertex_of.emplace(weights, static_cast<u32>(positions.size()));
            if (is_new) positions.push_back(sum * (radius / sum.norm()));
            return found->second;
        };
        for (u32 i = 0; i < frequency; ++i)
            for (u32 j = 0; i + j < frequency; ++j) {
                triangles.push_back({lattice_point(i, j), lattice_point(i + 1, j), lattice_point(i, j + 1)});
                if (i + j + 1 < frequency)
                    triangles.push_back(
                        {lattice_point(i + 1, j), lattice_point(i + 1, j + 1), lattice_point(i, j + 1)});
            }
    }
    return mesh_of(std::move(positions), std::move(triangles));
}

TriangleMesh torus(double major, double minor, u32 around, u32 along) {
    assert(around >= 3 && along >= 3 && minor > 0 && minor < major);
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 i = 0; i < around; ++i)
        for (u32 j = 0; j < along; ++j) {
            const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / along;
            const double ring = major + minor * std::cos(v);
            positions.push_back({ring * std::cos(u), ring * std::sin(u), minor * std::sin(v)});
            const u32 next_i = (i + 1) % around, next_j = (j + 1) % along;
            const u32 a = i * along + j, b = next_i * along + j, c = next_i * along + next_j, d = i * along + next_j;
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
    return mesh_of(std::move(positions), std::move(triangles));
}

TriangleMesh without_triangles(const TriangleMesh& mesh, std::initializer_list<u32> rows) {
    Array<Triangle> kept;
    for (u32 i = 0; i < mesh.triangles.size(); ++i)
        if (std::ranges::find(rows, i) == rows.end()) kept.push_back(mesh.triangles[i]);
    TriangleMesh result = mesh;
    result.triangles = std::move(kept);
    return result;
}

double area(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3& origin = mesh.positions[a];
        sum += (mesh.positions[b] - origin).cross(mesh.positions[c] - origin).norm() / 2;
    }
    return sum;
}

double signed_volume(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c])) / 6;
    return sum;
}

PointCloud cloud_of(std::initializer_list<Vec3> positions) {
    PointCloud cloud;
    cloud.positions = positions;
    return cloud;
}

PointCloud vertices_of(const TriangleMesh& mesh) { return {mesh.frame, mesh.positions, mesh.vertex_columns}; }

PointCloud random_cube(std::size_t count, std::uint64_t seed, double edge) {
    Random random(seed);
    Array<Vec3> positions(count);
    for (Vec3& p : positions)
        for (int axis = 0; axis < 3; ++axis) p[axis] = edge * random.uniform();
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

PointCloud flat_square(double thickness) {
    Random random(4);
    Array<Vec3> positions(500);
    for (Vec3& p : positions) {
        const double x = random.uniform(), y = random.uniform();
        p = {x, y, random.uniform(0, thickness)};
    }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

PointCloud random_sphere(std::size_t count, std::uint64_t seed, double radius) {
    Random random(seed);
    Array<Vec3> positions(count);
    for (Vec3& p : positions) {
        // Archimedes: the height of a uniform point on the sphere is uniform.
        const double z = random.uniform(-1, 1), angle = random.uniform(0, 2 * std::numbers::pi);
        const double ring = std::sqrt(1 - z * z);
        p = radius * Vec3(ring * std::cos(angle), ring * std::sin(angle), z);
    }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

}  // namespace scanmill::test
