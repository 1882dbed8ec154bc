// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string three_corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string four_corners = three_corners + "v 1 1 0\n";

TEST(ObjReader_Face, OfEachForm_NamesTheSameVertices) {
    const std::string lists = three_corners + "vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n";
    for (const char* face : {"f 3 1 2", "f 3/1 1/2 2/3", "f 3//1 1//2 2//3", "f 3/1/1 1/2/2 2/3/3", "f 3/ 1/ 2/",
                             "f 3// 1// 2//", "f 3/1/ 1/2/ 2/3/", "fo 3 1 2", "\tf  3\t1 2  # the only one"}) {
        const auto mesh = mesh_in(lists + face + "\n", "a.obj");
        EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{2, 0, 1})) << face;
        EXPECT_EQ(mesh->positions[2], Vec3(0, 1, 0)) << face;
    }
}

TEST(ObjReader_Face, NumberedBackwards_CountsFromTheVerticesBeforeIt) {
    const auto mesh = mesh_in(three_corners + "f -3 -2 -1\nv 5 5 5\nf -4 -1 2\n", "a.obj");
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}, Triangle{0, 3, 1}));
}

TEST(ObjReader_Face, MayStandBeforeItsVertices) {
    const auto mesh = mesh_in("f 1 2 3\n" + three_corners, "a.obj");
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}));
}

TEST(ObjReader_Face, OfFourCorners_BecomesAFan_OfTwo_IsLeftOut) {
    Warnings warnings;
    const auto mesh = mesh_in(four_corners + "f 1 2 4 3\nf 1 2\nf 1\nf\nf 1 2 3\n", "a.obj", &warnings);
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{0, 1, 2}));
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("1 face of more than three .*cut"),
                                                ContainsRegex("3 faces of fewer than three .*left out")));
}

TEST(ObjReader_Face, WithAMissingVertex_IsRefusedWithItsLine) {
    for (const auto& [face, warnings] : std::vector<std::pair<const char*, const char*>>{
             {"f 1 2 4\n", "line 4: a face names vertex 4; there are 3 vertices, numbered from 1"},
             {"f 1 2 3\nf 9 2 1\nf 1 11 10\n", "line 5: a face names vertex 9; there are 3 vertices"},
             {"f 1 2 0\n", "line 4: a face names vertex 0; vertices are numbered from 1"},
             {"f 1 2 -4\n", "line 4: a face names vertex -4, counted backwards; there are 3 vertices before it"},
             {"f 1 2 4294967297\n", "line 4: a face names vertex 4294967297;"},
             {"f 1 2 1099511627776\n", "line 4: a face names vertex 1099511627776;"},
             {"f 1 2 9223372036854775807\n", "line 4: a face names vertex 9223372036854775807;"},
             {"f 1 2 -9223372036854775808\n", "line 4: a face names vertex -9223372036854775808,"},
             {"f 1 2 9223372036854775808\n", "line 4: '9223372036854775808' is not a corner of a face"},
             {"f 1 2 three\n", "line 4: 'three' is not a corner of a face"},
             {"f 1 2 3.0\n", "line 4: '3.0' is not a corner of a face"},
             {"f 1 2 3/x/1\n", "line 4: '3/x/1' is not a corner"},
             {"f 1 2 3///1\n", "line 4: '3///1' is not a corner"},
             {"f 1 2 /3\n", "line 4: '/3' is not a corner"}})
        EXPECT_THAT(refusal_of(three_corners + face, "a.obj"), HasSubstr(warnings)) << face;
    // A vertex may follow the face that names it.
    EXPECT_THAT(refusal_of("f 1 2 3\nf 1 2 4\n" + three_corners, "a.obj"), HasSubstr("line 2: a face names vertex 4"));
}

TEST(ObjReader_Vertex, WithoutThreeNumbers_IsRefusedWithItsLine) {
    EXPECT_THAT(refusal_of("v 0 0 0\nv 1 0\n", "a.obj"), ContainsRegex("line 2: .*ends .*coordinate of a vertex"));
    EXPECT_THAT(refusal_of("v 0 0 0\nv 1 O 0\n", "a.obj"), ContainsRegex("line 2: 'O' .*coordinate of a vertex"));
    EXPECT_THAT(refusal_of("v 0 0 0\nv 1 0 0 1 1 1 1 1\n", "a.obj"), HasSubstr("line 2: more than 4 numbers"));
    EXPECT_THAT(refusal_of("v 0 0 0\nvn 1 0\n", "a.obj"), ContainsRegex("line 2: .*ends .*normal"));
    EXPECT_THAT(refusal_of("v 0 0 0\nvt\n", "a.obj"), ContainsRegex("line 2: .*ends .*texture coordinate"));
}

TEST(ObjReader_Vertex, Weight_IsReportedUnlessItIsOne) {
    Warnings warnings;
    EXPECT_EQ(points_in("v 1 2 3 1.0\nv 4 5 6 1\n", "a.obj", &warnings)->positions[1], Vec3(4, 5, 6));
    EXPECT_THAT(warnings.sentences, IsEmpty());
    EXPECT_EQ(points_in("v 1 2 3 0.5\nv 4 5 6 1\n", "a.obj", &warnings)->positions[0], Vec3(1, 2, 3));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("weights of 1 of 2 vertices")));
}

TEST(ObjReader_Vertex, FarFromZero_KeepsItsLastDigits) {
    const auto cloud = points_in("v 665187.522077 5648349.895035 241.767693\nv 665188.5 5648350.25 242\n", "a.obj");
    EXPECT_NE(cloud->frame.origin, Vec3(0, 0, 0));
    EXPECT_EQ(world_of(*cloud, 0), Vec3(665187.522077, 5648349.895035, 241.767693));
}

TEST(ObjReader_Colours, FractionsOfBytesAreBytes_SoAreWholeNumbers_OthersAreDoubles) {
    // 128 / 255 = 0.50196…, 1 is a full channel.
    const auto fractions = points_in("v 0 0 0 0.501961 1 0\nv 1 0 0 0 0.502 1.0\n", "a.obj");
    EXPECT_THAT(numbers_of<u8>(fractions->columns.find("colour")), ElementsAre(128, 255, 0, 0, 128, 255));
    const auto whole = points_in("v 0 0 0 255 1 0\nv 1 0 0 0 128 1\n", "a.obj");
    EXPECT_THAT(numbers_of<u8>(whole->columns.find("colour")), ElementsAre(255, 1, 0, 0, 128, 1));
    const auto four = points_in("v 0 0 0 1 0 0 0.2\n", "a.obj");
    EXPECT_THAT(numbers_of<u8>(four->columns.find("colour")), ElementsAre(255, 0, 0, 51));
    const auto reals = points_in("v 0 0 0 0.5 1 0\nv 1 0 0 0 1 1.0\n", "a.obj");
    EXPECT_EQ(reals->columns.find("colour"), nullptr);
    EXPECT_THAT(numbers_of<double>(reals->columns.find("red")), ElementsAre(0.5, 0));
    EXPECT_THAT(numbers_of<double>(reals->columns.find("blue")), ElementsAre(0, 1));
}

TEST(ObjReader_Colours, ThatNotEveryVertexHas_AreLeftOutAndReported) {
    Warnings warnings;
    EXPECT_TRUE(points_in("v 0 0 0 1 0 0\nv 1 0 0\n", "a.obj", &warnings)->columns.empty());
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("colours of 1 of 2 vertices")));
}

TEST(ObjReader_Text, EveryLineEndAndByteOrderMark_ReadAlike) {
    const std::string text = "# unit mm\n# frame part 7\n" + three_corners + "\n\nf 1 2 3\n";
    for (const char* end : {"\n", "\r\n", "\r"})
        for (const char* begin : {"", "\xef\xbb\xbf"}) {
            std::string other = begin;
            for (char c : text) other.append(c == '\n' ? std::string(end) : std::string(1, c));
            const auto mesh = mesh_in(other, "a.obj");
            EXPECT_EQ(mesh->positions.size(), 3u);
            EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}));
            EXPECT_EQ(mesh->frame.unit, LengthUnit::millimetre);
            EXPECT_EQ(mesh->frame.name, "part 7");
            EXPECT_THAT(refusal_of(other + "f 1 2 4", "a.obj"), HasSubstr("line 9:"));
        }
}

TEST(ObjReader_Text, BackslashAtALinesEnd_ContinuesIt) {
    for (const char* end : {"\n", "\r\n", "\r"}) {
        const std::string e = end;
        const auto mesh = mesh_in(
            "v 0 0 0" + e + "v 1 \\" + e + " 0 0" + e + "v 0\\" + e + "1 0" + e + "f 1 2\\" + e + "\\" + e + " 3" + e,
            "a.obj");
        EXPECT_EQ(mesh->positions[1], Vec3(1, 0, 0));
        EXPECT_EQ(mesh->positions[2], Vec3(0, 1, 0));
        EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}));
    }
    // In a comment it is text, inside a line an ordinary character, and at the text's end no line follows.
    EXPECT_EQ(mesh_in("# C:\\scans\\\n" + three_corners + "mtllib C:\\a\\b.mtl\nf 1 2 3 \\", "a.obj")->triangles.size(),
              1u);
    EXPECT_THAT(refusal_of(three_corners + "f 1 2\\\n 4\n", "a.obj"), HasSubstr("line 5: a face names vertex 4"));
    EXPECT_THAT(refusal_of(three_corners + "f 1 2\\3\n", "a.obj"), HasSubstr("is not a corner of a face"));
}

TEST(ObjReader_Text, Cut_IsReadOrRefused_ByWhatIsLeft) {
    const std::string whole = four_corners + "f 1 2 4\nf 1 4 3";
    EXPECT_EQ(mesh_in(whole, "a.obj")->triangles.size(), 2u);
    Warnings warnings;
    EXPECT_EQ(mesh_in(whole.substr(0, whole.size() - 2), "a.obj", &warnings)->triangles.size(), 1u);
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("1 face of fewer than three .*left out")));
    EXPECT_EQ(points_in(whole.substr(0, four_corners.size()), "a.obj")->size(), 4u);
    EXPECT_THAT(refusal_of(whole.substr(0, four_corners.size() - 3), "a.obj"),
                ContainsRegex("line 4: .*ends .*coordinate of a vertex"));
}

TEST(ObjReader_WithoutVertices, IsRefused) {
    for (const char* text : {"# nothing here\n", "\n\n", "o a\ng b\n", "vn 0 0 1\n"})
        EXPECT_THAT(refusal_of(text, "a.obj"), AllOf(HasSubstr("holds no points: no row is a vertex (v)"))) << text;
    EXPECT_THAT(refusal_of("L\x01\x02\n", "a.obj"),
                HasSubstr("line 1 begins with 'L?\?', which is not an OBJ keyword"));
}

TEST(ObjReader_WithoutFaces, IsACloudOfAllVertices) {
    Warnings warnings;
    EXPECT_EQ(points_in(four_corners + "l 1 2 3\nl 3 4\np 1 2\n", "a.obj", &warnings)->size(), 4u);
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("2 lines .*left out.* line 5"),
                                                ContainsRegex("1 row of points .*left out.* line 7")));
}

TEST(ObjReader_Divisions, AreReportedWhenThereIsMoreThanOne) {
    Warnings warnings;
    mesh_in("o a\ng b c\nusemtl d\ns off\n" + three_corners + "f 1 2 3\ng b c\nusemtl d\n", "a.obj", &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    mesh_in("mtllib a.mtl\no a\ng\ng b c\ng b\nusemtl d\nusemtl e\nusemtl d\ns 1\ns 2\n" + three_corners + "f 1 2 3\n",
            "a.obj", &warnings);
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("3 groups (g), 2 materials (usemtl), 2 smoothing groups (s) were merged"),
                            ContainsRegex("1 material library .*'a.mtl'")));
}

TEST(ObjReader_OtherRows, AreCountedAndReported) {
    Warnings warnings;
    mesh_in(three_corners + "f 1 2 3\nvp 0.5\ncurv 0 1 1 2\nend\nlod 3\nvc 1 0 0\nvc 1 0 0\nHello\n", "a.obj",
            &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("3 rows .*line 5: .*free-form .*'vp', 'curv', 'end'"),
                                                ContainsRegex("1 row .*line 8: .*display .*'lod'"),
                                                ContainsRegex("3 rows .*line 9: .*keyword .*'vc', 'Hello'")));
}

TEST(ObjReader_Content, IsRecognisedWithoutItsExtension) {
    EXPECT_EQ(read_bytes(three_corners, "a.xyz").format, "OBJ");
    EXPECT_EQ(read_bytes("# remark\nmtllib a.mtl\ng a\n" + three_corners, "a").format, "OBJ");
    // More than recognition looks at, cut inside a row.
    std::string large;
    while (large.size() < 10000) large += "v 1.25 -3.5 0.0625\n";
    EXPECT_EQ(read_bytes(large, "a.ply").format, "OBJ");
    // Keywords alone do not override an extension; an unknown keyword excludes OBJ.
    EXPECT_THAT(refusal_of("g a\no b\n", "a"), HasSubstr("no row is a vertex"));
    EXPECT_THAT(refusal_of("g a\no b\n", "a.xyz"), Not(HasSubstr("no row is a vertex")));
    EXPECT_THAT(refusal_of("v 1 2 3\nDear reader\n", "a.dat"), HasSubstr("is in an unknown format"));
    EXPECT_THAT(refusal_of(std::string("\x7f\0\x01v 1 2 3\n", 11), "a.dat"), HasSubstr("is in an unknown format"));
}

}  // namespace
}  // namespace scanmill::test
