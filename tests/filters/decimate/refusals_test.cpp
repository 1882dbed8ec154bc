// SPDX-License-Identifier: GPL-3.0-or-later
/// What decimate refuses, and what it warns about.
#include <gmock/gmock.h>

#include <limits>

#include "filters/decimate/cases.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The sentence of a refusal, which must have a hint.
std::string refusal(const TriangleMesh& mesh, const DecimateParams& params = within(0.1),
                    const PointCloud* points = nullptr) {
    const Error error = error_of([&] { decimated(mesh, params, points); });
    EXPECT_THAT(error.hint(), Not(IsEmpty()));
    return error.sentence();
}

std::string refusal(void (*change)(DecimateParams&)) {
    DecimateParams params = within(0.1);
    change(params);
    return refusal(cube(), params);
}

TEST(DecimateRefuses, MeshWithoutTriangles) {
    EXPECT_EQ(refusal(TriangleMesh{}), "needs a mesh with triangles; this one has 0 vertices and none");
    EXPECT_EQ(refusal(soup({{0, 0, 0}}, {})), "needs a mesh with triangles; this one has 1 vertex and none");
}

TEST(DecimateRefuses, ThreeTrianglesAtAnEdge) {
    EXPECT_THAT(
        refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})),
        HasSubstr("in 3 triangles, among them 0, 1 and 2"));
}

TEST(DecimateRefuses, TwoFansAtAVertex) {
    EXPECT_THAT(
        refusal(soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}})),
        AllOf(HasSubstr("the triangles at vertex 0 (0, 0, 0) form several fans"), HasSubstr("such vertices: 1")));
}

TEST(DecimateRefuses, NeighboursOrientedDifferently) {
    TriangleMesh mesh = cube();
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    std::swap(triangles[4][1], triangles[4][2]);
    mesh.triangles = std::move(triangles);
    EXPECT_THAT(refusal(mesh), AllOf(HasSubstr("in the same direction"), HasSubstr("such edges: 3")));
}

TEST(DecimateRefuses, RepeatedVertex) {
    EXPECT_THAT(refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 1, 2}})),
                HasSubstr("triangle 1 has the vertices 1, 1 and 2; a triangle needs three different vertices"));
}

TEST(DecimateRefuses, VerticesThatAreNotFinite) {
    for (const double bad : {nan, infinity, -infinity}) {
        TriangleMesh mesh = cube();
        Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
        positions[3].y() = bad;
        mesh.positions = std::move(positions);
        EXPECT_THAT(refusal(mesh), HasSubstr("1 of 8 vertices has a NaN or an infinity, the first is number 3"));
    }
}

TEST(DecimateRefuses, IndicesOutOfRange) {
    EXPECT_THAT(sentence_of([] {
                    decimated(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}}), 0.1);
                }),
                HasSubstr("3"));
}

TEST(DecimateRefuses, SharpEdgesThatNoTriangleHas) {
    TriangleMesh mesh = cube();
    mesh.sharp_edges = {{0, 7}};
    EXPECT_THAT(refusal(mesh), HasSubstr("is an edge of no triangle"));
}

TEST(DecimateRefuses, LengthsBelowZeroOrNotFinite) {
    EXPECT_EQ(refusal([](auto& params) { params.max_error = -1; }), "max-error must be 0 or more; it is -1 u");
    EXPECT_THAT(refusal([](auto& params) { params.max_error = nan; }), HasSubstr("max-error must be 0 or more"));
    EXPECT_THAT(refusal([](auto& params) { params.max_error = infinity; }), HasSubstr("max-error must be 0 or more"));
    EXPECT_EQ(refusal([](auto& params) { params.outside = Length(-2); }), "outside must be 0 or more; it is -2 u");
    EXPECT_EQ(refusal([](auto& params) { params.inside = Length(-3); }), "inside must be 0 or more; it is -3 u");
}

TEST(DecimateRefuses, AnglesOutOfRange) {
    EXPECT_EQ(refusal([](auto& params) { params.sharp_angle = Angle::degrees(19); }),
              "sharp-angle must be from 20 to 75 deg; it is 19 deg");
    EXPECT_THAT(refusal([](auto& params) { params.sharp_angle = Angle::degrees(76); }), HasSubstr("it is 76 deg"));
    EXPECT_EQ(refusal([](auto& params) { params.corner_angle = Angle::degrees(181); }),
              "corner-angle must be from 0 to 180 deg; it is 181 deg");
    EXPECT_EQ(refusal([](auto& params) { params.normal_deviation = Angle::degrees(90); }),
              "normal-deviation must be from 0 to 89 deg; it is 90 deg");
    EXPECT_EQ(refusal([](auto& params) { params.min_angle = Angle::degrees(31); }),
              "min-angle must be from 0 to 30 deg; it is 31 deg");
    EXPECT_THAT(refusal([](auto& params) { params.min_angle = Angle::degrees(nan); }), HasSubstr("min-angle must be"));
}

TEST(DecimateRefuses, ValenceOutOfRange) {
    EXPECT_EQ(refusal([](auto& params) { params.max_valence = 5; }), "max-valence must be from 6 to 64; it is 5");
    EXPECT_EQ(refusal([](auto& params) { params.max_valence = 65; }), "max-valence must be from 6 to 64; it is 65");
}

TEST(DecimateRefuses, UnresolvedLength) {
    EXPECT_THAT(sentence_of([] { decimated(cube(), DecimateParams{}); }), HasSubstr("not resolved"));
}

TEST(DecimateRefuses, PointsOfAnotherFrame) {
    TriangleMesh mesh = cube();
    mesh.frame.unit = LengthUnit::millimetre;
    PointCloud points = cloud_of({{0, 0, 0}});
    points.frame.unit = LengthUnit::metre;
    EXPECT_EQ(refusal(mesh, within(0.1), &points), "the points are in m, the mesh in mm; both need one unit");
    points.frame = mesh.frame;
    points.frame.name = "machine";
    EXPECT_EQ(decimated(mesh, within(0.1), &points).points_beyond, 0u);
    mesh.frame.name = "scanner";
    EXPECT_EQ(refusal(mesh, within(0.1), &points),
              "the points are in the frame 'machine', the mesh in 'scanner'; both need one frame");
}

TEST(DecimateRefuses, PointsThatAreNotFinite) {
    const PointCloud points = cloud_of({{0, 0, 0}, {0, nan, 0}});
    EXPECT_THAT(refusal(cube(), within(0.1), &points), HasSubstr("1 of 2 points has a NaN or an infinity"));
}

TEST(DecimateWarns, OfUnusedVertices) {
    TriangleMesh mesh = cube();
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    positions.push_back(Vec3(100, 0, 0));
    mesh.positions = std::move(positions);
    EXPECT_THAT(warnings_of_decimate(mesh, within(0.1)), ElementsAre("1 vertex in no triangle is dropped"));
    EXPECT_EQ(decimated(mesh, 0.1).mesh.positions.size(), 8u);
}

TEST(DecimateWarns, OfColumnsThatItDrops_AndKeepsThoseOfVertices) {
    TriangleMesh mesh = gridded_cube(4);
    Array<u32> numbers(mesh.positions.size()), rows(mesh.triangles.size());
    for (u32 i = 0; i < numbers.size(); ++i) numbers[i] = 3 * i;
    std::ranges::fill(rows, 7u);
    mesh.vertex_columns.add(Column("number", 1, Buffer<u32>(std::move(numbers))));
    Array<u8> classes(mesh.positions.size());
    std::ranges::fill(classes, u8(9));
    mesh.vertex_columns.add(Column("class", 1, Buffer<u8>(std::move(classes))));
    mesh.face_columns.add(Column("region", 1, Buffer<u32>(Array<u32>(rows))));
    mesh.face_columns.add(Column("area", 1, Buffer<u32>(std::move(rows))));
    mesh.edges = {{0, 1}};
    mesh.edge_columns.add(Column("crease", 1, Buffer<u32>{1}));
    EXPECT_THAT(warnings_of_decimate(mesh, within(0.01)),
                ElementsAre("face columns are dropped, because the triangles are new: 'region', 'area'",
                            "edge columns are dropped, because the edges are new: 'crease'",
                            "the vertex column 'class' is replaced by the classes of this filter"));
    const TriangleMesh result = decimated(mesh, 0.01).mesh;
    const std::vector<u32> rows_kept = input_rows(mesh, result);
    for (u32 v = 0; v < result.positions.size(); ++v)
        EXPECT_EQ(result.vertex_columns.find("number")->number(v), 3 * rows_kept[v]);
    EXPECT_EQ(result.vertex_columns.size(), 2u);
    EXPECT_EQ(result.face_columns.size(), 3u);
    EXPECT_EQ(result.edges.size() + result.edge_columns.size(), 0u);
}

TEST(DecimateWarns, OfATargetThatTheLimitsForbid) {
    DecimateParams params = within(0.01);
    params.target_triangles = 2;
    EXPECT_THAT(
        warnings_of_decimate(gridded_cube(4), params),
        ElementsAre(AllOf(HasSubstr("12 triangles are left, but target-triangles is 2"), HasSubstr("forbids"))));
    params.target_triangles = 12;
    EXPECT_THAT(warnings_of_decimate(gridded_cube(4), params), IsEmpty());
}

TEST(DecimateWarns, OfDuplicateVertices_WhichStayASeam) {
    const TriangleMesh left = grid(4, 4), right = shifted(grid(4, 4), Vec3(4, 0, 0));
    const TriangleMesh seam = both(left, right);
    EXPECT_THAT(warnings_of_decimate(seam, within(0.01)),
                Contains(AllOf(HasSubstr("5 vertices have the position of another vertex"), HasSubstr("stays open"))));
    const DecimateResult result = decimated(seam, 0.01);
    EXPECT_EQ(topology(result.mesh).components, 2u);
    EXPECT_EQ(topology(result.mesh).boundary_loops, 2u);
    EXPECT_LE(result.certificate.upper, 1e-12);
    EXPECT_LT(result.mesh.triangles.size(), 20u);
}

}  // namespace
}  // namespace scanmill::test
