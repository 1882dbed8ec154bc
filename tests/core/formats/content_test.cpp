// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are compressed with gzip, and text in UTF-16.
#include "scanmill/formats/detail/content.hpp"
#include "core/formats/support.hpp"
#include "support/gzip.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string rows = "1 2 3\n4 5 6\n";
const std::string ply =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n7 8 "
    "9\n";

/// ASCII as UTF-16.
std::string utf16(std::string_view text, bool is_big, bool has_mark) {
    std::string bytes;
    const auto put = [&](unsigned unit) {
        const char high = static_cast<char>(unit >> 8), low = static_cast<char>(unit & 0xff);
        bytes += is_big ? high : low;
        bytes += is_big ? low : high;
    };
    if (has_mark) put(0xfeff);
    for (const char c : text) put(static_cast<unsigned char>(c));
    return bytes;
}

TEST(GzipContent, IsReadUnderItsOwnNameAndUnderAPlainOne) {
    for (const char* name : {"a.xyz.gz", "a.xyz", "a.XYZ.GZ"}) {
        const LoadedFile loaded = read_bytes(gzipped(rows), name);
        EXPECT_EQ(loaded.format, "XYZ") << name;
        EXPECT_EQ(loaded.encoding, "ascii, gzip");
        EXPECT_THAT(rows_of(loaded.value.get<PointCloud>()->positions), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    }
    EXPECT_EQ(world_of(*points_in(gzipped(ply), "a.ply.gz"), 0), Vec3(7, 8, 9));
    EXPECT_EQ(world_of(*points_in(gzipped(ply), "a.ply"), 0), Vec3(7, 8, 9));
}

TEST(GzipContent, TheExtensionBeforeGz_DecidesWhereTheContentDoesNot) {
    const std::string row = "1 2 3 255 255 255\n";
    EXPECT_TRUE(points_in(gzipped(row), "a.pts.gz")->columns.find("colour"));
    EXPECT_FALSE(points_in(gzipped(row), "a.xyz.gz")->columns.find("colour"));
    EXPECT_EQ(extension_of("scans/a.Pts.gz"), "pts");
    EXPECT_EQ(stem_of("scans/a.b.pts.gz"), "a.b");
    EXPECT_EQ(stem_of("scans/a.b.pts"), "a.b");
}

TEST(GzipContent, OfSeveralMembers_IsReadToTheEnd_AndPaddingIsIgnored) {
    EXPECT_EQ(points_in(gzipped("1 2 3\n") + gzipped("4 5 6\n") + std::string(512, '\0'), "a.xyz.gz")->size(), 2u);
}

TEST(GzipContent, BytesAfterIt_AreReported) {
    Warnings warnings;
    EXPECT_EQ(points_in(gzipped(rows) + std::string(512, '\0'), "a.xyz.gz", &warnings)->size(), 2u);
    EXPECT_THAT(warnings.sentences, testing::IsEmpty());
    EXPECT_EQ(points_in(gzipped(rows) + "1 2 3\n", "a.xyz.gz", &warnings)->size(), 2u);
    EXPECT_THAT(warnings.sentences, ElementsAre("'a.xyz.gz': 6 bytes after the end of the gzip data were ignored; they "
                                                "are not gzip data"));
    warnings.sentences.clear();
    points_in(gzipped(rows) + std::string(3, '\0') + "x", "a.xyz.gz", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("4 bytes after")));
}

TEST(GzipContent, OfManyTimesItsSize_IsWhole) {
    std::string many;
    for (int i = 0; i < 100000; ++i) many += "0 0 1\n";
    EXPECT_EQ(points_in(gzipped(many), "a.xyz.gz")->size(), 100000u);
}

TEST(GzipContent_Refuses, AnEmptyFile_AndEmptyContent) {
    EXPECT_THAT(refusal_of("", "a.ply.gz"), ContainsRegex("'a.ply.gz'.* empty .*0 bytes"));
    EXPECT_THAT(refusal_of(gzipped(""), "a.ply.gz"), ContainsRegex("'a.ply.gz'.* gzip .* 0 bytes"));
}

TEST(GzipContent_Refuses, TruncatedData_AtEveryByte) {
    const std::string whole = gzipped(rows);
    for (std::size_t size = 2; size < whole.size(); ++size)
        EXPECT_THAT(refusal_of(whole.substr(0, size), "a.xyz.gz"), HasSubstr("its gzip data end after")) << size;
}

TEST(GzipContent_Refuses, DamagedData) {
    std::string damaged = gzipped(rows);
    damaged[damaged.size() - 6] ^= 1;  // in the check sum
    EXPECT_THAT(refusal_of(damaged, "a.xyz.gz"), ContainsRegex("gzip .*damaged.* 12 bytes"));
    EXPECT_THAT(refusal_of(gzipped(gzipped(rows)), "a.xyz.gz"), HasSubstr("compressed twice"));
}

TEST(GzipContent_Refuses, MoreContentThanTheLimit) {
    const std::string bomb = gzipped(std::string(1000000, '\0'));
    EXPECT_EQ(decompressed(bomb, 1000000).size(), 1000000u);
    EXPECT_THAT(sentence_of([&] { decompressed(bomb, 999999); }), HasSubstr("contain more than 977 KiB"));
}

TEST(GzipContent, IsNotStreamed) {
    const TemporaryFolder folder;
    put_file(folder / "a.xyz", gzipped(rows));
    EXPECT_FALSE(may_be_point_stream(folder / "a.xyz"));
    EXPECT_EQ(open_point_stream(folder / "a.xyz", {}, 1), nullptr);
}

TEST(Utf16Text, IsReadInBothByteOrders) {
    for (const bool is_big : {false, true}) {
        const LoadedFile loaded = read_bytes(utf16("X;Y;Z\r\n1;2;3\r\n", is_big, true), "a.csv");
        EXPECT_EQ(loaded.encoding, "ascii, UTF-16");
        EXPECT_EQ(world_of(*loaded.value.get<PointCloud>(), 0), Vec3(1, 2, 3));
    }
    EXPECT_EQ(points_in(utf16(ply, false, true), "a.ply")->size(), 1u);
    EXPECT_EQ(points_in(gzipped(utf16(rows, false, true)), "a.xyz.gz")->size(), 2u);
}

TEST(Utf16Text, OtherCharactersBecomeUtf8) {
    // "# frame µ€𝄞" and one half of a pair.
    const std::string comment =
        utf16("# frame ", false, true) + std::string("\xb5\x00\xac\x20\x34\xd8\x1e\xdd\x34\xd8", 10);
    EXPECT_EQ(points_in(comment + utf16("\n" + rows, false, false), "a.xyz")->frame.name,
              "\xc2\xb5\xe2\x82\xac\xf0\x9d\x84\x9e?");
}

TEST(Utf16Text_Refuses, AnOddNumberOfBytes) {
    EXPECT_THAT(refusal_of(utf16(rows, false, true) + "\n", "a.xyz"), ContainsRegex("'a.xyz'.* UTF-16 .* odd .* 27"));
}

TEST(Utf16Text, BinaryData_AreNotTakenForIt) {
    EXPECT_EQ(wrapping_of(std::string("\x01\x00\x02\x00\x03\x00", 6)), Wrapping::none);
    EXPECT_EQ(wrapping_of(std::string(64, '\0')), Wrapping::none);
    EXPECT_EQ(wrapping_of(std::string("\xff\xfe\x00\x00\x31\x00\x00\x00", 8)), Wrapping::none) << "UTF-32";
    EXPECT_EQ(wrapping_of("1 2 3\n"), Wrapping::none);
}

TEST(ByteOrderMark, OfUtf8_IsPassedOverInEveryText) {
    EXPECT_EQ(points_in("\xef\xbb\xbf" + ply, "a.ply")->size(), 1u);
    EXPECT_EQ(mesh_in("\xef\xbb\xbf"
                      "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                      "a.off")
                  ->triangles.size(),
              1u);
}

TEST(MemoryToRead, GrowsWithTheFile_AndRefusesWithBothNumbers) {
    const TemporaryFolder folder;
    put_file(folder / "a.xyz", rows);
    const u64 need = memory_to_read(folder / "a.xyz");
    EXPECT_GE(need, rows.size());
    require_memory_to_read(folder / "a.xyz", need);
    EXPECT_THAT(sentence_of([&] { require_memory_to_read(folder / "a.xyz", need - 1); }),
                AllOf(HasSubstr("it has 12 B"), HasSubstr("60 B of memory"), HasSubstr("59 B are available")));
    EXPECT_EQ(memory_to_read(folder / "none.xyz"), 0u);
}

}  // namespace
}  // namespace scanmill::test
