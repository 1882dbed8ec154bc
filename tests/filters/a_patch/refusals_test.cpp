// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "filters/a_patch/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;

Error refusal(const TriangleMesh& mesh, const APatchParams& params = {}) {
    return error_of([&] { patched(mesh, params); });
}
const double nan = std::numeric_limits<double>::quiet_NaN();

TEST(APatchRefuses, NoTriangles) {
    EXPECT_THAT(refusal(TriangleMesh{}).sentence(), HasSubstr("needs a mesh with triangles"));
}

TEST(APatchRefuses, AnEdgeInThreeTriangles) {
    const Error error =
        refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
    EXPECT_THAT(error.sentence(), HasSubstr("in 3 triangles"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, NeighboursOrientedDifferently) {
    const Error error = refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}));
    EXPECT_THAT(error.sentence(), HasSubstr("in the same direction"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, AVertexWithTwoFans) {
    const Error error =
        refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}));
    EXPECT_THAT(error.sentence(), HasSubstr("at 1 of 5 vertices the triangles do not form one fan"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, ATriangleWithoutArea) {
    const Error error = refusal(soup({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}));
    EXPECT_THAT(error.sentence(), HasSubstr("1 of 2 triangles has no area; the first is triangle 0 at (0, 0, 0)"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, ASurfaceThatIsCutAtAnEdge) {
    const Error error =
        refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 1}}, {{0, 1, 2}, {3, 4, 5}}));
    EXPECT_EQ(error.sentence(),
              "2 of 6 boundary edges coincide with another boundary edge; the first begins at vertex 2 at (0, 1, 0)");
    EXPECT_EQ(error.hint(), "`repair` joins them");
    EXPECT_NO_THROW(
        patched(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-1, 0, 1}, {0, -1, 1}}, {{0, 1, 2}, {3, 4, 5}})))
        << "two fans at one position";
}

TEST(APatchRefuses, PointsOfAnotherFrame) {
    TriangleMesh mesh = geodesic_sphere(1, 2);
    PointCloud points;
    points.positions = mesh.positions;
    points.frame.unit = LengthUnit::metre;
    EXPECT_EQ(error_of([&] { patched(mesh, {}, &points); }).sentence(),
              "the points are in m, the mesh in u; both need one unit");
    mesh.frame = {LengthUnit::metre, Vec3::Zero(), "scanner"};
    EXPECT_NO_THROW(patched(mesh, {}, &points));
    points.frame.name = "machine";
    EXPECT_EQ(error_of([&] { patched(mesh, {}, &points); }).sentence(),
              "the points are in the frame 'machine', the mesh in 'scanner'; both need one frame");
}

TEST(APatchRefuses, NotFiniteVertices) {
    EXPECT_THAT(refusal(soup({{0, 0, 0}, {1, nan, 0}, {0, 1, 0}}, {{0, 1, 2}})).sentence(), HasSubstr("vert"));
}

TEST(APatchRefuses, NotFiniteNormals) {
    std::vector<Vec3> normals(12, Vec3::UnitX());
    normals[3] = Vec3(nan, 0, 0);
    const Error error = refusal(with_normals(icosahedron(), normals));
    EXPECT_THAT(error.sentence(),
                AllOf(HasSubstr("5 of 60 corner normals are NaN"), HasSubstr("the first at triangle")));
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, NormalsThatPointInwards) {
    const TriangleMesh mesh = icosahedron();
    std::vector<Vec3> normals;
    for (const Vec3& p : mesh.positions) normals.push_back(-p);
    const Error error = refusal(with_normals(mesh, normals));
    EXPECT_THAT(error.sentence(), HasSubstr("12 of 12 normals point against the triangles"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, GivenNormalsThatAreNotThere) {
    APatchParams params;
    params.normals = PatchNormals::given;
    const Error error = refusal(icosahedron(), params);
    EXPECT_THAT(error.sentence(), HasSubstr("needs the face column 'corner-normals'; the mesh has none"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, CornerNormalsOfAnotherShape) {
    TriangleMesh mesh = icosahedron();
    mesh.face_columns.add(Column("corner-normals", 3, Buffer<double>(Array<double>(60, 1.0))));
    EXPECT_THAT(refusal(mesh).sentence(), HasSubstr("has 3 numbers per triangle; 9 are needed"));
    EXPECT_FALSE(refusal(mesh).hint().empty());
}

TEST(APatchRefuses, NormalsOfPointsWithoutPoints) {
    APatchParams params;
    params.normals = PatchNormals::points;
    const Error error = refusal(icosahedron(), params);
    EXPECT_THAT(error.sentence(), HasSubstr("the input `points` is not wired"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, NormalsOfAnEmptyCloud) {
    APatchParams params;
    params.normals = PatchNormals::points;
    const PointCloud none;
    const Error error = error_of([&] { patched(icosahedron(), params, &none); });
    EXPECT_EQ(error.sentence(), "`normals: points` needs points; the input `points` is empty");
    EXPECT_FALSE(error.hint().empty());
}

TEST(APatchRefuses, AFactorOutOfRange) {
    APatchParams params;
    params.apex_factor = 1;
    const Error error = refusal(icosahedron(), params);
    EXPECT_THAT(error.sentence(), HasSubstr("apex-factor must be from 1.05 to 3; it is 1"));
    EXPECT_EQ(error.hint(), "the default is 1.5");
}

}  // namespace
}  // namespace scanmill
