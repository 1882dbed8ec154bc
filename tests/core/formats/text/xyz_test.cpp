// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(XyzReader_Separators, BlanksTabsCommasAndSemicolons_ReadAlike) {
    for (const char* text :
         {"1 2 3\n4 5 6\n", "1,2,3\r\n4,5,6", "# remark\n\n 1\t2 \t3  \n4; 5; 6 # end\n\n", "1, 2, 3,\n4, 5, 6,\n"}) {
        const auto cloud = points_in(text, "a.xyz");
        EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6))) << text;
        EXPECT_TRUE(cloud->columns.empty());
    }
}

TEST(XyzReader_Separators, AnEmptyField_IsRefused_RatherThanShiftTheOthers) {
    for (const char* text : {"1,,3,4\n5,6,7,8\n", "1,2,3\n4, ;6\n", ",1,2,3\n", "1,2,3,,\n"})
        EXPECT_THAT(refusal_of(text, "a.csv"), HasSubstr("a field is empty")) << text;
}

TEST(XyzReader_ByteOrderMark, IsPassedOver) {
    EXPECT_EQ(points_in("\xef\xbb\xbf"
                        "1 2 3\n4 5 6\n",
                        "a.csv")
                  ->size(),
              2u);
    EXPECT_EQ(read_bytes("\xef\xbb\xbf"
                         "1 2 3\n",
                         "scan.dat")
                  .format,
              "XYZ");
}

TEST(XyzReader_SixColumns, AreNormalsWhenUnit_ElseTheyAreKeptAndReported) {
    Warnings warnings;
    const auto with = points_in("0 0 0 0.6 0.8 0\n1 1 1 0 0 0\n", "a.xyz", &warnings);
    EXPECT_THAT(numbers_of<double>(with->columns.find("normal")), ElementsAre(0.6, 0.8, 0, 0, 0, 0));
    EXPECT_THAT(warnings.sentences, IsEmpty());
    const auto nan = points_in("0 0 0 0.6 0.8 0\n1 1 1 nan nan nan\n", "a.xyz", &warnings);
    EXPECT_NE(nan->columns.find("normal"), nullptr) << "a row without a normal";
    EXPECT_THAT(warnings.sentences, IsEmpty());
    const auto all_nan = points_in("0 0 0 nan nan nan\n", "a.xyz");
    EXPECT_EQ(all_nan->columns.find("normal"), nullptr);
    const auto without = points_in("0 0 0 0.6 0.8 0\n1 1 1 117 73 49\n", "a.xyz", &warnings);
    EXPECT_EQ(without->columns.find("normal"), nullptr);
    EXPECT_THAT(numbers_of<double>(without->columns.find("c5")), ElementsAre(0.8, 73));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("not unit normals")));
}

TEST(XyzReader_OtherColumns, AreNumberedFromFour) {
    const auto cloud = points_in("0 0 0 7\n1 1 1 8\n", "a.xyz");
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("c4")), ElementsAre(7, 8));
    const auto wide = points_in("0 0 0 0 0 1 9\n", "a.xyz");
    EXPECT_EQ(wide->columns.size(), 4u);
    EXPECT_THAT(numbers_of<double>(wide->columns.find("c7")), ElementsAre(9));
}

TEST(XyzReader_Names, InTheFirstLine_NameTheColumns) {
    const auto cloud = points_in("\"X\",\"Y\",\"Z\",\"Intensity\"\n1,2,3,40\n", "a.csv");
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("Intensity")), ElementsAre(40));
}

TEST(XyzReader_Count, InTheFirstLine_IsChecked) {
    EXPECT_EQ(points_in("2\n1 2 3\n4 5 6\n", "a.pts")->size(), 2u);
    Warnings warnings;
    EXPECT_EQ(points_in("1\n1 2 3\n4 5 6\n", "a.pts", &warnings)->size(), 2u);
    EXPECT_THAT(warnings.sentences, testing::ElementsAre(HasSubstr("declares 1 point; 2 follow")));
}

TEST(XyzReader_Invalid, NanAndInfinity_AreRead) {
    const auto cloud = points_in("nan inf -Infinity\n1 2 3\n", "a.xyz");
    EXPECT_TRUE(std::isnan(cloud->positions[0].x()));
    EXPECT_GT(cloud->positions[0].y(), 1e308);
    EXPECT_LT(cloud->positions[0].z(), -1e308);
}

TEST(XyzReader_Coordinates, BelowTheNormalNumbers_AreKept) {
    const auto cloud = points_in("1e-310 -1e-320 5e-324\n", "a.xyz");
    EXPECT_EQ(world_of(*cloud, 0), Vec3(1e-310, -1e-320, 5e-324));
}

TEST(XyzReader_Content, OfUnknownExtension_IsATableWhenItLooksLikeOne) {
    EXPECT_EQ(read_bytes("1 2 3\n", "scan.dat").format, "XYZ");
    EXPECT_THAT(refusal_of("1 2\n", "scan.dat"), HasSubstr("an unknown format: it begins with '1 2?'"));
}

TEST(XyzWriter_Points, WithNormals_ComeBackExactly_WithUnitAndName) {
    const TemporaryFolder folder;
    Warnings warnings;
    PointCloud cloud;
    cloud.frame = {LengthUnit::metre, Vec3(8388608, -4194304, 0), "site"};
    cloud.positions = {Vec3(0.1, 1e-9, 1.0 / 3), Vec3(0.2, -0.25, 0)};
    cloud.columns.add(Column("normal", 3, Buffer<double>{0.6, 0.8, 0, 1.0 / 3, 2.0 / 3, 2.0 / 3}));
    write_file(folder / "a.xyz", std::make_shared<const PointCloud>(cloud), warnings.writing());
    expect_same_points(*read_points(folder / "a.xyz"), cloud);
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(XyzWriter_File, IsThisForOnePoint_OtherColumnsAreReported) {
    const TemporaryFolder folder;
    Warnings warnings;
    PointCloud cloud{{LengthUnit::inch, Vec3(1, 0, 0), "a\rb"}, {Vec3(0.5, 0.1, -3)}, {}};
    cloud.columns.add(Column("weight", 1, Buffer<float>{2}));
    cloud.columns.add(Column("normal", 3, Buffer<float>{0.1f, 0, 1}));
    write_file(folder / "a.xyz", std::make_shared<const PointCloud>(cloud), warnings.writing());
    EXPECT_EQ(content_of(folder / "a.xyz"), "# unit in\n# frame a b\n1.5 0.1 -3 0.1 0 1\n");
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 column of the points (weight)")));
}

TEST(XyzReader_Numbers, OfMicrosoftsLibraries_AreInfinityAndNan) {
    const auto cloud = points_in("0 0 -1.#IND\n1.#INF -1.#INF00 1.#QNAN0\n5 5 5#glued\n", "a.xyz");
    ASSERT_EQ(cloud->size(), 3u);
    EXPECT_TRUE(std::isnan(cloud->positions[0].z()));
    EXPECT_EQ(cloud->positions[1].x(), std::numeric_limits<double>::infinity());
    EXPECT_EQ(cloud->positions[1].y(), -std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isnan(cloud->positions[1].z()));
    EXPECT_EQ(world_of(*cloud, 2), Vec3(5, 5, 5));
    EXPECT_EQ(points_in("1.#QNAN 0 0\n1 2 3\n", "a.xyz")->size(), 2u) << "its first row is not a count";
    for (const char* word : {"2.#INF", "1.#INF5"})
        EXPECT_THAT(refusal_of(std::string("0 0 ") + word + "\n", "a.xyz"), HasSubstr(word));
}

TEST(Reader_Units, ThatContradictEachOther_AreReported) {
    Warnings warnings;
    EXPECT_EQ(points_in("# unit mm\n# unit in\n0 0 0\n", "a.xyz", &warnings)->frame.unit, LengthUnit::inch);
    EXPECT_THAT(warnings.sentences, testing::ElementsAre(testing::HasSubstr("both 'unit mm' and 'unit in'")));
    warnings.sentences.clear();
    ReadOptions asked = warnings.reading();
    asked.unit = LengthUnit::metre;
    read_bytes("# unit mm\n0 0 0\n", "a.xyz", asked);
    EXPECT_THAT(warnings.sentences,
                testing::ElementsAre(testing::HasSubstr("declares 'unit mm'; it was read in m, as requested")));
}

}  // namespace
}  // namespace scanmill::test
