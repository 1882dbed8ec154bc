// SPDX-License-Identifier: GPL-3.0-or-later
// PCD through its module: reading.

#include "formats/pcd_files.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(PcdReader, Ascii_KeepsRowsInOrder) {
    Warnings warnings;
    const auto cloud = points_in(xyz_header(2, "ascii") + "1 2 3\n-0.5 1e3 nan\n", "a.pcd", &warnings);
    ASSERT_EQ(cloud->size(), 2u);
    EXPECT_EQ(world_of(*cloud, 0), Vec3(1, 2, 3));
    EXPECT_EQ(world_of(*cloud, 1).head<2>(), Eigen::Vector2d(-0.5, 1000));
    EXPECT_TRUE(std::isnan(world_of(*cloud, 1).z()));
    EXPECT_TRUE(cloud->columns.empty());
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(PcdReader, Binary_KeepsTypesAndNames) {
    const auto cloud =
        points_in(header("x y z intensity ring", "4 4 4 4 2", "F F F F U", 2, "binary") + bytes_of(1.f) +
                      bytes_of(2.f) + bytes_of(3.f) + bytes_of(0.5f) + bytes_of(std::uint16_t(7)) + bytes_of(4.f) +
                      bytes_of(5.f) + bytes_of(6.f) + bytes_of(0.25f) + bytes_of(std::uint16_t(9)),
                  "a.pcd");
    EXPECT_EQ(cloud->positions[1], Vec3(4, 5, 6));
    EXPECT_THAT(cloud->columns.find("intensity")->values<float>(), ElementsAre(0.5f, 0.25f));
    EXPECT_THAT(cloud->columns.find("ring")->values<std::uint16_t>(), ElementsAre(7, 9));
}

TEST(PcdReader, Compressed_IsStoredFieldByField) {
    const std::string fields =
        bytes_of(1.f) + bytes_of(4.f) + bytes_of(2.f) + bytes_of(5.f) + bytes_of(3.f) + bytes_of(6.f);  // x x y y z z
    const auto cloud = points_in(xyz_header(2, "binary_compressed") + compressed_block(fields), "a.pcd");
    EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
}

TEST(PcdReader, DoubleFields_StayDouble) {
    const double x = 5'000'000.000'001;
    const auto cloud = points_in(header("x y z", "8 8 8", "F F F", 2, "binary") + bytes_of(x) + bytes_of(0.1) +
                                     bytes_of(0.2) + bytes_of(x + 1) + bytes_of(0.3) + bytes_of(0.4),
                                 "a.pcd");
    EXPECT_EQ(cloud->frame.origin.x() + cloud->positions[0].x(), x);
    EXPECT_NE(cloud->frame.origin.x(), 0) << "far from zero, positions are relative to an origin";
    EXPECT_EQ(cloud->positions[0].y(), 0.1);
}

TEST(PcdReader, PackedColoursAndNormals_BecomeTheWellKnownColumns) {
    const u32 packed = 0xff102030u;
    const auto rgb = points_in(
        header("x y z rgb normal_x normal_y normal_z", "4 4 4 4 4 4 4", "F F F F F F F", 1, "binary") + bytes_of(1.f) +
            bytes_of(2.f) + bytes_of(3.f) + bytes_of(packed) + bytes_of(0.f) + bytes_of(0.f) + bytes_of(1.f),
        "a.pcd");
    EXPECT_THAT(rgb->columns.find("colour")->values<u8>(), ElementsAre(0x10, 0x20, 0x30));
    EXPECT_EQ(rgb->columns.find("normal")->components(), 3u);
    EXPECT_THAT(rgb->columns.find("normal")->values<float>(), ElementsAre(0, 0, 1));
    EXPECT_EQ(rgb->columns.size(), 2u);
    const auto rgba = points_in(header("x y z rgba", "4 4 4 4", "F F F U", 1, "binary") + bytes_of(1.f) +
                                    bytes_of(2.f) + bytes_of(3.f) + bytes_of(packed),
                                "a.pcd");
    EXPECT_THAT(rgba->columns.find("colour")->values<u8>(), ElementsAre(0x10, 0x20, 0x30, 0xff));
}

TEST(PcdReader, FieldsOfSeveralNumbersAndPadding_AreRead) {
    const std::string text =
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z _ histogram\nSIZE 4 4 4 1 4\nTYPE F F F U F\nCOUNT 1 1 1 4 3\n"
        "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary\n" +
        bytes_of(1.f) + bytes_of(2.f) + bytes_of(3.f) + bytes_of(u32(0)) + bytes_of(7.f) + bytes_of(8.f) +
        bytes_of(9.f);
    const auto cloud = points_in(text, "a.pcd");
    EXPECT_EQ(cloud->columns.size(), 1u);
    EXPECT_EQ(cloud->columns.find("histogram")->components(), 3u);
    EXPECT_THAT(cloud->columns.find("histogram")->values<float>(), ElementsAre(7, 8, 9));
}

TEST(PcdReader, GridAndSensorPose_AreReported) {
    Warnings warnings;
    std::string text = xyz_header(4, "ascii", "# unit mm\n# frame bench\n") + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    text.replace(text.find("WIDTH 4\nHEIGHT 1"), 16, "WIDTH 2\nHEIGHT 2");
    text.replace(text.find("0 0 0 1 0 0 0"), 13, "0 0 5 1 0 0 0");
    const auto cloud = points_in(text, "a.pcd", &warnings);
    EXPECT_EQ(cloud->frame.unit, LengthUnit::millimetre);
    EXPECT_EQ(cloud->frame.name, "bench");
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("the grid of 2 × 2 points"), HasSubstr("VIEWPOINT 0 0 5")));
    const Column* approach = cloud->columns.find("approach");
    ASSERT_TRUE(approach && approach->components() == 3);
    EXPECT_EQ(approach->number(0, 2), 1);
    EXPECT_NEAR(approach->number(1, 0), -1 / std::sqrt(26), 1e-6);
    EXPECT_NEAR(approach->number(1, 2), 5 / std::sqrt(26), 1e-6);
}

TEST(PcdReader, AGridWithoutAPose_WasSeenFromTheOrigin) {
    std::string text = xyz_header(4, "ascii") + "0 0 2\n1 0 2\nnan nan nan\n1 1 2\n";
    text.replace(text.find("WIDTH 4\nHEIGHT 1"), 16, "WIDTH 2\nHEIGHT 2");
    const auto cloud = points_in(text, "a.pcd");
    const Column* approach = cloud->columns.find("approach");
    ASSERT_TRUE(approach);
    EXPECT_EQ(approach->number(0, 2), -1);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(approach->number(2, axis), 0);
}

TEST(PcdReader, AListWithoutAPose_HasNoDirections) {
    EXPECT_FALSE(points_in(xyz_header(1, "ascii") + "1 2 3\n", "a.pcd")->columns.find("approach"));
}

TEST(PcdReader, BlankLinesOfAnAsciiFile_AreNotPoints) {
    const auto cloud = points_in(xyz_header(3, "ascii") + "1 2 3\r\n\r\n4 5 6\r\n  \r\n7 8 9\r\n", "a.pcd");
    EXPECT_EQ(world_of(*cloud, 1), Vec3(4, 5, 6));
    EXPECT_EQ(world_of(*cloud, 2), Vec3(7, 8, 9));
}

TEST(PcdReader, AsciiIntegers_KeepEveryDigitOrAreRefused) {
    const std::string good = header("x y z id", "4 4 4 8", "F F F U", 1, "ascii");
    const auto cloud = points_in(good + "1 2 3 9007199254740993\n", "a.pcd");
    EXPECT_THAT(cloud->columns.find("id")->values<std::uint64_t>(), ElementsAre(9007199254740993u));
    const std::string bytes = header("x y z id", "4 4 4 1", "F F F U", 1, "ascii");
    for (const char* number : {"300", "-1", "1.5", "nan"})
        EXPECT_THAT(sentence_of([&] { read_bytes(bytes + "1 2 3 " + number + "\n", "a.pcd"); }),
                    HasSubstr("is not a uint8 for the field 'id'"))
            << number;
}

TEST(PcdReader, IdentityViewpoint_IsNotReported) {
    Warnings warnings;
    std::string text = xyz_header(1, "ascii") + "1 2 3\n";
    text.replace(text.find("0 0 0 1 0 0 0"), 13, "0.0 0 0 1.0 0 0 0");
    points_in(text, "a.pcd", &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
