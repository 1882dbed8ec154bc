// SPDX-License-Identifier: GPL-3.0-or-later
// GLB: normals, colours and other columns, and those that glTF cannot hold.

#include "formats/assimp_support.hpp"
#include "formats/cube_in_unit.hpp"
#include "formats/glb_container.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(GlbAttributes, Normals_AreRotatedAndNormalised_AndColoursAreLinear) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("normal", 3, Buffer<float>{0, 0, 2, 0.6f, 0.8f, 0}));
    cloud.columns.add(Column("colour", 3, Buffer<u8>{0, 188, 255, 10, 0, 0}));
    Warnings warnings;
    const SeenByAssimp seen = through_assimp(cloud, "a.glb", &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    ASSERT_EQ(seen.normals.size(), 2u);
    EXPECT_LT((seen.normals[0] - Vec3(0, 1, 0)).norm(), 1e-6);
    EXPECT_LT((seen.normals[1] - Vec3(0.6, 0, -0.8)).norm(), 1e-6);
    const Container glb(cloud);
    EXPECT_EQ((*glb.attribute("COLOR_0"))["normalized"], true);
    EXPECT_EQ((*glb.attribute("COLOR_0"))["type"], "VEC4");
    // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4 = 0.502886; 10/255/12.92 = 0.003035.
    EXPECT_EQ(glb.number<std::uint16_t>("COLOR_0", 0, 0), 0);
    EXPECT_NEAR(glb.number<std::uint16_t>("COLOR_0", 0, 1), 0.502886 * 65535, 1);
    EXPECT_EQ(glb.number<std::uint16_t>("COLOR_0", 0, 2), 65535);
    EXPECT_NEAR(glb.number<std::uint16_t>("COLOR_0", 1, 0), 0.0030353 * 65535, 1);
    EXPECT_EQ(glb.number<std::uint16_t>("COLOR_0", 1, 3), 65535);
    EXPECT_FALSE(glb.json["materials"][0].contains("alphaMode"));
}

TEST(GlbAttributes, Opacity_IsKept) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("colour", 4, Buffer<u8>{1, 2, 3, 255, 4, 5, 6, 51}));
    const Container glb(cloud);
    EXPECT_EQ(glb.number<std::uint16_t>("COLOR_0", 1, 3), 51 * 257);
    EXPECT_EQ(glb.json["materials"][0]["alphaMode"], "BLEND");
}

TEST(GlbAttributes, OtherColumns_AreAttributesOfTheirOwn) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("ring", 1, Buffer<std::uint16_t>{7, 65535}));
    cloud.columns.add(Column("bits", 3, Buffer<std::int8_t>{-1, 2, 3, 4, -5, -128}));
    cloud.columns.add(Column("id", 1, Buffer<u32>{16777216, 3}));
    cloud.columns.add(Column("intensity", 1, Buffer<double>{0.5, 0.25}));
    Warnings warnings;
    const Container glb(cloud, &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    EXPECT_EQ((*glb.attribute("_RING"))["componentType"], 5123);
    EXPECT_EQ(glb.number<std::uint16_t>("_RING", 1, 0), 65535);
    EXPECT_EQ((*glb.attribute("_BITS"))["componentType"], 5120);
    EXPECT_EQ((*glb.attribute("_BITS"))["type"], "VEC3");
    EXPECT_EQ(glb.number<std::int8_t>("_BITS", 1, 2), -128);
    EXPECT_EQ(glb.number<float>("_ID", 0, 0), 16777216.f);
    EXPECT_EQ(glb.number<float>("_INTENSITY", 1, 0), 0.25f);
}

TEST(GlbLosses, AreReportedByName) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("lists", Buffer<u64>{0, 1, 1}, Buffer<u32>{4}));
    cloud.columns.add(Column("wide", 5, Buffer<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
    cloud.columns.add(Column("holes", 1, Buffer<float>{NAN, 1}));
    cloud.columns.add(Column("id", 1, Buffer<std::int64_t>{16777217, -3}));
    cloud.columns.add(Column("vast", 1, Buffer<double>{1e300, 1}));
    cloud.columns.add(Column("time", 1, Buffer<double>{0.1, 1}));
    cloud.columns.add(Column("a b", 1, Buffer<float>{1, 2}));
    cloud.columns.add(Column("A_B", 1, Buffer<float>{1, 2}));
    Warnings warnings;
    const Container glb(cloud, &warnings);
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("left out the column 'lists': it holds lists"),
                            HasSubstr("left out the column 'wide': it has 5 numbers per row"),
                            HasSubstr("left out the column 'holes': 1 of its numbers is NaN or infinite"),
                            HasSubstr("left out the column 'id': 1 of its numbers is beyond 2^24"),
                            HasSubstr("left out the column 'vast': 1 of its numbers is beyond"),
                            HasSubstr("rounded the column 'time' to single precision"),
                            HasSubstr("the column 'a b' under the name '_A_B'"),
                            HasSubstr("the column 'A_B' under the name '_A_B_2'")));
    EXPECT_EQ(glb.primitive()["attributes"].size(), 4u) << "POSITION, _TIME, _A_B, _A_B_2";
}

TEST(GlbLosses, NormalsWithoutDirection_AreNotWrittenAsNormals) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("normal", 3, Buffer<float>{0, 0, 1, 0, 0, 0}));
    Warnings warnings;
    const Container glb(cloud, &warnings);
    EXPECT_FALSE(glb.attribute("NORMAL"));
    EXPECT_EQ(glb.number<float>("_NORMAL", 0, 2), 1.f);
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("'normal' as '_NORMAL' and not as normals: 1 of its rows has no")));
}

TEST(GlbLosses, TrianglesWithoutAreaInSinglePrecision_AreReported) {
    TriangleMesh mesh = cube_in(LengthUnit::metre);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    const Triangle first = mesh.triangles[0];
    positions[first[0]] = Vec3(2, 2, 2);
    positions[first[1]] = Vec3(2, 2, 2 + 1e-12);
    mesh.positions = std::move(positions);
    Warnings warnings;
    through_assimp(mesh, "a.glb", &warnings);
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("1 vertex became equal to others in GLB's single precision, and 2 triangles")));
}

TEST(GlbLosses, OfFacesAndEdges_AreReported) {
    TriangleMesh mesh = cube_in(LengthUnit::metre);
    mesh.face_columns.add(Column("group", 1, Buffer<u8>(Array<u8>(12, u8(1)))));
    mesh.sharp_edges = {{0, 1}};
    Warnings warnings;
    through_assimp(mesh, "a.glb", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("GLB left out 1 column of the faces (group)"),
                                                HasSubstr("GLB left out that 1 edge are sharp")));
}

}  // namespace
}  // namespace scanmill::test
