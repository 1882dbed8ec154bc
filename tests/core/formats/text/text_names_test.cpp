// SPDX-License-Identifier: GPL-3.0-or-later
// Texts whose columns have names.
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> names_of(const PointCloud& cloud) {
    std::vector<std::string> names;
    for (const Column& column : cloud.columns) names.push_back(column.name());
    return names;
}

TEST(TextNames_Spellings, OfAnyKind_NameTheSameColumns) {
    for (const char* header :
         {"X,Y,Z,Intensity", "x y z Intensity", "\"X\",\"Y\",\"Z\",\"Intensity\"", "'x';'y';'z';'Intensity'",
          "X | Y | Z | Intensity", "//X Y Z Intensity", "// X,Y,Z,Intensity", "# x y z Intensity", "X\tY\tZ\tIntensity",
          "  X , Y , Z , Intensity ,", "X Y Z Intensity // as measured"}) {
        const auto cloud = points_in(std::string(header) + "\n1 2 3 4\n5 6 7 8\n", "a.txt");
        EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(1, 2, 3), Vec3(5, 6, 7))) << header;
        EXPECT_THAT(numbers_of<double>(cloud->columns.find("Intensity")), ElementsAre(4, 8)) << header;
    }
}

TEST(TextNames_Order, OfTheAxes_IsFree) {
    const auto cloud = points_in("time;Z;nz;X;ny;nx;Y\n10;3;1;1;0;0;2\n20;6;0;4;0;1;5\n", "a.csv");
    EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    EXPECT_THAT(names_of(*cloud), ElementsAre("time", "normal"));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("normal")), ElementsAre(0, 0, 1, 1, 0, 0));
}

TEST(TextNames_BlanksInNames, ArePartOfThem_WhereSomethingElseSeparates) {
    EXPECT_THAT(names_of(*points_in("X,Y,Z,GPS Time,\"a b\"\n1,2,3,4,5\n", "a.csv")), ElementsAre("GPS Time", "a b"));
    EXPECT_THAT(names_of(*points_in("X\tY\tZ\tGPS Time\n1\t2\t3\t4\n", "a.txt")), ElementsAre("GPS Time"));
}

TEST(TextNames_EmptyName, IsTheColumnsNumber) {
    EXPECT_THAT(names_of(*points_in("X,Y,,Z,\"\"\n1,2,9,3,8\n", "a.csv")), ElementsAre("c3", "c5"));
}

TEST(TextNames_Normals, OfEverySpelling_AreOneColumn) {
    for (const char* names : {"nx ny nz", "Nx Ny Nz", "NormalX NormalY NormalZ", "normal_x normal_y normal_z"}) {
        Warnings warnings;
        const auto cloud = points_in("x y z " + std::string(names) + "\n1 2 3 0.6 0.8 0\n", "a.txt", &warnings);
        EXPECT_THAT(numbers_of<double>(cloud->columns.find("normal")), ElementsAre(0.6, 0.8, 0)) << names;
        EXPECT_THAT(warnings.sentences, IsEmpty());
    }
}

TEST(TextNames_Normals, OfOtherThanUnitLength_AreReported) {
    Warnings warnings;
    EXPECT_THAT(names_of(*points_in("x y z nx ny nz\n1 2 3 0 0 4\n", "a.txt", &warnings)), ElementsAre("normal"));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("not all normals (nx, ny, nz) have unit length")));
}

TEST(TextNames_Text, TwoOfThreeNormals_StayColumns) {
    EXPECT_THAT(names_of(*points_in("x y z nx ny\n1 2 3 0 1\n", "a.txt")), ElementsAre("nx", "ny"));
}

TEST(TextNames_Colours, OfWholeBytes_AreOneColumn) {
    for (const char* names : {"r g b", "R G B", "red green blue", "Red Green Blue"}) {
        const auto cloud = points_in("x y z " + std::string(names) + "\n1 2 3 0 128 255.0\n", "a.txt");
        EXPECT_THAT(numbers_of<u8>(cloud->columns.find("colour")), ElementsAre(0, 128, 255)) << names;
    }
    const auto with_alpha = points_in("a b g r z y x\n9 3 2 10 0 0 0\n", "a.txt");
    EXPECT_THAT(numbers_of<u8>(with_alpha->columns.find("colour")), ElementsAre(10, 2, 3, 9));
}

TEST(TextNames_Colours, OfOtherNumbers_StayColumns_AndAreReported) {
    // 256 is beyond a byte; 0.5 is of another scale; a largest channel of 1 may be either.
    for (const char* row : {"1 2 3 0 0 256", "1 2 3 0 0.5 1", "1 2 3 0 0 1", "1 2 3 -1 0 5", "1 2 3 nan 0 5"}) {
        Warnings warnings;
        const auto cloud = points_in("x y z R G B\n" + std::string(row) + "\n", "a.txt", &warnings);
        EXPECT_THAT(names_of(*cloud), ElementsAre("R", "G", "B")) << row;
        EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("the columns R, G, B are not colours"))) << row;
    }
    EXPECT_THAT(names_of(*points_in("x y z R G B\n1 2 3 0 0 2\n", "a.txt")), ElementsAre("colour"));
    EXPECT_THAT(names_of(*points_in("x y z R G B\n1 2 3 0 0 0\n", "a.txt")), ElementsAre("colour"));
}

TEST(TextNames_TakenName, KeepsTheComponentsApart) {
    EXPECT_THAT(names_of(*points_in("x y z r g b colour\n0 0 0 1 2 3 4\n", "a.txt")),
                ElementsAre("r", "g", "b", "colour"));
}

TEST(TextNames_InAComment, ThatDoNotNameEveryColumn_AreReportedAndPassedOver) {
    for (const char* comment : {"// x y z intensity weight", "# columns: x y z", "# point x y z"}) {
        Warnings warnings;
        const auto cloud = points_in(std::string(comment) + "\n1 2 3 4\n", "a.txt", &warnings);
        EXPECT_EQ(world_of(*cloud, 0), Vec3(1, 2, 3)) << comment;
        EXPECT_THAT(names_of(*cloud), ElementsAre("c4")) << comment;
        EXPECT_THAT(warnings.sentences,
                    ElementsAre(HasSubstr("was ignored: it does not name x, y, z and then the rest")));
    }
}

TEST(TextNames_Text, InAComment_OfNoAxes_AreAComment) {
    Warnings warnings;
    EXPECT_THAT(names_of(*points_in("# a b c d\n1 2 3 4\n", "a.txt", &warnings)), ElementsAre("c4"));
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(TextNames_Refusals, SayTheLine) {
    EXPECT_THAT(refusal_of("a,b,c\n1,2,3\n", "a.csv"), HasSubstr("line 1: 'a' is neither a row of numbers nor"));
    EXPECT_THAT(refusal_of("X,Y,Y,Z,x\n1,2,3,4,5\n", "a.csv"), HasSubstr("x, y and z once each"));
    EXPECT_THAT(refusal_of("X,Y,Z,x\n1,2,3,4\n", "a.csv"), HasSubstr("x, y and z once each"));
    EXPECT_THAT(refusal_of("# c\nX,Y,Z,I\n1,2,3\n", "a.csv"), HasSubstr("line 3: 3 columns for 4 names"));
    EXPECT_THAT(refusal_of("x,y,z,i,i\n1,2,3,4,5\n", "a.csv"), HasSubstr("two columns are called 'i'"));
    EXPECT_THAT(refusal_of("x,y,z\n1,2,three\n", "a.csv"), HasSubstr("line 2: 'three' is not a number"));
    EXPECT_THAT(refusal_of("x,y,z\n", "a.csv"), HasSubstr("its only line has the names of columns"));
}

TEST(TextNames_Text, UnknownExtension_IsATableWhenItsNamesSaySo) {
    EXPECT_EQ(read_bytes("X,Y,Z\n1,2,3\n", "scan.dat").format, "XYZ");
    EXPECT_THAT(refusal_of("A,B,C\n1,2,3\n", "scan.dat"), HasSubstr("an unknown format"));
}

}  // namespace
}  // namespace scanmill::test
