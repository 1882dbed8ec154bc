// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Helpers to call cluster-mesh, and slow checks of its results.

#include "cluster_mesh/cluster_mesh.hpp"
#include "filters/region_grow/cases.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "support/doubts.hpp"

namespace scanmill::test {

/// What a run reported.
struct Heard {
    std::vector<std::string> warnings, doubts;
    Metrics metrics;
};

inline ClusterMeshResult clustered(const PointCloud& cloud, const ClusterMeshParams& params = {}, unsigned threads = 1,
                                   Heard* heard = nullptr) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    ClusterMeshResult result = cluster_mesh(cloud, params, context);
    if (heard) *heard = {context.warnings(), doubts_of(context), context.metrics()};
    return result;
}

inline ClusterMeshParams with_max_edge(double length) {
    ClusterMeshParams params;
    params.max_edge = Length(length);
    return params;
}

inline std::size_t self_intersections_of(const TriangleMesh& mesh) {
    Execution execution;
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    return self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, execution, 1).count;
}

inline double volume_of(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c])) / 6;
    return sum;
}

/// What holds for every result: an oriented manifold without self-intersections, edges shorter than max_edge, every
/// point inserted by one case, the corners of a triangle in one cluster, F = 2 V - 2 chi - b.
inline void expect_laws(const PointCloud& cloud, const ClusterMeshResult& result) {
    const TriangleMesh& mesh = result.mesh;
    expect_manifold(mesh);
    EXPECT_EQ(self_intersections_of(mesh), 0u);
    for (const auto& [a, b, c] : mesh.triangles)
        for (const auto& [x, y] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
            ASSERT_LT((mesh.positions[x] - mesh.positions[y]).norm(), result.max_edge);
    const std::size_t distinct = cloud.size() - result.duplicates;
    EXPECT_EQ(result.cases[0] + result.cases[1] + result.cases[2] + result.cases[3], distinct);
    EXPECT_EQ(mesh.positions.size() + result.unused_points, distinct);
    const MeshTopology shape = topology(mesh);
    EXPECT_EQ(shape.boundary_edges, result.boundary_edges);
    EXPECT_EQ(shape.boundary_loops, result.loops);
    EXPECT_EQ(shape.components, result.components);
    for (std::size_t i = 0; i < result.rows.size(); ++i) ASSERT_EQ(mesh.positions[i], cloud.positions[result.rows[i]]);
    for (const char* name : {"cluster-1", "cluster-2"}) {
        const Column* column = mesh.vertex_columns.find(name);
        ASSERT_TRUE(column);
        EXPECT_EQ(column->type(), ScalarType::uint32);
        EXPECT_EQ(column->rows(), mesh.positions.size());
        const auto cluster = column->values<u32>();
        for (const auto& [a, b, c] : mesh.triangles) ASSERT_TRUE(cluster[a] == cluster[b] && cluster[b] == cluster[c]);
    }
}

/// Per row the lowest row of its component of the graph of rows at a distance below `length`, by brute force.
inline std::vector<u32> components_within(const PointCloud& cloud, double length) {
    DisjointSets sets(cloud.size());
    for (u32 a = 0; a < cloud.size(); ++a)
        for (u32 b = 0; b < a; ++b)
            if ((cloud.positions[a] - cloud.positions[b]).squaredNorm() < length * length) sets.unite(a, b);
    std::vector<u32> lowest(cloud.size());
    for (u32 row = 0; row < cloud.size(); ++row) lowest[row] = sets.find(row);
    return lowest;
}

}  // namespace scanmill::test
