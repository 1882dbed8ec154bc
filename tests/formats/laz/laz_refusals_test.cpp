// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged LAZ files and LAZ files of the future: one sentence each, with numbers and a hint.
#include "formats/laz/laz_support.hpp"

namespace scanmill::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

Error error_of(const std::string& bytes) {
    try {
        read_bytes(bytes, "a.laz");
    } catch (const Error& error) {
        return error;
    }
    return Error("it was read");
}

/// The sentence of the refusal, which has a hint.
std::string refused(const std::string& bytes) {
    const Error error = error_of(bytes);
    EXPECT_NE(error.hint(), "") << error.sentence();
    return error.sentence();
}

std::size_t points_begin(const std::string& bytes) { return little_endian<u32>(bytes.data() + 96); }
std::size_t table_begin(const std::string& bytes) {
    return static_cast<std::size_t>(little_endian<u64>(bytes.data() + points_begin(bytes)));
}

/// A file whose LASzip record has one number replaced.
template <class T>
std::string with_record(std::size_t at, T number, u32 format = 3) {
    return laz_file(noisy_points(format, 60), {}, [&](std::string& record) { put_at(record, at, number); });
}

TEST(LazRecord_Missing, IsReported) {
    std::string bytes = noisy_points(3, 5).file();
    bytes[104] = static_cast<char>(bytes[104] | 128);
    EXPECT_THAT(refused(bytes), ContainsRegex("none of its 0 variable length records .*'laszip encoded' 22204"));
}

TEST(LazRecord_OfTheFuture, IsReported) {
    EXPECT_THAT(refused(with_record(0, std::uint16_t(4))), ContainsRegex("method 4 of LASzip 3.*1 to 3"));
    EXPECT_THAT(refused(with_record(0, std::uint16_t(0))), ContainsRegex("method 0 of LASzip 3"));
    EXPECT_THAT(refused(with_record(2, std::uint16_t(1))), ContainsRegex("coder 1 of LASzip 3"));
    EXPECT_THAT(refused(with_record(34 + 4, std::uint16_t(5))), ContainsRegex("POINT10 .*version 5.* is 2"));
    EXPECT_THAT(refused(with_record(34 + 4, std::uint16_t(5), 7)), ContainsRegex("POINT14 .*version 5.* is 4"));
    EXPECT_THAT(refused(with_record(34, std::uint16_t(99))),
                ContainsRegex("of type 99 of 20 bytes instead of POINT10 of 20"));
}

TEST(LazRecord_AgainstTheHeader, IsReported) {
    EXPECT_THAT(refused(with_record(32, std::uint16_t(200))), ContainsRegex("52 bytes for 200 parts.* 1234"));
    EXPECT_THAT(refused(with_record(32, std::uint16_t(0))), ContainsRegex("52 bytes for 0 parts"));
    EXPECT_THAT(refused(with_record(12, u32(0))), HasSubstr("chunks of 0 points"));
    EXPECT_THAT(refused(with_record(0, std::uint16_t(3))), ContainsRegex("method 3.*point format 3 of 34"));
    EXPECT_THAT(refused(with_record(0, std::uint16_t(2), 6)), ContainsRegex("method 2.*point format 6 of 30"));
    std::string bytes = laz_file(noisy_points(3, 60));
    put_at(bytes, 105, std::uint16_t(35));
    EXPECT_THAT(refused(bytes), ContainsRegex("3 parts .*4; .*format 3 of 35 bytes"));
    bytes = laz_file(noisy_points(3, 60));
    bytes[104] = static_cast<char>(128 | 2);  // without the time, and thus with extra bytes
    EXPECT_THAT(refused(bytes), ContainsRegex("GPSTIME11 of 8 bytes instead of RGB12 of 6; .*format 2 of 34 bytes"));
    bytes[104] = static_cast<char>(128 | 11);
    EXPECT_THAT(error_of(bytes).sentence(), ContainsRegex("format 11.* 0 to 10"));
}

TEST(LazTable_Truncated, IsReported) {
    const std::string bytes = laz_file(noisy_points(3, 173));
    const std::size_t table = table_begin(bytes);
    EXPECT_THAT(refused(bytes.substr(0, table + 7)),
                ContainsRegex(fmt::format("table of chunks .*byte {}; the file has {} bytes", table, table + 7)));
    EXPECT_THAT(refused(bytes.substr(0, table + 9)), ContainsRegex("truncated or damaged after 0 of 4 entries"));
    EXPECT_THAT(refused(bytes.substr(0, table - 50)), HasSubstr("the table of chunks would begin"));
    EXPECT_THAT(refused(bytes.substr(0, points_begin(bytes) + 4)), ContainsRegex("4 bytes follow from byte .*takes 8"));
}

TEST(LazTable_NeverWritten, IsReported) {
    std::string bytes = laz_file(noisy_points(3, 60));
    put_at(bytes, points_begin(bytes), u64(points_begin(bytes)));
    EXPECT_THAT(refused(bytes), HasSubstr("the table of chunks would begin at byte"));
    put_at(bytes, points_begin(bytes), ~u64(0));
    EXPECT_THAT(refused(bytes), HasSubstr("the table of chunks would begin at byte"));
}

TEST(LazTable_Damaged, IsReported) {
    const std::string bytes = laz_file(noisy_points(3, 173));
    std::string damaged = bytes;
    put_at(damaged, table_begin(bytes), u32(7));
    EXPECT_THAT(refused(damaged), ContainsRegex("table of chunks at byte .* version 7"));
    damaged = bytes;
    put_at(damaged, table_begin(bytes) + 4, ~u32(0));
    EXPECT_THAT(refused(damaged), ContainsRegex("4294967295 entries; .* at most"));
    damaged = bytes;
    put_at(damaged, table_begin(bytes) + 8, ~u32(0));
    EXPECT_THAT(refused(damaged), ContainsRegex("truncated or damaged after 0 of 4"));
    damaged = bytes;
    put_at(damaged, table_begin(bytes) + 4, u32(0));
    EXPECT_THAT(refused(damaged), ContainsRegex("promises 173 points; its 0 chunks hold 0"));
}

TEST(LazChunks_FewerPointsThanPromised, IsReported) {
    std::string bytes = laz_file(noisy_points(3, 173));
    put_at(bytes, 247, u64(4000000000));
    EXPECT_THAT(refused(bytes), HasSubstr("promises 4000000000 points; its 4 chunks hold 200"));
    bytes = laz_file(noisy_points(3, 173));
    put_at(bytes, 247, u64(100));
    EXPECT_THAT(refused(bytes), HasSubstr("promises 100 points; they end with chunk 2 of 4"));
    bytes = laz_file(noisy_points(7, 100), {.chunks = {60, 40}});
    put_at(bytes, 247, u64(101));
    EXPECT_THAT(refused(bytes), HasSubstr("promises 101 points; its 2 chunks hold 100"));
    // The last of equally large chunks could hold more points than it does.
    bytes = laz_file(noisy_points(7, 60));
    put_at(bytes, 247, u64(70));
    EXPECT_THAT(refused(bytes), ContainsRegex("chunk 2 of 2 .*10 points instead of 20"));
}

TEST(LazHeader_WithoutPoints, IsReported) {
    std::string bytes = laz_file(noisy_points(3, 60));
    put_at(bytes, 247, u64(0));
    put_at(bytes, 107, u32(0));
    EXPECT_THAT(error_of(bytes).sentence(), ContainsRegex("holds no points: its header declares 0"));
}

TEST(LazChunk_Truncated, IsReported) {
    // One run of points ends with the file.
    const std::string run = laz_file(noisy_points(3, 100), {.method = LASZIP_COMPRESSOR_POINTWISE});
    EXPECT_THAT(refused(run.substr(0, run.size() - 200)), ContainsRegex("chunk 1 of 1 .* of its 100 points were"));
    EXPECT_THAT(refused(run.substr(0, points_begin(run) + 10)), ContainsRegex("chunk 1 of 1 .*: 0 of its 100 points"));
}

TEST(LazChunk_Damaged, IsReported) {
    std::string bytes = laz_file(noisy_points(3, 120));
    const std::size_t code = points_begin(bytes) + 8 + 34;
    put_at(bytes, code, ~u32(0));
    EXPECT_THAT(refused(bytes), ContainsRegex("chunk 1 of 3 is damaged: its code"));
    put_at(bytes, code, u32(0x12345678));
    EXPECT_THAT(refused(bytes), ContainsRegex("chunk 1 of 3 is damaged: "));
}

TEST(LazLayers_AgainstTheChunk, AreReported) {
    const std::string bytes = laz_file(noisy_points(6, 120));
    const std::size_t count = points_begin(bytes) + 8 + 30, first_layer = count + 4;
    std::string damaged = bytes;
    put_at(damaged, count, u32(3));
    EXPECT_THAT(refused(damaged), ContainsRegex("chunk 1 of 3 is damaged: it declares 3 points instead of 50"));
    damaged = bytes;
    // In 32 bits the sum of the sizes would stay the same.
    put_at(damaged, first_layer, little_endian<u32>(bytes.data() + first_layer) + 0x80000000u);
    put_at(damaged, first_layer + 4, little_endian<u32>(bytes.data() + first_layer + 4) + 0x80000000u);
    EXPECT_THAT(refused(damaged), ContainsRegex("layer 1 has [0-9]{10} bytes"));
    damaged = bytes;
    put_at(damaged, first_layer, little_endian<u32>(bytes.data() + first_layer) - 1);
    EXPECT_THAT(refused(damaged), ContainsRegex("its layers take|its code"));
    damaged = bytes;
    put_at(damaged, first_layer + 36, ~u32(0));
    EXPECT_THAT(refused(damaged), HasSubstr("chunk 1 of 3 is damaged: its code"));
}

TEST(Laz_OtherContent, IsReported) {
    EXPECT_THAT(refusal_of("hello", "a.laz"), ContainsRegex("not a LAZ file: it begins with 'hell'"));
    // The content decides, not the extension.
    EXPECT_EQ(points_in(noisy_points(3, 5).file(), "a.laz")->size(), 5u);
    EXPECT_EQ(points_in(laz_file(noisy_points(3, 5)), "a.las")->size(), 5u);
}

}  // namespace
}  // namespace scanmill::test
