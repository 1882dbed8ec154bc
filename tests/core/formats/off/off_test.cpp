// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(OffReader_Plain, CountsOnTheirLineOrOnTheKeywords_ReadAlike) {
    for (const char* begin :
         {"OFF\n3 1 0\n", "OFF 3 1 0\n", "# remark\n\n OFF # here\n\n3 1\n", "OFF3 1 0\r\n", "3 1 0\n"}) {
        const auto mesh = mesh_in(begin + right_triangle + "3 2 1 0\n", "a.off");
        EXPECT_EQ(mesh->positions[2], Vec3(0, 1, 0)) << begin;
        EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{2, 1, 0})) << begin;
    }
}

TEST(OffReader_Plain, Polygon_BecomesAFan) {
    Warnings warnings;
    const auto mesh =
        mesh_in("OFF\n4 2 4\n" + right_triangle + "1 1 0\n4 0 1 3 2\n3 0 1 2 # shade\n", "a.off", &warnings);
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{0, 1, 2}));
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("1 face of more than three .*cut")));
}

TEST(OffReader_Plain, WithoutFaces_IsAPointCloud) {
    EXPECT_EQ(points_in("OFF\n3 0 0\n" + right_triangle, "a.off")->size(), 3u);
}

TEST(OffReader_Colours, WholeNumbersAreBytes_OthersAreDoubles_OneIsAnIndex) {
    const auto bytes = mesh_in("OFF\n3 1 0\n" + right_triangle + "3 0 1 2 255 0 128\n", "a.off");
    EXPECT_THAT(numbers_of<u8>(bytes->face_columns.find("colour")), ElementsAre(255, 0, 128));
    const auto reals = mesh_in("OFF\n3 1 0\n" + right_triangle + "3 0 1 2 1 0.5 0 1\n", "a.off");
    EXPECT_EQ(reals->face_columns.find("colour"), nullptr);
    EXPECT_THAT(numbers_of<double>(reals->face_columns.find("green")), ElementsAre(0.5));
    EXPECT_THAT(numbers_of<double>(reals->face_columns.find("alpha")), ElementsAre(1.0));
    const auto beyond = mesh_in("OFF\n3 1 0\n" + right_triangle + "3 0 1 2 256 255 0\n", "a.off");
    EXPECT_THAT(numbers_of<double>(beyond->face_columns.find("red")), ElementsAre(256.0));
    const auto index = mesh_in("OFF\n3 1 0\n" + right_triangle + "3 0 1 2 7\n", "a.off");
    EXPECT_THAT(numbers_of<double>(index->face_columns.find("colour_index")), ElementsAre(7.0));
}

TEST(OffReader_Colours, FollowTheirFaceIntoTheFan) {
    const auto mesh = mesh_in("OFF\n4 2 0\n" + right_triangle + "1 1 0\n4 0 1 3 2 1 2 3\n3 0 1 2 4 5 6\n", "a.off");
    EXPECT_THAT(numbers_of<u8>(mesh->face_columns.find("colour")), ElementsAre(1, 2, 3, 1, 2, 3, 4, 5, 6));
}

TEST(OffReader_Colours, ThatNotEveryFaceHas_AreLeftOutAndReported) {
    Warnings warnings;
    const auto mesh = mesh_in("OFF\n3 2 0\n" + right_triangle + "3 0 1 2 1 2 3\n3 2 1 0\n", "a.off", &warnings);
    EXPECT_TRUE(mesh->face_columns.empty());
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 of 2 faces")));
    EXPECT_THAT(refusal_of("OFF\n3 1 0\n" + right_triangle + "3 0 1 2 1 2 3 4 5\n", "a.off"),
                HasSubstr("line 6: more than 4"));
    EXPECT_THAT(refusal_of("OFF\n3 1 0\n" + right_triangle + "3 0 1 2 red\n", "a.off"), HasSubstr("line 6: 'red'"));
}

TEST(OffReader_Prefixes, GiveNormalColourAndTexture) {
    const auto cloud =
        points_in("STCNOFF\n2 0 0\n1 2 3  0 0 1  10 20 30 40  0.5 0.25\n4 5 6  0 1 0  11 21 31 41  0.75 1\n", "a.off");
    EXPECT_EQ(cloud->positions[1], Vec3(4, 5, 6));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("normal")), ElementsAre(0, 0, 1, 0, 1, 0));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("colour")), ElementsAre(10, 20, 30, 40, 11, 21, 31, 41));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("texture")), ElementsAre(0.5, 0.25, 0.75, 1));
    EXPECT_EQ(points_in("STOFF\n1 0 0\n1 2 3 0.5 0.25\n", "a.off")->columns.size(), 1u);
    EXPECT_THAT(refusal_of("STOFF\n1 0 0\n1 2 3 0.5\n", "a.off"), HasSubstr("ends before the texture"));
    EXPECT_THAT(refusal_of("NOFF\n1 0 0\n1 2 3 0 1\n", "a.off"), HasSubstr("ends before the normal"));
}

TEST(OffReader_Trailing, Text_IsReported) {
    Warnings warnings;
    mesh_in("OFF\n3 1 0\n" + right_triangle + "3 0 1 2\n3 2 1 0\n", "a.off", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("from line 7 on")));
}

TEST(OffWriter_Mesh, ComesBackExactly_WithUnitAndName) {
    const TemporaryFolder folder;
    Warnings warnings;
    TriangleMesh mesh;
    mesh.frame = {LengthUnit::foot, Vec3(4194304, 0, 0), "site 7"};
    mesh.positions = {Vec3(0.1, 1.0 / 3, -1e-17), Vec3(1, 0, 5e300), Vec3(0, 1, 0)};
    mesh.triangles = {Triangle{2, 1, 0}};
    write_file(folder / "a.off", std::make_shared<const TriangleMesh>(mesh), warnings.writing());
    const auto back = read_mesh(folder / "a.off");
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(back->frame.origin + back->positions[i], mesh.frame.origin + mesh.positions[i]);
    EXPECT_THAT(rows_of(back->triangles), ElementsAre(Triangle{2, 1, 0}));
    EXPECT_EQ(back->frame.unit, LengthUnit::foot);
    EXPECT_EQ(back->frame.name, "site 7");
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(OffWriter_File, IsThisForOneTriangle) {
    const TemporaryFolder folder;
    TriangleMesh mesh;
    mesh.frame.unit = LengthUnit::millimetre;
    mesh.positions = {Vec3(0.1, 0, -2), Vec3(1e21, 0, 0), Vec3(0, 1, 0)};
    mesh.triangles = {Triangle{0, 1, 2}};
    write_file(folder / "a.off", std::make_shared<const TriangleMesh>(mesh));
    EXPECT_EQ(content_of(folder / "a.off"), "OFF\n# unit mm\n3 1 0\n0.1 0 -2\n1e+21 0 0\n0 1 0\n3 0 1 2\n");
}

TEST(OffWriter_Columns, AreWrittenUnderTheirPrefixes_AndReadBackEqual) {
    const Column normal("normal", 3, Buffer<double>{0, 0, 1, 0, 0.6, 0.8, 1.0 / 3, 0, -1});
    const Column texture("texture", 2, Buffer<double>{0, 0, 1, 0, 0, 0.25});
    const Column three("colour", 3, Buffer<u8>{0, 1, 255, 1, 0, 0, 9, 8, 7});
    const Column four("colour", 4, Buffer<u8>{0, 1, 255, 3, 1, 0, 0, 0, 9, 8, 7, 255});
    const std::vector<std::pair<const char*, std::vector<Column>>> cases{{"NOFF\n", {normal}},
                                                                         {"COFF\n", {three}},
                                                                         {"COFF\n", {four}},
                                                                         {"CNOFF\n", {normal, four}},
                                                                         {"STOFF\n", {texture}},
                                                                         {"STCOFF\n", {three, texture}},
                                                                         {"STNOFF\n", {normal, texture}},
                                                                         {"STCNOFF\n", {normal, three, texture}}};
    for (const auto& [keyword, columns] : cases) {
        const TemporaryFolder folder;
        Warnings warnings;
        TriangleMesh mesh;
        mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
        mesh.triangles = {Triangle{0, 1, 2}, Triangle{2, 1, 0}};
        for (const Column& column : columns) mesh.vertex_columns.add(column);
        mesh.face_columns.add(Column("colour", 3, Buffer<u8>{1, 2, 3, 4, 5, 6}));
        write_file(folder / "a.off", std::make_shared<const TriangleMesh>(mesh), warnings.writing());
        EXPECT_THAT(content_of(folder / "a.off"), testing::StartsWith(keyword));
        const auto back = mesh_in(content_of(folder / "a.off"), "a.off", &warnings);
        EXPECT_EQ(back->vertex_columns, mesh.vertex_columns) << keyword;
        EXPECT_EQ(back->face_columns, mesh.face_columns) << keyword;
        EXPECT_THAT(warnings.sentences, IsEmpty()) << keyword;
    }
}

TEST(OffWriter_File, IsThisForAColouredTriangleWithNormals) {
    const TemporaryFolder folder;
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    mesh.triangles = {Triangle{0, 1, 2}};
    mesh.vertex_columns.add(Column("colour", 3, Buffer<u8>{0, 1, 255, 1, 0, 0, 9, 8, 7}));
    mesh.vertex_columns.add(Column("normal", 3, Buffer<float>{0, 0, 1, 0, 0.6f, 0.8f, 0, 0, -1}));
    mesh.face_columns.add(Column("colour", 4, Buffer<u8>{1, 2, 3, 4}));
    write_file(folder / "a.off", std::make_shared<const TriangleMesh>(mesh));
    EXPECT_EQ(content_of(folder / "a.off"),
              "CNOFF\n3 1 0\n0 0 0 0 0 1 0 1 255\n1 0 0 0 0.6 0.8 1 0 0\n0 1 0 0 0 -1 9 8 7\n3 0 1 2 1 2 3 4\n");
}

TEST(OffWriter_Losses, AreReported) {
    const TemporaryFolder folder;
    Warnings warnings;
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    mesh.triangles = {Triangle{0, 1, 2}};
    mesh.vertex_columns.add(Column("normal", 3, Buffer<u8>{0, 0, 1, 0, 0, 1, 0, 0, 1}));
    mesh.vertex_columns.add(Column("colour", 3, Buffer<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}));
    mesh.vertex_columns.add(Column("weight", 1, Buffer<float>{0, 0, 1}));
    mesh.face_columns.add(Column("solid", 1, Buffer<u32>{1}));
    mesh.sharp_edges = {Edge{0, 1}};
    write_file(folder / "a.off", std::make_shared<const TriangleMesh>(mesh), warnings.writing());
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("3 columns of the vertices (normal, colour, weight); PLY"),
                                                HasSubstr("1 column of the faces (solid)"), HasSubstr("1 edge")));
}

}  // namespace
}  // namespace scanmill::test
