// SPDX-License-Identifier: GPL-3.0-or-later
/// decimate on scanned models and machined parts.
#include <gmock/gmock.h>

#include "filters/decimate/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

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

TEST(DecimateReal, DragonWithMoreThanTwoTrianglesAtEdges_IsRefused) {
    SCANMILL_REAL_SCAN(path, fetched_data, "dragon/dragon_vrip_res3.ply");
    const auto mesh = read_mesh(path);
    const Error error = error_of([&] { decimated(*mesh, 0.001); });
    EXPECT_THAT(error.sentence(), testing::HasSubstr("an edge of a surface is in at most 2"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(DecimateReal, MaxErrorZero_RemovesOnlyWhatIsFlat) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/fandisk.off");
    const auto mesh = read_mesh(path);
    const DecimateResult result = decimated(*mesh, 0);
    expect_laws(*mesh, result, 1e-10 * surface_box(*mesh).diagonal());
    EXPECT_GT(result.removed, 100u);
}

class DecimatedFandisk : public testing::TestWithParam<double> {};

TEST_P(DecimatedFandisk, KeepsEveryCreaseWithinMaxError) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/fandisk.off");
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
    ASSERT_GT(creases.size(), 200u);
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
    // No line longer than the roughness that may go is lost.
    std::size_t lines_checked = 0;
    for (const FeaturePolyline& line : before.graph.polylines) {
        if (length_of(before.graph, line) < 16 * max_error) continue;
        ++lines_checked;
        for (u32 row = line.begin; row < line.end; ++row)
            EXPECT_LE(distance_to_edges(lines.positions[before.graph.vertices[row]], result.mesh,
                                        result.mesh.sharp_edges.span()),
                      max_error * (1 + 1e-6));
    }
    EXPECT_GE(lines_checked, 5u);
}

INSTANTIATE_TEST_SUITE_P(PercentOfTheDiagonal, DecimatedFandisk, testing::Values(1.0, 0.3, 0.1, 0.03));

}  // namespace
}  // namespace scanmill::test
