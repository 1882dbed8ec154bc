// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Simple meshes from corners, and meshes made from others.

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "scanmill/data/mesh.hpp"

namespace scanmill::test {

template <class Motion>
TriangleMesh with_positions(const TriangleMesh& mesh, Motion&& motion) {
    Array<Vec3> positions(mesh.positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = motion(mesh.positions[i]);
    TriangleMesh result = mesh;
    result.positions = std::move(positions);
    return result;
}

inline TriangleMesh shifted(const TriangleMesh& mesh, const Vec3& shift) {
    return with_positions(mesh, [&](const Vec3& p) -> Vec3 { return p + shift; });
}

inline TriangleMesh scaled(const TriangleMesh& mesh, double factor) {
    return with_positions(mesh, [&](const Vec3& p) -> Vec3 { return p * factor; });
}

inline TriangleMesh turned(const TriangleMesh& mesh, double angle, const Vec3& axis) {
    const Eigen::AngleAxisd rotation(angle, axis.normalized());
    return with_positions(mesh, [&](const Vec3& p) -> Vec3 { return rotation * p; });
}

inline TriangleMesh inside_out(const TriangleMesh& mesh) {
    Array<Triangle> triangles;
    for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({a, c, b});
    TriangleMesh result = mesh;
    result.triangles = std::move(triangles);
    return result;
}

/// Both meshes, without common vertices.
inline TriangleMesh both(const TriangleMesh& one, const TriangleMesh& other) {
    Array<Vec3> positions(one.positions.begin(), one.positions.end());
    positions.insert(positions.end(), other.positions.begin(), other.positions.end());
    Array<Triangle> triangles(one.triangles.begin(), one.triangles.end());
    const u32 first = static_cast<u32>(one.positions.size());
    for (const auto& [a, b, c] : other.triangles) triangles.push_back({a + first, b + first, c + first});
    TriangleMesh result;
    result.positions = std::move(positions);
    result.triangles = std::move(triangles);
    return result;
}

inline TriangleMesh soup(Array<Vec3> positions, Array<Triangle> triangles) {
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

/// Decimated by vertex clustering: of the vertices in one cube of this size the first replaces the others; triangles
/// that lose a corner are left out.
inline TriangleMesh clustered(const TriangleMesh& mesh, double size) {
    std::map<std::tuple<double, double, double>, u32> first;
    const auto representative = [&](u32 vertex) {
        const Vec3 cell = (mesh.positions[vertex] / size).array().floor();
        return first.try_emplace({cell.x(), cell.y(), cell.z()}, vertex).first->second;
    };
    Array<Triangle> triangles;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Triangle triangle{representative(a), representative(b), representative(c)};
        if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
            triangles.push_back(triangle);
    }
    TriangleMesh result = mesh;
    result.triangles = std::move(triangles);
    return result;
}

/// A closed surface with one side: a figure eight that makes half a turn on its way around the z axis. It crosses
/// itself between its vertices; two triangles at every edge. Pre: `around` at least 3, `along` even and at least 4.
inline TriangleMesh klein_bottle(u32 around, u32 along) {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    const auto vertex = [&](u32 i, u32 j) {
        const u32 row = j % along;
        return i < around ? i * along + row : along - 1 - row;
    };
    for (u32 i = 0; i < around; ++i)
        for (u32 j = 0; j < along; ++j) {
            const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * (j + 0.5) / along;
            const double x = std::sin(v), y = std::sin(2 * v), cosine = std::cos(u / 2), sine = std::sin(u / 2);
            const double radius = 3 + cosine * x - sine * y;
            positions.emplace_back(radius * std::cos(u), radius * std::sin(u), sine * x + cosine * y);
            triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    return soup(std::move(positions), std::move(triangles));
}

/// Every triangle with its own three vertices.
inline TriangleMesh separate(const TriangleMesh& mesh) {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (const Triangle& triangle : mesh.triangles) {
        const u32 first = static_cast<u32>(positions.size());
        for (const u32 vertex : triangle) positions.push_back(mesh.positions[vertex]);
        triangles.push_back({first, first + 1, first + 2});
    }
    return soup(std::move(positions), std::move(triangles));
}

/// [0, width] × [0, depth] at this height, two triangles, facing up.
inline TriangleMesh rectangle(double width, double depth, double height = 0) {
    return soup({{0, 0, height}, {width, 0, height}, {width, depth, height}, {0, depth, height}},
                {{0, 1, 2}, {0, 2, 3}});
}

}  // namespace scanmill::test
