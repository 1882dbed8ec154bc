// SPDX-License-Identifier: GPL-3.0-or-later
/// decimate on scanned models and machined parts.
#include <gmock/gmock.h>

#include "filters/decimate_cases.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

std::size_t intersections_of(const TriangleMesh& mesh) {
    Execution execution;
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    return self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, execution, 0).count;
}

TEST(DecimateReal, Bunny_IsWithinTheDistanceWithATenthOfItsTriangles) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/bunny00.off");
    const auto mesh = read_mesh(path);
    const double diagonal = surface_box(*mesh).diagonal();
    for (const double percent : {1.0, 0.1}) {
        const double max_error = percent / 100 * diagonal;
        const DecimateResult result = decimated(*mesh, within(max_error), nullptr, 2);
        expect_laws(*mesh, result, max_error);
        EXPECT_LE(intersections_of(result.mesh), intersections_of(*mesh));
        EXPECT_LE(result.mesh.triangles.size(), mesh->triangles.size() / (percent < 1 ? 5 : 40));
    }
}

TEST(DecimateReal, Dragon_IsWithinTheDistance) {
    SCANMILL_REAL_SCAN(path, fetched_data, "dragon/dragon_vrip_res3.ply");
    const auto mesh = read_mesh(path);
    const double max_error = 0.003 * surface_box(*mesh).diagonal();
    const DecimateResult result = decimated(*mesh, within(max_error), nullptr, 2);
    expect_laws(*mesh, result, max_error);
    EXPECT_LE(intersections_of(result.mesh), intersections_of(*mesh));
    EXPECT_LE(result.mesh.triangles.size(), mesh->triangles.size() / 5);
}

class DecimatedFandisk : public testing::TestWithParam<double> {};

TEST_P(DecimatedFandisk, KeepsEveryCreaseWithinMaxError) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/fandisk_large.off");
    const auto mesh = read_mesh(path);
    const double max_error = GetParam() / 100 * surface_box(*mesh).diagonal();
    const DecimateResult result = decimated(*mesh, within(max_error), nullptr, 2);
    expect_laws(*mesh, result, max_error);
    const FeatureLines before = features_of(*mesh);
    std::vector<Edge> creases;
    for (const FeaturePolyline& line : before.graph.polylines)
        for (u32 row = line.begin; row < line.end; ++row) {
            const bool is_last = row + 1 == line.end;
            if (is_last && !line.closed) continue;
            creases.push_back(
                make_edge(before.graph.vertices[row], before.graph.vertices[is_last ? line.begin : row + 1]));
        }
    ASSERT_GT(creases.size(), 500u);
    TriangleMesh lines;
    lines.positions = before.graph.positions;
    // Every vertex of a crease of the result is one of a crease of the input.
    std::set<std::tuple<double, double, double>> crease_vertices;
    for (const auto& [a, b] : creases)
        for (const u32 v : {a, b})
            crease_vertices.emplace(lines.positions[v].x(), lines.positions[v].y(), lines.positions[v].z());
    for (const auto& [a, b] : result.mesh.sharp_edges) {
        for (const u32 v : {a, b}) {
            const Vec3& p = result.mesh.positions[v];
            EXPECT_TRUE(crease_vertices.contains({p.x(), p.y(), p.z()}));
        }
        // Distance to a line is largest at its vertices or between them where a nearest edge changes; samples.
        for (int i = 0; i <= 8; ++i) {
            const Vec3 p = (i * result.mesh.positions[a] + (8 - i) * result.mesh.positions[b]) / 8.0;
            EXPECT_LE(distance_to_edges(p, lines, creases), max_error * (1 + 1e-6));
        }
    }
    // No line is lost, and none has moved away.
    EXPECT_EQ(result.creases, before.counts.creases);
    for (const auto& [a, b] : creases)
        for (const u32 v : {a, b})
            EXPECT_LE(distance_to_edges(lines.positions[v], result.mesh, result.mesh.sharp_edges.span()),
                      max_error * (1 + 1e-6));
}

INSTANTIATE_TEST_SUITE_P(PercentOfTheDiagonal, DecimatedFandisk, testing::Values(1.0, 0.3, 0.1, 0.03));

TEST(DecimateReal, Fandisk_HasTheCreasesThatFeaturesFinds) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/fandisk_large.off");
    const auto mesh = read_mesh(path);
    const DecimateResult result = decimated(*mesh, within(1e-4 * surface_box(*mesh).diagonal()), nullptr, 2);
    const FeatureLines lines = features_of(*mesh);
    EXPECT_EQ(result.creases, lines.counts.creases);
    EXPECT_EQ(result.corners, lines.counts.corners);
}

}  // namespace
}  // namespace scanmill::test
