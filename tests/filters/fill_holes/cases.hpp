// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Meshes with holes for fill-holes, and the laws of its result.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "fill_holes/fill_holes.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "support/doubts.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {

/// The mesh without the triangles whose row `removes` is true for.
template <class Removes>
TriangleMesh without(const TriangleMesh& mesh, Removes&& removes) {
    Array<Triangle> triangles;
    for (u32 t = 0; t < mesh.triangles.size(); ++t)
        if (!removes(t)) triangles.push_back(mesh.triangles[t]);
    TriangleMesh result = mesh;
    result.triangles = std::move(triangles);
    return without_unused_vertices(result);
}
/// The mesh without the triangles that have a vertex above `height`.
inline TriangleMesh below(const TriangleMesh& mesh, double height) {
    return without(mesh, [&](u32 t) {
        return std::ranges::any_of(mesh.triangles[t], [&](u32 v) { return mesh.positions[v].z() > height; });
    });
}

inline FillHolesParams every_loop() {
    FillHolesParams params;
    params.outer = FillHolesParams::Outer::fill;
    return params;
}

struct Filled : FillHolesResult {
    std::vector<std::string> doubts, warnings;
    Metrics metrics;
};
inline Filled filled(const TriangleMesh& mesh, const FillHolesParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return {fill_holes(mesh, params, context), doubts_of(context), context.warnings(), context.metrics()};
}

/// Pairs of triangles that intersect, with at least one new triangle.
inline std::size_t intersecting_fillings(const TriangleMesh& before, const TriangleMesh& after) {
    const TriangleTree tree(after.positions.span(), after.triangles.span(), 1);
    Execution execution;
    std::size_t count = 0;
    for (const auto& [one, other] :
         self_intersections(after.positions.span(), after.triangles.span(), tree, execution).pairs)
        count += other >= before.triangles.size() || one >= before.triangles.size();
    return count;
}

inline std::size_t self_intersections_of(const TriangleMesh& mesh) {
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    Execution execution;
    return self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, execution).count;
}

/// The input is the beginning of the result; fillings intersect nothing and repeat no edge.
inline void expect_laws(const TriangleMesh& mesh, const FillHolesResult& result) {
    const TriangleMesh& after = result.mesh;
    ASSERT_GE(after.triangles.size(), mesh.triangles.size());
    ASSERT_GE(after.positions.size(), mesh.positions.size());
    EXPECT_TRUE(std::equal(mesh.triangles.begin(), mesh.triangles.end(), after.triangles.begin()));
    EXPECT_TRUE(std::equal(mesh.positions.begin(), mesh.positions.end(), after.positions.begin()));
    EXPECT_EQ(intersecting_fillings(mesh, after), 0u);
    const MeshTopology before = topology(mesh), then = topology(after);
    EXPECT_EQ(then.nonmanifold_edges, 0u);
    EXPECT_EQ(then.misoriented_edges, 0u);
    EXPECT_EQ(then.components, before.components);
    EXPECT_LE(then.nonmanifold_vertices, before.nonmanifold_vertices);
    EXPECT_EQ(then.unused_vertices, before.unused_vertices);
    // Each filling is a disc.
    EXPECT_EQ(then.euler, before.euler + static_cast<long>(result.filled));
    const Column* marks = after.face_columns.find("filled");
    ASSERT_NE(marks, nullptr);
    for (std::size_t t = 0; t < after.triangles.size(); ++t)
        ASSERT_EQ(marks->values<u8>()[t], t >= mesh.triangles.size()) << t;
    ASSERT_NO_THROW(require_consistent(after));
}

}  // namespace scanmill::test
