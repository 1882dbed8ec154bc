// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string scanner = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const std::string still = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

std::string scan(const char* columns, const char* rows, const std::string& matrix, const std::string& cells) {
    return std::string(columns) + "\n" + rows + "\n" + scanner + matrix + cells;
}

constexpr const char* order_left_out = "the order of the cells";

TEST(PtxReader, OneScan_KeepsPointsIntensityAndColour) {
    Warnings warnings;
    const auto cloud =
        points_in(scan("2", "1", still, "1 2 3 0.25 10 20 30\n4 5 6 0.5 40 50 60\n"), "a.ptx", &warnings);
    EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("intensity")), ElementsAre(0.25, 0.5));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("colour")), ElementsAre(10, 20, 30, 40, 50, 60));
    EXPECT_EQ(cloud->columns.find("scan"), nullptr);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr(order_left_out)));
}

TEST(PtxReader, Matrix_TurnsRowVectors_AndMovesByItsLastRow) {
    // A quarter turn about z that maps x to y, as PTX writes it: the first row is the image of x.
    const std::string turn = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n";
    const auto cloud = points_in(scan("1", "2", turn, "1 0 0 0\n0 2 5 0\n"), "a.ptx");
    EXPECT_EQ(world_of(*cloud, 0), Vec3(100, 201, 300));
    EXPECT_EQ(world_of(*cloud, 1), Vec3(98, 200, 305));
}

TEST(PtxReader, DirectionsToTheScanner_TurnWithTheMatrix) {
    const std::string turn = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n";
    const auto cloud = points_in(scan("1", "3", turn, "2 0 0 0\n0 3 4 0\nnan 0 1 0\n"), "a.ptx");
    EXPECT_THAT(numbers_of<float>(cloud->columns.find("approach")), ElementsAre(0, -1, 0, 0.6f, 0, -0.8f, 0, 0, 0));
}

TEST(PtxReader, CellsWithoutReturn_AreLeftOutAndCounted_BeforeTheMatrixMovesThem) {
    Warnings warnings;
    const std::string moved = "1 0 0 0\n0 1 0 0\n0 0 1 0\n7 0 0 1\n";
    const auto cloud = points_in(scan("2", "2", moved, "0 0 0 0.5 0 0 0\n1 0 0 1 1 2 3\n0 0 0 0\n-7 0 0 1 1 2 3\n"),
                                 "a.ptx", &warnings);
    EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(8, 0, 0), Vec3(0, 0, 0)));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("2 of 4 cells without a return"), HasSubstr(order_left_out)));
    EXPECT_THAT(refusal_of(scan("1", "1", still, "0 0 0 0\n"), "a.ptx"), HasSubstr("holds no points: 1 cell without"));
}

TEST(PtxReader, SeveralScans_AreOneCloud_WithAColumn_Reported) {
    Warnings warnings;
    const std::string far = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 9 1\n";
    const auto cloud = points_in(scan("1", "1", still, "1 2 3 0.5\n") + scan("0", "0", still, "") +
                                     scan("1", "2", far, "1 2 3 0.5\n4 5 6 0.5\n"),
                                 "a.ptx", &warnings);
    EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(1, 2, 3), Vec3(1, 2, 12), Vec3(4, 5, 15)));
    EXPECT_THAT(numbers_of<u32>(cloud->columns.find("scan")), ElementsAre(0, 2, 2));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("3 scans"), HasSubstr(order_left_out)));
}

TEST(PtxReader, ColoursOfSomeScansOnly_AreLeftOutAndReported) {
    Warnings warnings;
    const auto cloud = points_in(scan("1", "1", still, "1 2 3 0.5\n") + scan("1", "1", still, "1 2 3 0.5 7 8 9\n"),
                                 "a.ptx", &warnings);
    EXPECT_EQ(cloud->columns.find("colour"), nullptr);
    EXPECT_THAT(warnings.sentences, testing::Contains(HasSubstr("colours of 1 of 2 points")));
}

TEST(PtxReader, ColoursThatAreNoBytes_StayNumbers) {
    Warnings warnings;
    const auto cloud = points_in(scan("1", "1", still, "1 2 3 0.5 0.1 0.2 0.3\n"), "a.ptx", &warnings);
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("green")), ElementsAre(0.2));
    EXPECT_THAT(warnings.sentences, testing::Contains(HasSubstr("red, green, blue are not colours")));
}

TEST(PtxReader, MatrixThatScalesOrMirrors_IsAppliedAndReported) {
    Warnings warnings;
    const std::string scaled = "1 0 0 0\n0 1 0 0\n0 0 2 0\n0 0 0 1\n";
    EXPECT_EQ(world_of(*points_in(scan("1", "1", scaled, "1 2 3 0\n"), "a.ptx", &warnings), 0), Vec3(1, 2, 6));
    EXPECT_THAT(warnings.sentences, testing::Contains(ContainsRegex("rigid .* 1, 1 and 2 long")));
    Warnings mirrored;
    const std::string mirror = "-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    EXPECT_EQ(world_of(*points_in(scan("1", "1", mirror, "1 2 3 0\n"), "a.ptx", &mirrored), 0), Vec3(-1, 2, 3));
    EXPECT_THAT(mirrored.sentences, testing::Contains(HasSubstr("mirrors")));
}

TEST(PtxReader, MatrixThatIsNone_IsRefused) {
    const auto refused = [](const std::string& matrix) {
        return refusal_of(scan("1", "1", matrix, "1 2 3 0\n"), "a.ptx");
    };
    EXPECT_THAT(refused("1 0 0 0\n0 1 0 0\n0 0 0 0\n0 0 0 1\n"), ContainsRegex("line 10: .*scan 0 .*singular"));
    EXPECT_THAT(refused("1 0 0 0\n0 1 0 0\n1 1 0 0\n0 0 0 1\n"), HasSubstr("is singular"));
    EXPECT_THAT(refused("nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), HasSubstr("has a NaN or an infinity"));
    // The translation in the last column: the other convention.
    EXPECT_THAT(refused("1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"),
                HasSubstr("rows of scan 0 are 5, 0, 0, 1; 0, 0, 0, 1"));
}

TEST(PtxReader, Truncated_IsRefusedWithItsLine) {
    EXPECT_THAT(refusal_of(scan("2", "1", still, "1 2 3 0\n"), "a.ptx"),
                HasSubstr("ends after 1 of 2 cells of scan 0"));
    EXPECT_THAT(refusal_of("1\n1\n0 0 0\n", "a.ptx"), ContainsRegex("ends after 3 of 10 lines .*scan 0"));
    EXPECT_THAT(refusal_of("2\n", "a.ptx"), ContainsRegex("ends after 1 of 10 lines .*scan 0"));
    EXPECT_THAT(refusal_of(scan("1", "1", still, "1 2 3 0\n") + "1\n", "a.ptx"),
                ContainsRegex("ends after 1 of 10 lines .*scan 1"));
}

TEST(PtxReader, WrongRows_AreRefusedWithTheirLine) {
    EXPECT_THAT(refusal_of(scan("1", "1", still, "1 2 3\n"), "a.ptx"),
                HasSubstr("line 11: a cell of scan 0 has neither"));
    EXPECT_THAT(refusal_of(scan("1", "1", still, "1 2 3 4 5\n"), "a.ptx"), HasSubstr("line 11: a cell of scan 0"));
    EXPECT_THAT(refusal_of(scan("1", "1", still, "1 2 3 4 5 6 7 8\n"), "a.ptx"), HasSubstr("line 11: a cell of"));
    EXPECT_THAT(refusal_of(scan("2", "1", still, "1 2 3 4\n1 2 3 4 5 6 7\n"), "a.ptx"),
                ContainsRegex("line 12: .*red, green and blue.* scan 0 .*none"));
    EXPECT_THAT(refusal_of(scan("1", "1", still, "1 2 x 4\n"), "a.ptx"), HasSubstr("line 11: 'x' is not a number"));
    EXPECT_THAT(refusal_of(scan("1", "1", still, "1 2 3 4\n5 6 7 8\n"), "a.ptx"),
                ContainsRegex("line 12: .*columns of scan 1"));
    EXPECT_THAT(refusal_of("1\n-1\n" + scanner + still, "a.ptx"), HasSubstr("line 2: expected the number of rows"));
    EXPECT_THAT(refusal_of("1\n1\n0 0\n", "a.ptx"), ContainsRegex("line 3: .*scan 0 has 2 "));
    EXPECT_THAT(refusal_of("1\n1\n0 0 0 0\n", "a.ptx"), ContainsRegex("line 3: .*scan 0 has 4 "));
}

TEST(PtxReader, ManyCells_TakeNoMemory) {
    EXPECT_THAT(refusal_of(scan("1048576", "1048576", still, "1 2 3 4\n"), "a.ptx"),
                HasSubstr("line 1: scan 0 promises 1048576 x 1048576 cells"));
    EXPECT_THAT(refusal_of(scan("18446744073709551615", "2", still, "1 2 3 4\n"), "a.ptx"), HasSubstr("promises"));
}

TEST(PtxReader, Content_IsRecognisedUnderAnyExtension) {
    EXPECT_EQ(read_bytes(scan("1", "1", still, "1 2 3 4\n"), "a.txt").format, "PTX");
    EXPECT_EQ(read_bytes("1\n1 2 3\n", "a.txt").format, "XYZ");
}

TEST(PtxReader, DamagedBytes_AreReadOrRefused_NeverMore) {
    std::mt19937 random(3);
    const std::string bytes = scan("2", "1", still, "1 2 3 0.5 1 2 3\n0 0 0 0 0 0 0\n") +
                              scan("1", "1", "0 1 0 0\n-1 0 0 0\n0 0 1 0\n5 5 5 1\n", "1 2 3 0.5 1 2 3\n");
    ASSERT_NO_THROW(read_bytes(bytes, "a.ptx"));
    for (int round = 0; round < 5000; ++round) {
        std::string damaged = bytes;
        for (u32 hits = 1 + random() % 3; hits > 0; --hits)
            damaged[random() % damaged.size()] = "0123456789-\n .e"[random() % 15];
        try {
            const auto cloud = points_in(damaged, "a.ptx");
            for (const Column& column : cloud->columns) EXPECT_EQ(column.rows(), cloud->size());
        } catch (const Error&) {
        }
    }
}

}  // namespace
}  // namespace scanmill::test
