// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <random>

#include "las_support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::array<std::size_t, 11> point_sizes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

LasBytes one_point(u32 format, std::size_t extra = 0) {
    LasBytes las;
    las.minor_version = format < 4 ? 2 : format < 6 ? 3 : 4;
    las.point_format = format;
    las.points = {las_point(point_sizes[format] + extra, 1, 2, 3)};
    return las;
}

TEST(LasReader_Positions, AreIntegersTimesScalePlusOffset) {
    LasBytes las = one_point(0);
    las.scale = {0.5, 0.25, 2};
    las.offset = {10, 0, -1};
    las.points.push_back(las_point(20, -4, 0, 2147483647));
    const auto cloud = points_in(las.file(), "a.las");
    EXPECT_EQ(world_of(*cloud, 0), Vec3(10.5, 0.5, 5));
    EXPECT_EQ(world_of(*cloud, 1), Vec3(8, 0, 4294967293.0));
}

TEST(LasReader_Positions_FarAway, KeepStepsThatTheFullCoordinateHasNoBitsFor) {
    LasBytes las = one_point(0);
    const double step = std::ldexp(1.0, -40);
    las.scale = {step, step, step};
    las.offset = {5000000, 400000, 100};
    las.points = {las_point(20, 0, 0, 0), las_point(20, 1, 2, 3), las_point(20, 1000000, 0, 0)};
    const auto cloud = points_in(las.file(), "a.las");
    EXPECT_EQ(Vec3(cloud->positions[1] - cloud->positions[0]), Vec3(step, 2 * step, 3 * step));
    EXPECT_EQ(world_of(*cloud, 0), Vec3(5000000, 400000, 100));
}

TEST(LasReader, NegativeScale_IsRead) {
    LasBytes las = one_point(0);
    las.scale = {-1, 1, 1};
    las.offset = {1000000, 0, 0};
    EXPECT_EQ(world_of(*points_in(las.file(), "a.las"), 0), Vec3(999999, 2, 3));
}

TEST(LasReader, ScaleThatTakesCoordinatesBeyondDouble_LeavesThemInfinite_AroundAFiniteOrigin) {
    LasBytes las;
    las.scale = {1, 1, 1e300};
    las.points = {las_point(20, 1, 2, 2'000'000'000)};
    const auto cloud = points_in(las.file(), "a.las");
    EXPECT_EQ(cloud->frame.origin, Vec3::Zero());
    EXPECT_EQ(cloud->positions[0], Vec3(1, 2, std::numeric_limits<double>::infinity()));
}

TEST(LasReader_OldPointFormats, HaveTheirFields) {
    LasBytes las = one_point(3);
    std::string& point = las.points[0];
    put_at(point, 12, std::uint16_t(65535));
    point[14] = static_cast<char>(0b01'101'010);  // direction, 5 returns, the second
    point[15] = static_cast<char>(0b100'00110);   // withheld, class 6
    point[16] = static_cast<char>(-17);
    point[17] = 42;
    put_at(point, 18, std::uint16_t(777));
    put_at(point, 20, 123456.789);
    put_at(point, 28, std::uint16_t(1));
    put_at(point, 30, std::uint16_t(2));
    put_at(point, 32, std::uint16_t(255));
    Warnings warnings;
    const auto cloud = points_in(las.file(), "a.las", &warnings);
    EXPECT_THAT(column_names(*cloud),
                ElementsAre("intensity", "return_number", "number_of_returns", "classification", "scan_angle",
                            "user_data", "point_source_id", "scan_direction", "withheld", "gps_time", "colour"));
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("intensity")), ElementsAre(65535));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("return_number")), ElementsAre(2));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("number_of_returns")), ElementsAre(5));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("classification")), ElementsAre(6));
    EXPECT_THAT(numbers_of<float>(cloud->columns.find("scan_angle")), ElementsAre(-17));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("user_data")), ElementsAre(42));
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("point_source_id")), ElementsAre(777));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("gps_time")), ElementsAre(123456.789));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("colour")), ElementsAre(1, 2, 255));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("withheld")), ElementsAre(1));
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(LasReader_NewPointFormats, HaveTheirFields) {
    LasBytes las = one_point(8);
    std::string& point = las.points[0];
    point[14] = static_cast<char>(0xf3);          // 15 returns, the third
    point[15] = static_cast<char>(0b10'11'0010);  // edge, channel 3, key point
    point[16] = static_cast<char>(200);
    point[17] = 9;
    put_at(point, 18, std::int16_t(-5000));
    put_at(point, 20, std::uint16_t(12));
    put_at(point, 22, -1.5);
    put_at(point, 36, std::uint16_t(999));
    const auto cloud = points_in(las.file(), "a.las");
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("return_number")), ElementsAre(3));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("number_of_returns")), ElementsAre(15));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("key_point")), ElementsAre(1));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("scanner_channel")), ElementsAre(3));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("edge_of_flight_line")), ElementsAre(1));
    EXPECT_EQ(cloud->columns.find("synthetic"), nullptr);
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("classification")), ElementsAre(200));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("user_data")), ElementsAre(9));
    EXPECT_NEAR(cloud->columns.find("scan_angle")->number(0), -30, 1e-5);
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("point_source_id")), ElementsAre(12));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("gps_time")), ElementsAre(-1.5));
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("nir")), ElementsAre(999));
}

TEST(LasReader_EveryPointFormat, HasTimeColourAndWavesWhereItsTableSaysSo) {
    for (u32 format = 0; format <= 10; ++format) {
        Warnings warnings;
        const auto cloud = points_in(one_point(format).file(), "a.las", &warnings);
        const auto is_among = [format](std::initializer_list<u32> formats) {
            return std::ranges::find(formats, format) != formats.end();
        };
        EXPECT_EQ(cloud->columns.find("gps_time") != nullptr, !is_among({0, 2})) << format;
        EXPECT_EQ(cloud->columns.find("colour") != nullptr, is_among({2, 3, 5, 7, 8, 10})) << format;
        EXPECT_EQ(cloud->columns.find("nir") != nullptr, is_among({8, 10})) << format;
        EXPECT_EQ(warnings.sentences.size(), is_among({4, 5, 9, 10}) ? 1u : 0u) << format;
        EXPECT_EQ(world_of(*cloud, 0), Vec3(1, 2, 3)) << format;
    }
}

TEST(LasReader_Colours, OfBytesTimesAFactor_AreBytes_OthersKeepTheirBits) {
    const auto read = [](std::array<std::uint16_t, 3> colour, Warnings& warnings) {
        LasBytes las = one_point(2);
        for (std::size_t i = 0; i < 3; ++i) put_at(las.points[0], 20 + 2 * i, colour[i]);
        return points_in(las.file(), "a.las", &warnings);
    };
    Warnings plain, full, shifted, wide;
    EXPECT_THAT(numbers_of<u8>(read({0, 7, 255}, plain)->columns.find("colour")), ElementsAre(0, 7, 255));
    EXPECT_THAT(plain.sentences, IsEmpty());
    EXPECT_THAT(numbers_of<u8>(read({0, 257, 65535}, full)->columns.find("colour")), ElementsAre(0, 1, 255));
    EXPECT_THAT(full.sentences, ElementsAre(HasSubstr("times 257")));
    EXPECT_THAT(numbers_of<u8>(read({0, 256, 65280}, shifted)->columns.find("colour")), ElementsAre(0, 1, 255));
    EXPECT_THAT(shifted.sentences, ElementsAre(HasSubstr("times 256")));
    const auto cloud = read({0, 257, 256}, wide);
    EXPECT_EQ(cloud->columns.find("colour"), nullptr);
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("colour16")), ElementsAre(0, 257, 256));
    EXPECT_THAT(wide.sentences, ElementsAre(HasSubstr("colours have 16 bits")));
}

TEST(LasReader_Count, Of64Bits_CountsWhereTheOldFieldIsZero_AndTheOldWhereTheNewIs) {
    std::string bytes = one_point(6).file();
    put_at(bytes, 107, u32(0));
    EXPECT_EQ(points_in(bytes, "a.las")->size(), 1u);
    put_at(bytes, 107, u32(1));
    put_at(bytes, 247, u64(0));
    EXPECT_EQ(points_in(bytes, "a.las")->size(), 1u);
}

TEST(LasReader_DamagedBytes, AreReadOrRefused_NeverMore) {
    LasBytes las = one_point(10, 3);
    las.points.push_back(las_point(70, 4, 5, 6));
    las.add_record("LASF_Spec", 4, las_extra(3, "a", 24, 2, 1) + las_extra(1, "b"));
    las.add_record("LASF_Projection", 34735, geo_keys({{3076, 9001}}));
    const std::string bytes = las.file();
    ASSERT_NO_THROW(read_bytes(bytes, "a.las"));
    for (std::size_t size = 4; size < bytes.size(); ++size)
        EXPECT_THROW(read_bytes(bytes.substr(0, size), "a.las"), Error) << size;
    std::mt19937 random(7);
    for (int round = 0; round < 20000; ++round) {
        std::string damaged = bytes;
        for (u32 hits = 1 + random() % 3; hits > 0; --hits) {
            // Mostly where the sizes are.
            const std::size_t at = random() % 2 ? 90 + random() % 30 : random() % damaged.size();
            damaged[at] = random() % 2 ? static_cast<char>(random()) : static_cast<char>(random() % 4);
        }
        try {
            const auto cloud = points_in(damaged, "a.las");
            for (const Column& column : cloud->columns) EXPECT_EQ(column.rows(), cloud->size());
        } catch (const Error&) {
        }
    }
}

TEST(LasScale, TooLargeForADouble_GivesInfinitePositions) {
    LasBytes las;
    las.scale = {1e308, 1e308, 1e308};
    for (int i = 1; i < 4; ++i) las.points.push_back(las_point(20, 1000 * i, 1000, -1000));
    const auto cloud = points_in(las.file(), "a.las");
    EXPECT_EQ(cloud->size(), 3u);
    EXPECT_FALSE(cloud->positions[0].allFinite());
    las.points.push_back(las_point(20, 0, 0, 0));
    EXPECT_EQ(points_in(las.file(), "a.las")->positions[3], Vec3(0, 0, 0));
}

}  // namespace
}  // namespace scanmill::test
