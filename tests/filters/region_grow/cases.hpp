// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Helpers to call region-grow, and slow checks of its results.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "region_grow/region_grow.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/topology.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill::test {

inline RegionGrowResult grown(const PointCloud& cloud, const RegionGrowParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return region_grow(cloud, params, context);
}

inline std::string growth_refusal(const PointCloud& cloud, const RegionGrowParams& params = {}) {
    try {
        grown(cloud, params);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

inline PointCloud cloud_from(std::vector<Vec3> positions) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>(positions.begin(), positions.end());
    return cloud;
}

/// (0 … m − 1) × (0 … n − 1) in the plane z = 0.
inline PointCloud grid(u32 m, u32 n) {
    std::vector<Vec3> points;
    for (u32 x = 0; x < m; ++x)
        for (u32 y = 0; y < n; ++y) points.push_back(Vec3(x, y, 0));
    return cloud_from(std::move(points));
}

/// Walks around every vertex triangle by triangle. Every edge is in one triangle, or in two with opposite half-edges;
/// the triangles of a vertex form one fan, open or closed; every vertex is used; no position occurs twice.
inline void expect_manifold(const TriangleMesh& mesh) {
    std::map<std::pair<u32, u32>, std::size_t> half_edges;
    std::vector<std::map<u32, u32>> links(mesh.positions.size());
    for (const auto& [a, b, c] : mesh.triangles)
        for (const auto& [from, to, third] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}) {
            ++half_edges[{from, to}];
            ASSERT_TRUE(links[from].emplace(to, third).second) << "edge " << from << " -> " << to << " twice";
        }
    for (u32 vertex = 0; vertex < links.size(); ++vertex) {
        const auto& link = links[vertex];
        ASSERT_FALSE(link.empty()) << "vertex " << vertex << " is in no triangle";
        std::set<u32> ends;
        for (const auto& [first, last] : link) ends.insert(last);
        u32 begin = link.begin()->first;
        for (const auto& [first, last] : link)
            if (!ends.contains(first)) begin = first;
        std::size_t steps = 0;
        for (auto at = link.find(begin); at != link.end() && steps <= link.size(); at = link.find(at->second)) {
            ++steps;
            if (at->second == begin) break;
        }
        ASSERT_EQ(steps, link.size()) << "vertex " << vertex << " has several fans";
    }
    std::set<std::array<double, 3>> positions;
    for (const Vec3& p : mesh.positions) ASSERT_TRUE(positions.insert({p.x(), p.y(), p.z()}).second);
}

/// F = 2 V − 2 χ − b, and the counts in the result.
inline void expect_consistent(const RegionGrowResult& result) {
    expect_manifold(result.mesh);
    const MeshTopology actual = topology(result.mesh);
    EXPECT_EQ(static_cast<long>(actual.triangles),
              2 * static_cast<long>(actual.vertices) - 2 * actual.euler - static_cast<long>(actual.boundary_edges));
    EXPECT_EQ(actual.components, result.components);
    EXPECT_EQ(actual.boundary_loops, result.loops);
    EXPECT_EQ(result.passes.size(), actual.triangles);
    EXPECT_EQ(result.rows.size(), actual.vertices);
}

inline Vec3 normal_of(const TriangleMesh& mesh, const Triangle& t) {
    return (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
}

/// In radians.
inline double smallest_angle(const TriangleMesh& mesh, const Triangle& t) {
    double least = std::numbers::pi;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 u = mesh.positions[t[(i + 1) % 3]] - mesh.positions[t[i]];
        const Vec3 v = mesh.positions[t[(i + 2) % 3]] - mesh.positions[t[i]];
        least = std::min(least, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
    return least;
}

/// Pairs of triangles in the plane z = 0 whose interiors overlap, by testing all pairs.
inline std::size_t overlapping_pairs(const TriangleMesh& mesh) {
    const auto corner = [&](const Triangle& t, std::size_t i) { return mesh.positions[t[i % 3]]; };
    // They are apart if an edge of one has the other one on its outer side.
    const auto parts = [&](const Triangle& t, const Triangle& other) {
        const double turn = normal_of(mesh, t).z() > 0 ? 1 : -1;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 a = corner(t, i), edge = corner(t, i + 1) - a;
            double most = -std::numeric_limits<double>::infinity();
            for (std::size_t j = 0; j < 3; ++j)
                most = std::max(most, turn * edge.cross(corner(other, j) - a).z() / edge.norm());
            if (most < 1e-9) return true;
        }
        return false;
    };
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            pairs += !parts(mesh.triangles[i], mesh.triangles[j]) && !parts(mesh.triangles[j], mesh.triangles[i]);
    return pairs;
}

/// The triangles as sets of positions: equal for equal meshes with different numbering.
inline std::set<std::array<std::array<double, 3>, 3>> by_position(const TriangleMesh& mesh) {
    std::set<std::array<std::array<double, 3>, 3>> triangles;
    for (const Triangle& t : mesh.triangles) {
        std::array<std::array<double, 3>, 3> corners;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& p = mesh.positions[t[i]];
            corners[i] = {p.x(), p.y(), p.z()};
        }
        std::ranges::rotate(corners, std::ranges::min_element(corners));
        triangles.insert(corners);
    }
    return triangles;
}

inline RegionGrowParams with_max_normal_angle(double degrees) {
    RegionGrowParams params;
    params.max_normal_angle = Angle::degrees(degrees);
    return params;
}

inline PointCloud thinned(const PointCloud& cloud, double voxel) {
    VoxelThinParams params;
    params.bin_size = Length(voxel);
    Context context;
    return voxel_thin(cloud, params, context).points;
}

}  // namespace scanmill::test
