// SPDX-License-Identifier: GPL-3.0-or-later
// Normals and texture coordinates, which OBJ binds to the corners of faces.
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string square = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";

std::vector<double> normals_of(std::string_view text, Warnings& warnings) {
    return numbers_of<double>(mesh_in(text, "a.obj", &warnings)->vertex_columns.find("normal"));
}

TEST(ObjReader_Normals, OneToOneWithVertices_BecomeAColumn) {
    Warnings warnings;
    const auto mesh = mesh_in(square + "vn 1 0 0\nvn 0 1 0\nvn 0 0 1\nvn 0 0 -2\nf 1//1 2//2 4//4\nf 1//1 4//4 3//-2\n",
                              "a.obj", &warnings);
    EXPECT_THAT(numbers_of<double>(mesh->vertex_columns.find("normal")),
                ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -2));
    EXPECT_EQ(mesh->vertex_columns.find("normal")->components(), 3u);
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(ObjReader_Normals, SharedOrRepeated_GoToTheirVertices) {
    Warnings warnings;
    // The first is every vertex's; number 3 has equal numbers, so the corners agree.
    EXPECT_THAT(normals_of(square + "vn 0 0 1\nvn 1 0 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 2//3 4//2 3//3\n", warnings),
                ElementsAre(0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0));
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(ObjReader_Normals, ThatDifferAtACorner_AreLeftOutAndReported) {
    Warnings warnings;
    EXPECT_THAT(normals_of(square + "vn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 2//1 4//2 3//2\n", warnings), IsEmpty());
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("normals .*left out.* 1 of 4 vertices .*differ")));
}

TEST(ObjReader_Normals, OfVerticesThatNoFaceNames_AreThoseOfTheirNumber_OrZeros) {
    Warnings warnings;
    EXPECT_THAT(normals_of(square + "vn 0 0 1\nvn 0 0 2\nvn 0 0 3\nvn 0 0 4\nf 1//1 2//2 3//3\n", warnings),
                ElementsAre(0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4));
    EXPECT_THAT(warnings.sentences, IsEmpty());
    EXPECT_THAT(normals_of(square + "vn 0 0 1\nvn 0 0 2\nf 1//1 2//1 3//1\nf 3 2 4\n", warnings),
                ElementsAre(0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0));
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("1 of 2 normals .*left out.* no face"),
                                                ContainsRegex("1 of 4 vertices .*none .*normals")));
}

TEST(ObjReader_Normals, ThatNoFaceNames_BelongToTheVerticesOfEqualNumber_IfAsMany) {
    Warnings warnings;
    const auto cloud = points_in("vn 0 0 1\nv 1 2 3\nvn 0 1 0\nv 4 5 6\n", "a.obj", &warnings);
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("normal")), ElementsAre(0, 0, 1, 0, 1, 0));
    EXPECT_THAT(warnings.sentences, IsEmpty());
    EXPECT_THAT(normals_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 2\nvn 0 0 3\nf 1 2 3\n", warnings),
                ElementsAre(0, 0, 1, 0, 0, 2, 0, 0, 3));
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("no face .*3 normals .*given")));
    warnings.sentences.clear();
    EXPECT_THAT(normals_of(square + "vn 0 0 1\nf 1 2 3\n", warnings), IsEmpty());
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("1 normals .*left out.* no face")));
}

TEST(ObjReader_Normals, ThatAreNotThere_AreReported_AndTheFaceIsKept) {
    for (const char* missing : {"3", "-3", "4294967295", "4294967296", "9223372036854775807", "-9223372036854775808"}) {
        Warnings warnings;
        EXPECT_THAT(normals_of(square + "vn 0 0 1\nvn 0 0 1\nf 1//1 2//2 3//" + missing + "\n", warnings), IsEmpty());
        EXPECT_THAT(warnings.sentences,
                    ElementsAre(ContainsRegex("normals .*left out.* 1 of 3 corners .*missing .* 2")));
    }
    Warnings warnings;
    EXPECT_THAT(normals_of(square + "f 1//1 2//1 3//1\n", warnings), IsEmpty());
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("3 of 3 corners")));
    // They may follow the face, as vertices may.
    EXPECT_THAT(normals_of("f 1//3 2//2 3//1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 2\nvn 0 0 3\n", warnings),
                ElementsAre(0, 0, 3, 0, 0, 2, 0, 0, 1));
}

TEST(ObjReader_Texture, OneToOneWithVertices_BecomesAColumnOfTwo) {
    Warnings warnings;
    const auto mesh =
        mesh_in(square + "vt 0.5\nvt 0.25 1\nvt 0 1 0\nvt 1 1 0.0\nf 1/1 2/2 3/3\nf 2/2 4/4 3/3\n", "a.obj", &warnings);
    EXPECT_THAT(numbers_of<double>(mesh->vertex_columns.find("texture")), ElementsAre(0.5, 0, 0.25, 1, 0, 1, 1, 1));
    EXPECT_EQ(mesh->vertex_columns.find("texture")->components(), 2u);
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(ObjReader_Texture, AtASeam_IsLeftOutAndReported) {
    Warnings warnings;
    const auto mesh = mesh_in(square + "vt 0 0\nvt 1 0\nf 1/1 2/1 3/1\nf 2/2 4/2 3/2\n", "a.obj", &warnings);
    EXPECT_TRUE(mesh->vertex_columns.empty());
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("texture .*left out.* 2 of 4 vertices .*differ")));
}

TEST(ObjReader_Lists, ThirdTextureNumberAndFurtherNumbers_AreReported) {
    Warnings warnings;
    mesh_in(square + "vt 0 0 0.5\nvt 0 0 0 0\nvn 0 0 1 1\nf 1/1/1 2/1/1 3/1/1\nf 2/2/1 4/2/1 3/1/1\n", "a.obj",
            &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("third .* 1 texture coordinate .*left out"),
                                                ContainsRegex("2 rows .*more numbers.* line 6")));
}

}  // namespace
}  // namespace scanmill::test
