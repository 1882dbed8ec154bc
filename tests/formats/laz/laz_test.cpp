// SPDX-License-Identifier: GPL-3.0-or-later
// What is compressed comes back: every point format, every method of LASzip, chunks of every size; whole and streamed.
#include "formats/laz/laz_support.hpp"

#include <numeric>

#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// The points of the compressed file are those of the plain one, bit for bit, and so are the warnings.
void expect_equal(const LasBytes& las, const Compression& how, const std::string& what) {
    Warnings plain_warnings, warnings;
    const auto plain = points_in(las.file(), "a.las", &plain_warnings);
    const auto cloud = points_in(laz_file(las, how), "a.las", &warnings);
    ASSERT_EQ(cloud->size(), plain->size()) << what;
    EXPECT_TRUE(std::ranges::equal(cloud->positions, plain->positions)) << what;
    EXPECT_EQ(cloud->frame, plain->frame) << what;
    EXPECT_EQ(cloud->columns, plain->columns) << what;
    EXPECT_EQ(warnings.sentences, plain_warnings.sentences) << what;
}

TEST(Laz_EveryPointFormat, ComesBack) {
    for (u32 format = 0; format <= 10; ++format)
        for (const std::size_t count : {1u, 2u, 50u, 51u, 173u})
            for (const std::size_t extra : {0u, 3u})
                expect_equal(noisy_points(format, count, extra), {},
                             fmt::format("format {}, {} points, {} extra bytes", format, count, extra));
}

TEST(Laz_EveryMethod, ComesBack) {
    for (const u32 format : {0u, 1u, 2u, 3u, 4u, 5u})
        for (const u32 method : {LASZIP_COMPRESSOR_POINTWISE, LASZIP_COMPRESSOR_POINTWISE_CHUNKED})
            for (const u32 version : {1u, 2u})
                expect_equal(noisy_points(format, 120, 2), {.method = method, .version = version},
                             fmt::format("format {}, method {}, version {}", format, method, version));
    for (const u32 format : {6u, 7u, 8u, 9u, 10u})
        for (const u32 version : {3u, 4u})
            expect_equal(noisy_points(format, 120, 2), {.version = version},
                         fmt::format("format {}, version {}", format, version));
}

TEST(Laz_ChunksOfDifferentSizes, ComeBack) {
    for (const u32 format : {3u, 7u})
        expect_equal(noisy_points(format, 200), {.chunks = {1, 120, 30, 49}}, fmt::format("format {}", format));
}

TEST(Laz_ThreePoints, HaveTheirNumbers) {
    LasBytes las;
    las.point_format = 1;
    las.scale = {0.5, 0.5, 0.25};
    for (int i = 0; i < 3; ++i) {
        std::string point = las_point(28, 10 * i, -i, 4 * i);
        put_at(point, 12, static_cast<std::uint16_t>(1000 + i));
        put_at(point, 20, 7.5 + i);
        las.points.push_back(point);
    }
    const LoadedFile loaded = read_bytes(laz_file(las), "a.laz");
    const auto cloud = loaded.value.get<PointCloud>();
    EXPECT_EQ(loaded.format, "LAZ");
    EXPECT_THAT(loaded.encoding, testing::HasSubstr("LASzip 3."));
    ASSERT_EQ(cloud->size(), 3u);
    EXPECT_EQ(world_of(*cloud, 2), Vec3(10, -1, 2));
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("intensity")), ElementsAre(1000, 1001, 1002));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("gps_time")), ElementsAre(7.5, 8.5, 9.5));
}

TEST(Laz_AddressOfTheTableAtTheEnd, IsFound) {
    const LasBytes las = noisy_points(3, 120);
    std::string bytes = laz_file(las);
    const std::size_t begin = little_endian<u32>(bytes.data() + 96);
    const u64 address = little_endian<u64>(bytes.data() + begin);
    put_at(bytes, begin, ~u64(0));
    bytes += bytes_of(address);
    EXPECT_EQ(points_in(bytes, "a.laz")->columns, points_in(las.file(), "a.las")->columns);
}

TEST(Laz_MorePointsInTheLastChunkThanTheHeaderDeclares, AreIgnored) {
    const LasBytes las = noisy_points(6, 120);
    std::string bytes = laz_file(las);
    put_at(bytes, 247, u64(110));
    put_at(bytes, 107, u32(110));
    const auto cloud = points_in(bytes, "a.laz"), all = points_in(las.file(), "a.las");
    ASSERT_EQ(cloud->size(), 110u);
    EXPECT_EQ(world_of(*cloud, 109), world_of(*all, 109));
}

void expect_streamed(const std::string& bytes, const char* name, std::vector<unsigned> threads = {1, 2, 3}) {
    const TemporaryFolder folder;
    const fs::path path = folder.write(name, bytes);
    Warnings whole_warnings;
    const auto whole = read_points(path, whole_warnings.reading());
    EXPECT_TRUE(may_be_point_stream(path));
    for (const unsigned count : threads) {
        Warnings warnings;
        std::size_t seen = 0;
        const auto stream = open_point_stream(path, warnings.reading(), count,
                                              [&](std::span<const Vec3> positions) { seen += positions.size(); });
        ASSERT_NE(stream, nullptr);
        EXPECT_EQ(warnings.sentences, whole_warnings.sentences);
        EXPECT_EQ(seen, whole->size());
        EXPECT_EQ(stream->frame(), whole->frame);
        std::vector<u32> rows(stream->size());
        std::iota(rows.begin(), rows.end(), 0u);
        const PointCloud gathered = stream->gather(rows, count);
        EXPECT_TRUE(std::ranges::equal(gathered.positions, whole->positions));
        EXPECT_EQ(gathered.columns, whole->columns);
        const BoundingBox box = bounding_box(whole->positions.span());
        EXPECT_EQ(stream->bounds().low, box.low);
        EXPECT_EQ(stream->bounds().high, box.high);
        Array<Vec3> piece;
        stream->read(stream->pieces().size() - 2, piece);
        EXPECT_EQ(piece.back(), whole->positions[whole->size() - 1]);
    }
}

TEST(Laz_Streamed, EqualsTheWhole) {
    // More than a piece of a stream.
    expect_streamed(laz_file(noisy_points(7, 70000, 1), {.chunk_size = 5000}), "a.laz");
    expect_streamed(laz_file(noisy_points(3, 500), {.method = LASZIP_COMPRESSOR_POINTWISE}), "a.laz");
    expect_streamed(laz_file(noisy_points(3, 500), {.chunks = {100, 300, 100}}), "a.laz");
}

TEST(Las_Streamed, EqualsTheWhole) {
    expect_streamed(noisy_points(2, 70000).file(), "a.las");
    LasBytes tiny = noisy_points(0, 10);
    tiny.scale = {1e-12, 1e-12, 1e-12};  // finer than a double of the full coordinate
    expect_streamed(tiny.file(), "a.las");
    tiny.scale = {-1e-3, 1e-3, 1e-3};
    expect_streamed(tiny.file(), "a.las");
}

TEST(Laz_RealScan, HasTheExtremesOfAnotherReader) {
    SCANMILL_REAL_SCAN(path, shared_data, "5-raw/lone-star.laz");
    const auto cloud = read_points(path);
    ASSERT_EQ(cloud->size(), 518862u);
    BoundingBox box;
    for (std::size_t row = 0; row < cloud->size(); ++row) box.add(world_of(*cloud, row));
    EXPECT_LT((box.low - Vec3(515368.60225, 4918340.364, 2322.89625)).norm(), 2e-9);
    EXPECT_LT((box.high - Vec3(515401.043, 4918381.12375, 2338.5755)).norm(), 2e-9);
    double intensity = 0;
    for (std::size_t row = 0; row < cloud->size(); ++row) intensity += cloud->columns.find("intensity")->number(row);
    EXPECT_EQ(intensity, 562919835);
}

}  // namespace
}  // namespace scanmill::test
