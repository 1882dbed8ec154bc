// SPDX-License-Identifier: GPL-3.0-or-later
// Input that contradicts itself: sharp edges everywhere, no normals, points of another surface.
#include "filters/a_patch/cases.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::Contains;
using testing::HasSubstr;

TriangleMesh with_every_edge_sharp(TriangleMesh mesh) {
    std::vector<Edge> edges;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) edges.push_back(make_edge(t[i], t[(i + 1) % 3]));
    std::ranges::sort(edges);
    edges.erase(std::ranges::unique(edges).begin(), edges.end());
    mesh.sharp_edges = Array<Edge>(edges.begin(), edges.end());
    return mesh;
}

/// Tessellates; expects a closed surface without self-intersections.
TriangleMesh expect_closed(const PatchRun& run, std::int64_t euler) {
    Execution execution;
    const TriangleMesh fine = tessellate(run.result.patches, {4, {}}, execution);
    EXPECT_TRUE(topology(fine).closed);
    EXPECT_EQ(topology(fine).euler, euler);
    const TriangleTree tree(fine.positions.span(), fine.triangles.span(), 1);
    EXPECT_EQ(self_intersections(fine.positions.span(), fine.triangles.span(), tree, execution).pairs.size(), 0u);
    EXPECT_EQ(run.result.inverted, 0u);
    EXPECT_EQ(run.result.sign_violations, 0u);
    EXPECT_LT(run.result.c1_jump, 1e-9);
    return fine;
}

TEST(APatchContradictions, EveryEdgeSharp_WithNormalsThatAgree_IsTheSmoothSurface) {
    const TriangleMesh mesh = exact_torus(16, 8);
    const PatchRun run = patched(with_every_edge_sharp(mesh)), smooth = patched(mesh);
    EXPECT_EQ(run.result.repairs.smoothed, 3 * mesh.triangles.size() / 2);
    const auto &found = run.result.patches.weights, &wanted = smooth.result.patches.weights;
    ASSERT_EQ(found.size(), wanted.size());
    for (std::size_t row = 0; row < found.size(); ++row)
        for (std::size_t i = 0; i < found[row].size(); ++i) EXPECT_NEAR(found[row][i], wanted[row][i], 1e-13);
}

TEST(APatchContradictions, EveryEdgeSharp_WithTheTrianglesNormals_IsTheMesh) {
    const TriangleMesh mesh = with_every_edge_sharp(icosahedron());
    const PatchRun run = patched(mesh);
    EXPECT_EQ(run.result.repairs.smoothed, 0u);
    const TriangleMesh fine = expect_closed(run, 2);
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    for (const Vec3& p : fine.positions) EXPECT_LT(tree.nearest(p).squared_distance, 1e-24);
}

TEST(APatchContradictions, NoNormalAnywhere_GivesATipAtEveryVertex) {
    const TriangleMesh torus = exact_torus(16, 8);
    const PatchRun run = patched(with_normals(torus, std::vector<Vec3>(torus.positions.size(), Vec3::Zero())));
    const TriangleMesh fine = expect_closed(run, 0);
    for (const Vec3& p : fine.positions) EXPECT_LT(std::abs(torus_distance(p)), 0.1);
}

TEST(APatchContradictions, PointsOnTwoSheets_GiveTheSurfaceBetweenThem) {
    const TriangleMesh mesh = exact_sphere(4);
    Random random(5);
    PointCloud points;
    Array<Vec3> positions;
    for (int i = 0; i < 4000; ++i) {
        const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        positions.push_back(p.normalized() * (i % 2 == 0 ? 0.99 : 1.01));
    }
    points.positions = std::move(positions);
    const PatchRun run = patched(mesh, {}, &points);
    expect_closed(run, 2);
    EXPECT_NEAR(run.result.fit->rms, 0.01, 0.001);
}

TEST(APatchContradictions, PointsOfAnotherObject_AreDoubtful) {
    const TriangleMesh mesh = exact_sphere(4);
    PointCloud points;
    points.positions = geodesic_sphere(2, 20).positions;
    const PatchRun run = patched(mesh, {}, &points);
    EXPECT_EQ(run.result.left_out, points.size());
    EXPECT_THAT(run.warnings, Contains(HasSubstr("check that the mesh and the points show the same object")));
    expect_closed(run, 2);
}

}  // namespace
}  // namespace scanmill
