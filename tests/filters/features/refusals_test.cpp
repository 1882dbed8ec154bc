// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <limits>

#include "filters/features/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

TEST(FeaturesRefuse, NoTriangles) { EXPECT_THAT(features_refusal(TriangleMesh{}), HasSubstr("has no triangles")); }

TEST(FeaturesRefuse, ThreeTrianglesAtAnEdge_AndNameIt) {
    const TriangleMesh three =
        mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
    EXPECT_THAT(features_refusal(three),
                AllOf(HasSubstr("between vertex 0 (0, 0, 0) and vertex 1 (1, 0, 0)"),
                      HasSubstr("in 3 triangles, among them 0, 1 and 2"), HasSubstr("in more: 1")));
}

TEST(FeaturesRefuse, NeighboursOrientedDifferently_AndNameThem) {
    TriangleMesh mesh = cube();
    std::vector<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    std::swap(triangles[4][1], triangles[4][2]);
    mesh.triangles = Array<Triangle>(triangles.begin(), triangles.end());
    EXPECT_THAT(features_refusal(mesh), AllOf(HasSubstr("in the same direction"), HasSubstr("such edges: 3"),
                                              HasSubstr("triangles "), HasSubstr(" and 4 pass")));
}

TEST(FeaturesRefuse, AMoebiusBand_InWorldCoordinates) {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    constexpr u32 parts = 12;
    for (u32 i = 0; i < parts; ++i) {
        const Vec3 middle = on_circle(3, i, parts);
        const double turn = std::numbers::pi * i / parts;
        const Vec3 across = middle.normalized() * std::cos(turn) + Vec3::UnitZ() * std::sin(turn);
        positions.push_back(middle + across);
        positions.push_back(middle - across);
        const u32 a = 2 * i, b = 2 * i + 1;
        const bool last = i + 1 == parts;
        const u32 c = last ? 1 : a + 2, d = last ? 0 : b + 2;
        triangles.push_back({a, c, b});
        triangles.push_back({b, c, d});
    }
    TriangleMesh band = mesh_of(positions, triangles);
    band.frame.origin = Vec3(1000, 0, 0);
    const Error error = error_of([&] { features_of(band); });
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("such edges: 1"), HasSubstr("vertex 0 (1004, 0, 0)")));
    EXPECT_THAT(error.hint(), HasSubstr("Moebius"));
}

TEST(FeaturesRefuse, AVertexThatIsNotFinite_OnlyWhereATriangleUsesIt) {
    TriangleMesh mesh = cube();
    std::vector<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    positions.push_back(Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0));
    mesh.positions = Array<Vec3>(positions.begin(), positions.end());
    EXPECT_EQ(features_of(mesh).counts.creases, 12u);
    positions[mesh.triangles[0][0]].z() = std::numeric_limits<double>::infinity();
    mesh.positions = Array<Vec3>(positions.begin(), positions.end());
    EXPECT_THAT(features_refusal(mesh), HasSubstr("of triangle 0 is not finite"));
}

TEST(FeaturesRefuse, SharpEdgesThatNoTriangleHas) {
    TriangleMesh mesh = cube();
    mesh.sharp_edges = {{0, 1}, {0, 7}, {1, 2}};
    EXPECT_THAT(features_refusal(mesh),
                HasSubstr("1 of the mesh's 3 sharp edges is an edge of no triangle; the first is "
                          "between vertices 0 and 7"));
    mesh.sharp_edges = {{0, 7}, {2, 4}, {0, 1}};
    EXPECT_THAT(features_refusal(mesh), HasSubstr("2 of the mesh's 3 sharp edges are edges of no triangle"));
    mesh.sharp_edges = {{0, 7}};
    EXPECT_THAT(features_refusal(mesh), HasSubstr("1 of the mesh's 1 sharp edge is an edge of no triangle"));
}

TEST(FeaturesRefuse, IndicesOutOfRange) {
    TriangleMesh mesh = cube();
    mesh.sharp_edges = {{0, 8}};
    EXPECT_THAT(features_refusal(mesh), HasSubstr("names vertex 8; there are 8"));
}

TEST(FeaturesRefuse, AnglesAndLengthsOutOfRange) {
    FeatureParams params;
    params.sharp_angle = Angle::degrees(181);
    EXPECT_THAT(features_refusal(cube(), params), HasSubstr("sharp-angle must be from 0 to 180 deg; it is 181 deg"));
    params = {};
    params.corner_angle = Angle::degrees(-1);
    EXPECT_THAT(features_refusal(cube(), params), HasSubstr("corner-angle must be"));
    params = {};
    params.min_length = -0.5;
    EXPECT_THAT(features_refusal(cube(), params), HasSubstr("min-length must be 0 or more; it is -0.5"));
    params.min_length = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(features_refusal(cube(), params), HasSubstr("min-length must be"));
}

}  // namespace
}  // namespace scanmill
