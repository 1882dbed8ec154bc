// SPDX-License-Identifier: GPL-3.0-or-later
// Sharp edges of the mesh, short creases, triangles without area, warnings and metrics.

#include <gmock/gmock.h>

#include "filters/features/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(FeaturesWithSharpEdgesOfTheMesh, HaveThemAsCreases) {
    TriangleMesh flat = grid(2, 1);
    // The edge between the two squares, and one of the boundary, which is a line in any case.
    std::vector<Edge> own;
    for (const Triangle& t : flat.triangles)
        for (int i = 0; i < 3; ++i) {
            const Vec3 &a = flat.positions[t[i]], &b = flat.positions[t[(i + 1) % 3]];
            if ((a.x() == 1 && b.x() == 1) || (a.x() == 0 && b.x() == 0))
                own.push_back(make_edge(t[i], t[(i + 1) % 3]));
        }
    std::ranges::sort(own);
    own.erase(std::ranges::unique(own).begin(), own.end());
    ASSERT_EQ(own.size(), 2u);
    EXPECT_EQ(features_of(flat).counts.creases, 0u);
    flat.sharp_edges = Array<Edge>(own.begin(), own.end());
    const FeatureLines lines = features_of(flat);
    EXPECT_EQ(lines.counts.creases, 1u);
    EXPECT_EQ(lines.counts.corners, 6u) << "the crease ends on the boundary";
    EXPECT_THAT(positions_of(lines.graph, lines.graph.polylines[1]), ElementsAre(Vec3(1, 0, 0), Vec3(1, 1, 0)));
    EXPECT_EQ(lines.graph.left_normals[lines.graph.polylines[1].begin], Vec3::UnitZ());
    EXPECT_EQ(lines.graph.right_normals[lines.graph.polylines[1].begin], Vec3::UnitZ());
}

TEST(FeaturesWithALeastLength, AreChainedAgainWithoutTheShortOnes) {
    // A box of 4 × 1 × 1: its eight edges of length 1 are left out; the four long ones stay and meet no other line.
    TriangleMesh box = cube();
    std::vector<Vec3> positions(box.positions.begin(), box.positions.end());
    for (Vec3& p : positions) p.x() *= 4;
    box.positions = Array<Vec3>(positions.begin(), positions.end());
    FeatureParams params;
    params.min_length = 1;
    EXPECT_EQ(features_of(box, params).counts.creases, 12u) << "a crease as long as the limit is not shorter";
    params.min_length = 1.5;
    const FeatureLines lines = features_of(box, params);
    EXPECT_EQ(lines.counts.dropped, 8u);
    EXPECT_EQ(lines.counts.creases, 4u);
    EXPECT_EQ(lines.counts.corners, 8u) << "at the ends of creases";
    params.min_length = 5;
    const FeatureLines none = features_of(box, params);
    EXPECT_EQ(none.counts.dropped, 12u);
    EXPECT_THAT(none.graph.polylines, IsEmpty());
    EXPECT_TRUE(none.graph.positions.empty());
}

TEST(FeaturesWithALeastLength, JoinCreasesThatAShortOneHadDivided) {
    // A strip folded along x = 0, y = 0 … 3; its own sharp edge of length 1 meets the crease in the middle.
    TriangleMesh folded = hinge(60);
    MeshBuilder builder;
    for (const Triangle& t : folded.triangles) {
        std::array<Vec3, 3> p;
        for (std::size_t i = 0; i < 3; ++i) p[i] = folded.positions[t[i]];
        for (const double y : {0.0, 1.0, 2.0, 3.0})
            builder.triangle(p[0] + Vec3(0, y, 0), p[1] + Vec3(0, y, 0), p[2] + Vec3(0, y, 0));
    }
    TriangleMesh strip = builder.mesh();
    const auto vertex_at = [&](const Vec3& position) {
        return static_cast<u32>(std::ranges::find(strip.positions, position) - strip.positions.begin());
    };
    strip.sharp_edges = {make_edge(vertex_at(Vec3(-1, 2, 0)), vertex_at(Vec3(0, 2, 0)))};
    EXPECT_EQ(features_of(strip).counts.creases, 3u);
    FeatureParams params;
    params.min_length = 1.5;
    const FeatureLines lines = features_of(strip, params);
    EXPECT_EQ(lines.counts.dropped, 1u);
    ASSERT_EQ(lines.counts.creases, 1u);
    EXPECT_EQ(length_of(lines.graph, polylines_of(lines.graph, FeatureType::crease)[0]), 4);
}

TEST(FeaturesOfAFlatSquareWithNeedles, AreItsBoundary) {
    // The middle of the diagonal is a vertex of a triangle without area, between the two halves.
    const TriangleMesh mesh =
        mesh_of({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}});
    const FeatureLines lines = features_of(mesh);
    EXPECT_EQ(lines.counts.without_area, 1u);
    EXPECT_EQ(lines.counts.creases, 0u);
    EXPECT_EQ(lines.counts.boundaries, 1u);
    EXPECT_EQ(lines.counts.corners, 4u);
}

TEST(FeaturesOfAHingeWithANeedle, FollowItsShortEdges) {
    // As above, with one half folded up along the diagonal: the crease goes through the middle.
    const TriangleMesh mesh =
        mesh_of({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 0, 3}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}});
    const FeatureLines lines = features_of(mesh);
    EXPECT_EQ(lines.counts.without_area, 1u);
    ASSERT_EQ(lines.counts.creases, 1u);
    EXPECT_THAT(positions_of(lines.graph, polylines_of(lines.graph, FeatureType::crease)[0]),
                ElementsAre(Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(2, 2, 0)));
}

TEST(FeaturesOfAHingeWithNeedlesAmongNeedles, FollowTheirShortEdges) {
    // Six vertices on the crease, between them four triangles without area; the middle one has only such neighbours.
    std::vector<Vec3> positions;
    for (int i = 0; i < 6; ++i) positions.emplace_back(i, 0, 0);
    positions.emplace_back(2.5, 2, 0);
    positions.emplace_back(2.5, 0, -3);
    std::vector<Triangle> triangles{{0, 5, 6}, {0, 2, 4}, {4, 5, 0}, {0, 1, 2}, {2, 3, 4}};
    for (u32 i = 0; i < 5; ++i) triangles.push_back({i + 1, i, 7});
    const FeatureLines lines = features_of(mesh_of(positions, triangles));
    EXPECT_EQ(lines.counts.without_area, 4u);
    ASSERT_EQ(lines.counts.creases, 1u);
    EXPECT_THAT(positions_of(lines.graph, polylines_of(lines.graph, FeatureType::crease)[0]),
                ElementsAre(Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(4, 0, 0), Vec3(5, 0, 0)));
}

TEST(FeaturesOfAMeshWithDoubledVertices, SkipTrianglesThatNameAVertexTwice) {
    TriangleMesh mesh = cube();
    std::vector<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    triangles.insert(triangles.begin() + 3, {5, 5, 1});
    mesh.triangles = Array<Triangle>(triangles.begin(), triangles.end());
    const FeatureLines lines = features_of(mesh);
    EXPECT_EQ(lines.counts.without_area, 1u);
    EXPECT_EQ(lines.counts.creases, 12u);
    EXPECT_EQ(lines.counts.corners, 8u);
}

TEST(Features, ReportCountsAndWarnings) {
    std::vector<std::string> warnings;
    ContextOptions options;
    options.on_warning = [&](std::string_view text) { warnings.emplace_back(text); };
    Context context(options);
    features(frustum(1, 1, 3, 40, false), {}, context);
    EXPECT_THAT(warnings, ElementsAre(testing::HasSubstr(
                              "the area of 2 boundary loops does not decide between outer boundary and hole")));
    for (const auto& [name, count] : std::map<std::string, double>{{"creases", 0},
                                                                   {"holes", 1},
                                                                   {"boundaries", 1},
                                                                   {"corners", 0},
                                                                   {"ambiguous", 2},
                                                                   {"dropped", 0},
                                                                   {"without-area", 0}})
        EXPECT_EQ(context.metrics().find(name)->value, count) << name;
}

TEST(Features, KeepTheFrame) {
    TriangleMesh mesh = cube();
    mesh.frame = {LengthUnit::millimetre, Vec3(1e6, 0, -3), "part"};
    EXPECT_EQ(features_of(mesh).graph.frame, mesh.frame);
}

}  // namespace
}  // namespace scanmill
