// SPDX-License-Identifier: GPL-3.0-or-later
// PCD through its module: what is read, what is refused, and that writing and reading back changes nothing.

#include <limits>
#include <random>

#include "core/formats_support.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string header(const std::string& fields, const std::string& sizes, const std::string& types, u32 points,
                   const std::string& data, const std::string& more = "") {
    const std::string count = std::to_string(points);
    std::string counts;
    for (char c : fields) counts += c == ' ' ? " 1" : "";
    return "# .PCD v0.7 - Point Cloud Data file format\n" + more + "VERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes +
           "\nTYPE " + types + "\nCOUNT 1" + counts + "\nWIDTH " + count +
           "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " + data + "\n";
}

std::string xyz_header(u32 points, const std::string& data, const std::string& more = "") {
    return header("x y z", "4 4 4", "F F F", points, data, more);
}

/// An LZF stream that holds the bytes as they are, in runs of at most 32.
std::string lzf_literals(const std::string& bytes) {
    std::string stream;
    for (std::size_t at = 0; at < bytes.size(); at += 32) {
        const std::string run = bytes.substr(at, 32);
        stream += static_cast<char>(run.size() - 1);
        stream += run;
    }
    return stream;
}

std::string compressed_block(const std::string& bytes) {
    const std::string stream = lzf_literals(bytes);
    return bytes_of(static_cast<u32>(stream.size())) + bytes_of(static_cast<u32>(bytes.size())) + stream;
}

TEST(PcdReader, Ascii_KeepsRowsInOrder) {
    Told told;
    const auto cloud = points_in(xyz_header(2, "ascii") + "1 2 3\n-0.5 1e3 nan\n", "a.pcd", &told);
    ASSERT_EQ(cloud->size(), 2u);
    EXPECT_EQ(world_of(*cloud, 0), Vec3(1, 2, 3));
    EXPECT_EQ(world_of(*cloud, 1).head<2>(), Eigen::Vector2d(-0.5, 1000));
    EXPECT_TRUE(std::isnan(world_of(*cloud, 1).z()));
    EXPECT_TRUE(cloud->columns.empty());
    EXPECT_THAT(told.sentences, IsEmpty());
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

TEST(PcdReader, FieldsOfSeveralNumbersAndPadding_AreTakenAsTheyAre) {
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

TEST(PcdReader, GridAndSensorPose_AreTold) {
    Told told;
    std::string text = xyz_header(4, "ascii", "# unit mm\n# frame bench\n") + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    text.replace(text.find("WIDTH 4\nHEIGHT 1"), 16, "WIDTH 2\nHEIGHT 2");
    text.replace(text.find("0 0 0 1 0 0 0"), 13, "0 0 5 1 0 0 0");
    const auto cloud = points_in(text, "a.pcd", &told);
    EXPECT_EQ(cloud->frame.unit, LengthUnit::millimetre);
    EXPECT_EQ(cloud->frame.name, "bench");
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("the grid of 2 × 2 points"), HasSubstr("VIEWPOINT 0 0 5")));
}

TEST(PcdReader_Refuses, WhatItsHeaderCannotMean) {
    const auto refusal = [](const std::string& text) { return sentence_of([&] { read_bytes(text, "a.pcd"); }); };
    const std::string good = xyz_header(2, "ascii") + "1 2 3\n4 5 6\n";
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    EXPECT_THAT(refusal("# .PCD v0.7\nVERSION 0.7\n"), HasSubstr("ends before its DATA line"));
    EXPECT_THAT(refusal(with("DATA ascii", "DATA runes")), HasSubstr("DATA is 'runes'"));
    EXPECT_THAT(refusal(with("WIDTH 2", "WIDTH two")), HasSubstr("WIDTH needs a whole number; found 'two'"));
    EXPECT_THAT(refusal(with("POINTS 2", "POINTS 3")), HasSubstr("promises 3 points, and 2 × 1"));
    EXPECT_THAT(refusal(with("SIZE 4 4 4", "SIZE 4 4")), HasSubstr("3 fields and gives 2 sizes"));
    EXPECT_THAT(refusal(with("SIZE 4 4 4", "SIZE 4 4 3")), HasSubstr("the size 3"));
    EXPECT_THAT(refusal(with("x y z", "x y w")), HasSubstr("no field 'z'"));
    EXPECT_THAT(refusal(with("HEIGHT 1", "LENGTH 1")), HasSubstr("no part of a PCD header"));
    EXPECT_THAT(refusal(xyz_header(0, "ascii")), HasSubstr("holds no points"));
    EXPECT_THAT(refusal(with("4 5 6\n", "4 5  \n")), HasSubstr("line 13: found 2 numbers; a point has 3"));
    EXPECT_THAT(refusal(with("4 5 6\n", "4 5 x\n")), HasSubstr("line 13: 'x' is no float32 for the field 'z'"));
    EXPECT_THAT(refusal(with("4 5 6\n", "7 8 9 10\n")), HasSubstr("line 13: found 4 numbers"));
    EXPECT_THAT(refusal(with("4 5 6\n", "4 5 6\n7 8 9\n")), HasSubstr("line 14: more rows than the 2 points"));
    EXPECT_THAT(refusal(with("4 5 6\n", "\n\n\n\n\n\n\n")), HasSubstr("promises 2 points; 1 follow"));
}

TEST(PcdReader, BlankLinesOfAnAsciiFile_AreNoPoints) {
    const auto cloud = points_in(xyz_header(3, "ascii") + "1 2 3\r\n\r\n4 5 6\r\n  \r\n7 8 9\r\n", "a.pcd");
    EXPECT_EQ(world_of(*cloud, 1), Vec3(4, 5, 6));
    EXPECT_EQ(world_of(*cloud, 2), Vec3(7, 8, 9));
}

TEST(PcdReader, AsciiIntegers_KeepEveryDigitAndNoneIsBent) {
    const std::string good = header("x y z id", "4 4 4 8", "F F F U", 1, "ascii");
    const auto cloud = points_in(good + "1 2 3 9007199254740993\n", "a.pcd");
    EXPECT_THAT(cloud->columns.find("id")->values<std::uint64_t>(), ElementsAre(9007199254740993u));
    const std::string bytes = header("x y z id", "4 4 4 1", "F F F U", 1, "ascii");
    for (const char* number : {"300", "-1", "1.5", "nan"})
        EXPECT_THAT(sentence_of([&] { read_bytes(bytes + "1 2 3 " + number + "\n", "a.pcd"); }),
                    HasSubstr("is no uint8 for the field 'id'"))
            << number;
}

TEST(PcdReader, ViewpointOfNoRotation_IsNotTold) {
    Told told;
    std::string text = xyz_header(1, "ascii") + "1 2 3\n";
    text.replace(text.find("0 0 0 1 0 0 0"), 13, "0.0 0 0 1.0 0 0 0");
    points_in(text, "a.pcd", &told);
    EXPECT_THAT(told.sentences, IsEmpty());
}

TEST(PcdReader_Refuses, PaddingInCompressedFiles) {
    EXPECT_THAT(sentence_of([] {
                    read_bytes(header("x _ y z", "4 1 4 4", "F U F F", 1, "binary_compressed") +
                                   compressed_block(std::string(13, '\0')),
                               "a.pcd");
                }),
                HasSubstr("padding"));
}

TEST(PcdReader_Refuses, MorePointsThanTheFileCanHold_WithoutTakingMemoryForThem) {
    for (const char* data : {"ascii", "binary", "binary_compressed"}) {
        std::string text = xyz_header(7, data) + "0 0 0\n";
        for (std::string_view key : {"WIDTH 7", "POINTS 7"})
            text.replace(text.find(key), key.size(), std::string(key.substr(0, key.size() - 1)) + "4000000000");
        EXPECT_THAT(sentence_of([&] { read_bytes(text, "a.pcd"); }), HasSubstr("promises 4000000000 points")) << data;
    }
    std::string text = xyz_header(7, "binary");
    text.replace(text.find("WIDTH 7"), 7, "WIDTH 1099511627776");
    EXPECT_THROW(read_bytes(text, "a.pcd"), Error);
}

TEST(PcdReader_Refuses, ACompressedBlockThatLies) {
    const std::string fields(24, '\0');
    const std::string block = compressed_block(fields);
    const auto refusal = [](const std::string& body) {
        return sentence_of([&] { read_bytes(xyz_header(2, "binary_compressed") + body, "a.pcd"); });
    };
    EXPECT_THAT(refusal(block.substr(0, 20)), HasSubstr("bytes follow it"));
    EXPECT_THAT(refusal(bytes_of(u32(25)) + bytes_of(u32(23)) + block.substr(8)), HasSubstr("says 23 bytes"));
    EXPECT_THAT(refusal(bytes_of(u32(10)) + bytes_of(u32(24)) + block.substr(8)), HasSubstr("PCL cannot make"));
}

TEST(PcdReader, DamagedFiles_NeverEndTheProgram) {
    const std::string fields =
        bytes_of(1.f) + bytes_of(4.f) + bytes_of(2.f) + bytes_of(5.f) + bytes_of(3.f) + bytes_of(6.f);
    std::mt19937 random(1);
    for (const std::string& good : {xyz_header(2, "ascii") + "1 2 3\n4 5 6\n", xyz_header(2, "binary") + fields,
                                    xyz_header(2, "binary_compressed") + compressed_block(fields)})
        for (int round = 0; round < 1500; ++round) {
            std::string text = good;
            for (u32 change = random() % 4 + 1; change > 0; --change)
                text[random() % text.size()] = static_cast<char>(random() % 256);
            if (random() % 4 == 0) text.resize(random() % text.size() + 1);
            try {
                read_bytes(text, "a.pcd");
            } catch (const Error&) {
            }
        }
}

PointCloud every_column() {
    PointCloud cloud;
    cloud.frame = {LengthUnit::millimetre, Vec3::Zero(), "bench"};
    cloud.positions = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
    cloud.columns.add(Column("normal", 3, Buffer<float>{0, 0, 1, 0, 1, 0}));
    cloud.columns.add(Column("colour", 4, Buffer<u8>{1, 2, 3, 4, 5, 6, 7, 8}));
    cloud.columns.add(Column("time", 1, Buffer<double>{0.1, 0.2}));
    cloud.columns.add(Column("ring", 1, Buffer<std::uint16_t>{7, 9}));
    cloud.columns.add(Column("offset", 1, Buffer<std::int8_t>{-7, 9}));
    cloud.columns.add(Column("histogram", 3, Buffer<float>{1, 2, 3, 4, 5, 6}));
    return cloud;
}

TEST(PcdWriter, EveryColumn_ComesBackTheSame) {
    const TemporaryFolder folder;
    const PointCloud cloud = every_column();
    Told told;
    write_file(folder / "a.pcd", std::make_shared<const PointCloud>(cloud), told.writing());
    const auto back = read_points(folder / "a.pcd");
    EXPECT_EQ(rows_of(back->positions), rows_of(cloud.positions));
    EXPECT_EQ(back->columns, cloud.columns);
    EXPECT_EQ(back->frame, cloud.frame);
    EXPECT_THAT(told.sentences, IsEmpty());
}

TEST(PcdWriter, Positions_AreDoublesOnlyWhereFloatsWouldLose) {
    const TemporaryFolder folder;
    PointCloud cloud;
    cloud.frame.origin = Vec3(5e6, 0, 0);
    cloud.positions = {Vec3(1e-6, 0.1, 0), Vec3(1, 0.2, 0)};
    write_file(folder / "a.pcd", std::make_shared<const PointCloud>(cloud));
    EXPECT_THAT(content_of(folder / "a.pcd"), HasSubstr("SIZE 8 8 8"));
    const auto back = read_points(folder / "a.pcd");
    EXPECT_EQ(Vec3(back->frame.origin + back->positions[0]), Vec3(5e6 + 1e-6, 0.1, 0));
    cloud.frame.origin = Vec3::Zero();
    cloud.positions = {Vec3(1, 0.5, 0)};
    write_file(folder / "b.pcd", std::make_shared<const PointCloud>(cloud));
    EXPECT_THAT(content_of(folder / "b.pcd"), HasSubstr("SIZE 4 4 4"));
}

TEST(PcdWriter_Losses, NamesThatPcdNeedsForItself_AreChangedAndTold) {
    const TemporaryFolder folder;
    Told told;
    PointCloud cloud;
    cloud.positions = {Vec3(1, 2, 3)};
    for (const char* name : {"_", "normal_x", "rgb", "a b", "a_b", "plain"})
        cloud.columns.add(Column(name, 1, Buffer<float>{7}));
    write_file(folder / "a.pcd", std::make_shared<const PointCloud>(cloud), told.writing());
    EXPECT_EQ(told.sentences.size(), 5u);
    const auto back = read_points(folder / "a.pcd");
    EXPECT_EQ(back->columns.size(), 6u);
    for (const char* name : {"__2", "normal_x_2", "rgb_2", "a_b", "a_b_2", "plain"})
        EXPECT_TRUE(back->columns.find(name)) << name;
}

const std::string pcd_head = "SIZE 4 4 4 4 4 4\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 1\nWIDTH 1\nHEIGHT 1\n";

TEST(PcdReader_Normals, AreKnownByEitherOfTheirNames) {
    const auto cloud = points_in("FIELDS x y z nx ny nz\n" + pcd_head + "POINTS 1\nDATA ascii\n1 2 3 0 0 1\n", "a.pcd");
    ASSERT_EQ(cloud->columns.size(), 1u);
    EXPECT_EQ(cloud->columns.find("normal")->number(0, 2), 1);
}

TEST(PcdReader_Fields, ThatTakeAnothersColumn_AreRenamedAndTold) {
    Told told;
    const auto cloud =
        points_in("FIELDS x y z rgb colour label\n" + pcd_head + "POINTS 1\nDATA ascii\n1 2 3 0 5 6\n", "a.pcd", &told);
    EXPECT_EQ(cloud->columns.find("colour_2")->number(0), 5);
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("the field 'colour' became the column 'colour_2'")));
    EXPECT_THAT(refusal_of("FIELDS x y z x a b\n" + pcd_head + "DATA ascii\n1 2 3 4 5 6\n", "a.pcd"),
                HasSubstr("line 1: two fields are called 'x'"));
    std::string many = "FIELDS x y z";
    for (int i = 0; i < 998; ++i) many += " a" + std::to_string(i);
    EXPECT_THAT(refusal_of(many + "\n" + pcd_head + "DATA ascii\n", "a.pcd"), HasSubstr("1001 fields; at most 1000"));
}

TEST(PcdReader_Viewpoint, IsSevenNumbers) {
    const std::string fields = "FIELDS x y z a b c\n" + pcd_head;
    EXPECT_THAT(refusal_of(fields + "VIEWPOINT 0 0 0 one 0 0 0\nDATA ascii\n1 2 3 4 5 6\n", "a.pcd"),
                HasSubstr("line 7: 'one' is no number for VIEWPOINT"));
    EXPECT_THAT(refusal_of(fields + "VIEWPOINT 0 0 0\nDATA ascii\n1 2 3 4 5 6\n", "a.pcd"),
                HasSubstr("line 7: VIEWPOINT has 3 numbers; expected 7"));
}

TEST(PcdReader_WindowsLineEnds, AreNoPartOfCommentsAndNames) {
    Told told;
    std::string text =
        "# unit mm\n# frame part\nFIELDS x y z a b c\n" + pcd_head + "POINTS 1\nDATA ascii\n1 2 3 4 5 6\n";
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.replace(at, 1, "\r\n");
    const auto cloud = points_in(text, "a.pcd", &told);
    EXPECT_EQ(cloud->frame.unit, LengthUnit::millimetre);
    EXPECT_EQ(cloud->frame.name, "part");
    EXPECT_TRUE(cloud->columns.find("c"));
    EXPECT_THAT(told.sentences, IsEmpty());
}

TEST(PcdReader_FieldsWithoutTypes_ThatReachBeyondThePoint, AreRefused) {
    EXPECT_THAT(refusal_of("FIELDS x y z a b c d\nSIZE 2 8  1 1 1 1 2\nWIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA binary\n" +
                               std::string(100, '\0'),
                           "a.pcd"),
                HasSubstr("fields that do not add up to 16 bytes per point"));
}

TEST(PcdReader_BytesBehindTheLastPoint, AreTold) {
    Told told;
    points_in("FIELDS x y z a b c\n" + pcd_head + "POINTS 1\nDATA binary\n" + std::string(24, '\0') + "later", "a.pcd",
              &told);
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("5 bytes were behind the last point and left out")));
    told.sentences.clear();
    points_in("FIELDS x y z a b c\n" + pcd_head + "POINTS 1\nDATA binary\n" + std::string(4096, '\0'), "a.pcd", &told);
    EXPECT_THAT(told.sentences, IsEmpty()) << "a page filled with zeros";
}

TEST(PcdWriter_Losses, ListsAreTold) {
    const TemporaryFolder folder;
    Told told;
    PointCloud cloud;
    cloud.positions = {Vec3(1, 2, 3)};
    cloud.columns.add(Column("seen_by", Buffer<u64>{0, 2}, Buffer<u32>{4, 5}));
    write_file(folder / "a.pcd", std::make_shared<const PointCloud>(cloud), told.writing());
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("the lists of the column 'seen_by'")));
}

}  // namespace
}  // namespace scanmill::test
