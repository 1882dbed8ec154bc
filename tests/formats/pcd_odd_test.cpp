// SPDX-License-Identifier: GPL-3.0-or-later
// PCD through its module: refusals, and unusual files with warnings.

#include <random>

#include "formats/pcd_files.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(PcdReader_Refuses, InvalidHeaders) {
    const auto refusal = [](const std::string& text) { return sentence_of([&] { read_bytes(text, "a.pcd"); }); };
    const std::string good = xyz_header(2, "ascii") + "1 2 3\n4 5 6\n";
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    EXPECT_THAT(refusal("# .PCD v0.7\nVERSION 0.7\n"), HasSubstr("ends before its DATA line"));
    EXPECT_THAT(refusal(with("DATA ascii", "DATA runes")), HasSubstr("DATA is 'runes'"));
    EXPECT_THAT(refusal(with("WIDTH 2", "WIDTH two")), HasSubstr("WIDTH needs a whole number; found 'two'"));
    EXPECT_THAT(refusal(with("POINTS 2", "POINTS 3")), HasSubstr("promises 3 points, but WIDTH × HEIGHT is 2 × 1"));
    EXPECT_THAT(refusal(with("SIZE 4 4 4", "SIZE 4 4")), HasSubstr("3 fields and gives 2 sizes"));
    EXPECT_THAT(refusal(with("SIZE 4 4 4", "SIZE 4 4 3")), HasSubstr("the size 3"));
    EXPECT_THAT(refusal(with("x y z", "x y w")), HasSubstr("no field 'z'"));
    EXPECT_THAT(refusal(with("HEIGHT 1", "LENGTH 1")), HasSubstr("not part of a PCD header"));
    EXPECT_THAT(refusal(xyz_header(0, "ascii")), HasSubstr("holds no points"));
    EXPECT_THAT(refusal(with("4 5 6\n", "4 5  \n")), HasSubstr("line 13: found 2 numbers; a point has 3"));
    EXPECT_THAT(refusal(with("4 5 6\n", "4 5 x\n")), HasSubstr("line 13: 'x' is not a float32 for the field 'z'"));
    EXPECT_THAT(refusal(with("4 5 6\n", "7 8 9 10\n")), HasSubstr("line 13: found 4 numbers"));
    EXPECT_THAT(refusal(with("4 5 6\n", "4 5 6\n7 8 9\n")), HasSubstr("line 14: more rows than the 2 points"));
    EXPECT_THAT(refusal(with("4 5 6\n", "\n\n\n\n\n\n\n")), HasSubstr("promises 2 points; 1 follow"));
}

TEST(PcdReader, CoordinatesInCapitals_ArePositions) {
    Warnings warnings;
    const auto cloud = points_in(header("X Y Z Intensity", "4 4 4 4", "F F F F", 2, "ascii") + "1 2 3 7\n4 5 6 8\n",
                                 "a.pcd", &warnings);
    EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    ASSERT_EQ(cloud->columns.size(), 1u);
    EXPECT_EQ(cloud->columns.begin()->name(), "Intensity");
    EXPECT_THAT(warnings.sentences, IsEmpty());
    const auto both = points_in(header("x y z X", "4 4 4 4", "F F F F", 1, "ascii") + "1 2 3 7\n", "a.pcd");
    EXPECT_EQ(world_of(*both, 0), Vec3(1, 2, 3));
    EXPECT_TRUE(both->columns.find("X"));
    EXPECT_THAT(
        sentence_of([] { read_bytes(header("X Y height", "4 4 4", "F F F", 1, "ascii") + "1 2 3\n", "a.pcd"); }),
        HasSubstr("has no field 'Z'; points need x, y and z; its fields are 'X', 'Y' and 'height'"));
}

TEST(PcdReader_Refuses, PaddingInCompressedFiles) {
    EXPECT_THAT(sentence_of([] {
                    read_bytes(header("x _ y z", "4 1 4 4", "F U F F", 1, "binary_compressed") +
                                   compressed_block(std::string(13, '\0')),
                               "a.pcd");
                }),
                HasSubstr("padding"));
}

TEST(PcdReader_Refuses, MorePointsThanTheFileCanHold_WithoutAllocatingThem) {
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

TEST(PcdReader_Refuses, ACompressedBlockOfAnotherSize) {
    const std::string fields(24, '\0');
    const std::string block = compressed_block(fields);
    const auto refusal = [](const std::string& body) {
        return sentence_of([&] { read_bytes(xyz_header(2, "binary_compressed") + body, "a.pcd"); });
    };
    EXPECT_THAT(refusal(block.substr(0, 20)), HasSubstr("bytes follow it"));
    EXPECT_THAT(refusal(bytes_of(u32(25)) + bytes_of(u32(23)) + block.substr(8)), HasSubstr("declares 23 bytes"));
    EXPECT_THAT(refusal(bytes_of(u32(10)) + bytes_of(u32(24)) + block.substr(8)), HasSubstr("PCL cannot decode"));
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

const std::string pcd_head = "SIZE 4 4 4 4 4 4\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 1\nWIDTH 1\nHEIGHT 1\n";

TEST(PcdReader_Normals, AreKnownByEitherOfTheirNames) {
    const auto cloud = points_in("FIELDS x y z nx ny nz\n" + pcd_head + "POINTS 1\nDATA ascii\n1 2 3 0 0 1\n", "a.pcd");
    ASSERT_EQ(cloud->columns.size(), 1u);
    EXPECT_EQ(cloud->columns.find("normal")->number(0, 2), 1);
}

TEST(PcdReader_Fields, WithTheNameOfAnotherColumn_AreRenamedWithAWarning) {
    Warnings warnings;
    const auto cloud = points_in("FIELDS x y z rgb colour label\n" + pcd_head + "POINTS 1\nDATA ascii\n1 2 3 0 5 6\n",
                                 "a.pcd", &warnings);
    EXPECT_EQ(cloud->columns.find("colour_2")->number(0), 5);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("the field 'colour' became the column 'colour_2'")));
    EXPECT_THAT(refusal_of("FIELDS x y z x a b\n" + pcd_head + "DATA ascii\n1 2 3 4 5 6\n", "a.pcd"),
                HasSubstr("line 1: two fields are called 'x'"));
    std::string many = "FIELDS x y z";
    for (int i = 0; i < 998; ++i) many += " a" + std::to_string(i);
    EXPECT_THAT(refusal_of(many + "\n" + pcd_head + "DATA ascii\n", "a.pcd"), HasSubstr("1001 fields; at most 1000"));
}

TEST(PcdReader_Viewpoint, IsSevenNumbers) {
    const std::string fields = "FIELDS x y z a b c\n" + pcd_head;
    EXPECT_THAT(refusal_of(fields + "VIEWPOINT 0 0 0 one 0 0 0\nDATA ascii\n1 2 3 4 5 6\n", "a.pcd"),
                HasSubstr("line 7: 'one' is not a number for VIEWPOINT"));
    EXPECT_THAT(refusal_of(fields + "VIEWPOINT 0 0 0\nDATA ascii\n1 2 3 4 5 6\n", "a.pcd"),
                HasSubstr("line 7: VIEWPOINT has 3 numbers; expected 7"));
}

TEST(PcdReader_WindowsLineEnds, AreNotPartOfCommentsAndNames) {
    Warnings warnings;
    std::string text =
        "# unit mm\n# frame part\nFIELDS x y z a b c\n" + pcd_head + "POINTS 1\nDATA ascii\n1 2 3 4 5 6\n";
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.replace(at, 1, "\r\n");
    const auto cloud = points_in(text, "a.pcd", &warnings);
    EXPECT_EQ(cloud->frame.unit, LengthUnit::millimetre);
    EXPECT_EQ(cloud->frame.name, "part");
    EXPECT_TRUE(cloud->columns.find("c"));
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(PcdReader_FieldsWithoutTypes_ThatReachBeyondThePoint, AreRefused) {
    EXPECT_THAT(refusal_of("FIELDS x y z a b c d\nSIZE 2 8  1 1 1 1 2\nWIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA binary\n" +
                               std::string(100, '\0'),
                           "a.pcd"),
                HasSubstr("fields that do not add up to 16 bytes per point"));
}

TEST(PcdReader_BytesAfterTheLastPoint, AreReported) {
    Warnings warnings;
    points_in("FIELDS x y z a b c\n" + pcd_head + "POINTS 1\nDATA binary\n" + std::string(24, '\0') + "later", "a.pcd",
              &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("5 bytes were left out after the last point")));
    warnings.sentences.clear();
    points_in("FIELDS x y z a b c\n" + pcd_head + "POINTS 1\nDATA binary\n" + std::string(4096, '\0'), "a.pcd",
              &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty()) << "a page filled with zeros";
}

}  // namespace
}  // namespace scanmill::test
