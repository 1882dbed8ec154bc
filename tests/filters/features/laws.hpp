// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Feature lines counted in another way: edges in a map, angles by their cosines, no chaining.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "filters/features/cases.hpp"
#include "scanmill/base/disjoint_sets.hpp"

namespace scanmill::test {

/// The edges of a mesh with the triangles at them.
inline std::map<Edge, std::vector<u32>> triangles_at_edges(const TriangleMesh& mesh) {
    std::map<Edge, std::vector<u32>> edges;
    for (u32 t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i)
            edges[make_edge(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3])].push_back(t);
    return edges;
}

struct IndependentCount {
    std::set<Edge> sharp, boundary;
    std::size_t loops = 0, corners = 0, creases = 0;
};

/// Pre: every vertex has one fan, no triangle is without area, no angle is within rounding of a limit.
inline IndependentCount independent_count(const TriangleMesh& mesh, double sharp_degrees, double corner_degrees) {
    const auto cosine = [](double degrees) { return std::cos(degrees * std::numbers::pi / 180); };
    IndependentCount count;
    const auto normal = [&](u32 t) {
        const auto& [a, b, c] = mesh.triangles[t];
        return Vec3((mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).normalized());
    };
    std::map<u32, std::vector<u32>> neighbours;
    DisjointSets boundaries(mesh.positions.size()), rings(mesh.positions.size());
    for (const auto& [edge, triangles] : triangles_at_edges(mesh)) {
        if (triangles.size() == 1)
            count.boundary.insert(edge);
        else if (normal(triangles[0]).dot(normal(triangles[1])) < cosine(sharp_degrees) - 1e-9)
            count.sharp.insert(edge);
        else
            continue;
        neighbours[edge[0]].push_back(edge[1]);
        neighbours[edge[1]].push_back(edge[0]);
    }
    for (const auto& [a, b] : count.boundary) boundaries.unite(a, b);
    for (const auto& [a, b] : count.sharp) rings.unite(a, b);

    std::set<u32> on_border, corner, ringed, components_with_corners;
    for (const auto& [a, b] : count.boundary) on_border.insert({a, b});
    for (const auto& [a, b] : count.sharp) ringed.insert({a, b});
    for (const auto& [vertex, others] : neighbours) {
        const auto direction = [&](u32 other) {
            return Vec3((mesh.positions[other] - mesh.positions[vertex]).normalized());
        };
        if (others.size() != 2 || -direction(others[0]).dot(direction(others[1])) < cosine(corner_degrees) - 1e-9)
            corner.insert(vertex);
    }
    count.corners = corner.size();
    for (const u32 vertex : on_border) count.loops += boundaries.find(vertex) == vertex;
    // Every open crease has two ends, each at a corner; the others are rings, one for each component without a corner.
    std::size_t ends = 0;
    for (const auto& [a, b] : count.sharp) ends += corner.contains(a) + corner.contains(b);
    for (const u32 vertex : corner)
        if (ringed.contains(vertex)) components_with_corners.insert(rings.find(vertex));
    count.creases = ends / 2;
    for (const u32 vertex : ringed)
        count.creases += rings.find(vertex) == vertex && !components_with_corners.contains(vertex);
    return count;
}

inline void expect_counted(const TriangleMesh& mesh, double sharp_degrees, double corner_degrees) {
    FeatureParams params;
    params.sharp_angle = Angle::degrees(sharp_degrees);
    params.corner_angle = Angle::degrees(corner_degrees);
    params.noise = 0;  // the count judges every triangle
    const FeatureLines lines = features_of(mesh, params);
    const IndependentCount count = independent_count(mesh, sharp_degrees, corner_degrees);
    std::size_t sharp = 0, boundary = 0;
    for (const FeaturePolyline& line : lines.graph.polylines)
        (line.type == FeatureType::crease ? sharp : boundary) += line.end - line.begin - !line.closed;
    EXPECT_EQ(sharp, count.sharp.size());
    EXPECT_EQ(boundary, count.boundary.size());
    EXPECT_EQ(lines.counts.creases, count.creases);
    EXPECT_EQ(lines.counts.corners, count.corners);
    EXPECT_GE(lines.counts.holes + lines.counts.boundaries, count.loops) << "loops that touch at a vertex are two";
}

/// Vertices by position; lines by type, first and second vertex; an open line begins at its lower end.
inline void expect_order(const FeatureGraph& graph) {
    const auto position = [](const Vec3& p) { return std::tuple(p.x(), p.y(), p.z()); };
    EXPECT_TRUE(std::ranges::is_sorted(graph.positions, {}, position));
    EXPECT_TRUE(std::ranges::is_sorted(graph.corners));
    EXPECT_TRUE(std::ranges::is_sorted(graph.polylines, {}, [&](const FeaturePolyline& line) {
        return std::tuple(line.type, graph.vertices[line.begin], graph.vertices[line.begin + 1]);
    }));
    for (const FeaturePolyline& line : graph.polylines) {
        const u32 first = graph.vertices[line.begin], last = graph.vertices[line.end - 1];
        EXPECT_TRUE(line.closed || first < last);
        const bool is_ring = line.closed && line.type == FeatureType::crease;
        EXPECT_TRUE(!is_ring || graph.vertices[line.begin + 1] < last);
    }
}

/// Also that only boundaries pass through corners.
inline void expect_normals(const FeatureLines& lines) {
    const FeatureGraph& graph = lines.graph;
    ASSERT_EQ(graph.left_normals.size(), graph.vertices.size());
    ASSERT_EQ(graph.right_normals.size(), graph.vertices.size());
    for (const FeaturePolyline& line : graph.polylines)
        for (u32 row = line.begin; row < line.end; ++row) {
            const bool last = row + 1 == line.end;
            const Vec3 &left = graph.left_normals[row], &right = graph.right_normals[row];
            if (last && !line.closed) {
                EXPECT_EQ(left, Vec3::Zero());
                EXPECT_EQ(right, Vec3::Zero());
                continue;
            }
            const Vec3 direction =
                (graph.positions[graph.vertices[last ? line.begin : row + 1]] - graph.positions[graph.vertices[row]])
                    .normalized();
            EXPECT_NEAR(left.norm(), 1, 1e-12);
            EXPECT_NEAR(left.dot(direction), 0, 1e-6);
            if (line.type == FeatureType::crease) {
                EXPECT_NEAR(right.norm(), 1, 1e-12);
                EXPECT_NEAR(right.dot(direction), 0, 1e-6);
            } else {
                EXPECT_EQ(right, Vec3::Zero());
            }
            const bool is_inner = row > line.begin && line.type == FeatureType::crease;
            EXPECT_FALSE(is_inner && std::ranges::binary_search(graph.corners, graph.vertices[row]));
        }
}

}  // namespace scanmill::test
