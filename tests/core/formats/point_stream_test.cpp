// SPDX-License-Identifier: GPL-3.0-or-later
// A file read piece by piece is the file read whole, bit for bit; or it is not read so.

#include "scanmill/formats/files.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "core/formats/support.hpp"
#include "support/same_points.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Seeded numbers around `middle`.
class Numbers {
public:
    explicit Numbers(double middle) : middle_(middle) {}
    double next() { return middle_ + static_cast<double>(source_() % 100000) / 1024; }

private:
    std::mt19937 source_{7};
    double middle_;
};

/// A PLY of `count` vertices, x and y and z of type T between two other properties.
template <class T>
std::string ply_of(std::size_t count, std::string_view type, double middle = 0, bool big_endian = false,
                   std::string_view after = "") {
    std::string file = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
                       "_endian 1.0\ncomment unit mm\ncomment frame part\nelement vertex " + std::to_string(count) +
                       "\nproperty uchar flag\nproperty " + std::string(type) + " x\nproperty " + std::string(type) +
                       " y\nproperty " + std::string(type) +
                       " z\nproperty float nx\nproperty float ny\nproperty float nz\n" + std::string(after) +
                       "end_header\n";
    Numbers numbers(middle);
    for (std::size_t i = 0; i < count; ++i) {
        file += bytes_of(static_cast<unsigned char>(i), big_endian);
        for (int axis = 0; axis < 3; ++axis) file += bytes_of(static_cast<T>(numbers.next()), big_endian);
        for (int axis = 0; axis < 3; ++axis) file += bytes_of(static_cast<float>(numbers.next()), big_endian);
    }
    return file;
}

std::string text(std::size_t count, double middle = 0) {
    std::string file;
    Numbers numbers(middle);
    for (std::size_t i = 0; i < count; ++i) {
        if (i % 997 == 0) file += "\n# a remark, now and then\n";
        for (int axis = 0; axis < 3; ++axis) file += fmt::format("{}{}", numbers.next(), axis < 2 ? " " : "");
        file += i % 2 ? "\r\n" : "\n";
    }
    return file;
}

/// The column, piece by piece, is the one that was gathered.
bool same_columns(const PointStream& stream, const Column& gathered) {
    std::string bytes;
    for (std::size_t piece = 0; piece + 1 < stream.pieces().size(); ++piece) {
        const ColumnTable columns = stream.read_columns(piece);
        const Column& part = *columns.find(gathered.name());
        EXPECT_EQ(part.name(), gathered.name());
        EXPECT_EQ(part.type(), gathered.type());
        EXPECT_EQ(part.components(), gathered.components());
        bytes.append(reinterpret_cast<const char*>(part.bytes().data()), part.bytes().size());
    }
    const std::string_view whole(reinterpret_cast<const char*>(gathered.bytes().data()), gathered.bytes().size());
    return bytes == whole;
}

/// All points, piece by piece.
PointCloud streamed(const PointStream& stream, const std::vector<u32>& rows, unsigned threads) {
    Array<Vec3> all, room;
    for (std::size_t piece = 0; piece + 1 < stream.pieces().size(); ++piece) {
        EXPECT_EQ(all.size(), stream.pieces()[piece]);
        stream.read(piece, room);
        all.insert(all.end(), room.begin(), room.end());
    }
    EXPECT_EQ(all.size(), stream.size());
    PointCloud gathered = stream.gather(rows, threads);
    if (rows.size() == stream.size()) {
        for (const Column& column : gathered.columns) EXPECT_TRUE(same_columns(stream, column));
    }
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(gathered.positions[i], all[rows[i]]);
    return gathered;
}

void expect_as_read_whole(const fs::path& path) {
    Warnings whole_told, warnings;
    const auto whole = read_points(path, whole_told.reading());
    EXPECT_TRUE(may_be_point_stream(path));
    std::vector<u32> all(whole->size()), some;
    for (u32 row = 0; row < all.size(); ++row) all[row] = row;
    std::mt19937 source(1);
    std::ranges::copy_if(all, std::back_inserter(some), [&](u32) { return source() % 7 == 0; });
    for (const unsigned threads : {1u, 4u}) {
        warnings.sentences.clear();
        Array<Vec3> world;
        const auto stream = open_point_stream(path, warnings.reading(), threads, [&](std::span<const Vec3> positions) {
            world.insert(world.end(), positions.begin(), positions.end());
        });
        ASSERT_TRUE(stream);
        ASSERT_EQ(world.size(), whole->size());
        for (std::size_t i = 0; i < world.size(); ++i)
            ASSERT_EQ(world[i] - stream->frame().origin, whole->positions[i]) << "positions passed to on_positions";
        EXPECT_EQ(warnings.sentences, whole_told.sentences);
        EXPECT_EQ(stream->frame(), whole->frame);
        EXPECT_EQ(stream->size(), whole->size());
        EXPECT_EQ(stream->bounds().low, bounding_box(whole->positions.span()).low);
        EXPECT_EQ(stream->bounds().high, bounding_box(whole->positions.span()).high);
        const RobustBox robust = robust_box(whole->positions.span());
        EXPECT_EQ(stream->robust_box().all.low, robust.all.low);
        EXPECT_EQ(stream->robust_box().all.high, robust.all.high);
        EXPECT_EQ(stream->robust_box().robust.low, robust.robust.low);
        EXPECT_EQ(stream->robust_box().robust.high, robust.robust.high);
        EXPECT_EQ(stream->robust_box().stray, robust.stray);
        EXPECT_TRUE(same_points(streamed(*stream, all, threads), *whole));
        EXPECT_TRUE(same_points(streamed(*stream, some, threads), gather(*whole, some)));
    }
}

TEST(PointStream, StrayPoints_AreThoseOfTheFileReadWhole) {
    const TemporaryFolder folder;
    for (const double middle : {0.0, 4'500'000.0})
        for (const Vec3& stray : {Vec3(0, 0, 0), Vec3(-7e6, 0.1, 3)}) {
            std::string content;
            Numbers numbers(middle);
            constexpr int rows = 70'000;
            for (int row = 0; row < rows; ++row) {
                const bool is_stray = row == 3 || row == 69'000;
                const Vec3 p = is_stray ? Vec3(stray + Vec3(row == 3 ? 0 : 1000, 0, 0))
                                        : Vec3(numbers.next(), numbers.next(), numbers.next());
                for (int axis = 0; axis < 3; ++axis) content += bytes_of(p[axis], false);
            }
            const fs::path path = folder.write(
                "a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(rows) +
                             "\nproperty double x\nproperty double y\nproperty double z\nend_header\n" + content);
            expect_as_read_whole(path);
            const auto whole = read_points(path);
            EXPECT_EQ(robust_box(whole->positions.span()).stray.size(), middle == 0 && stray.norm() < 1 ? 1u : 2u);
            std::string lines;
            for (const Vec3& p : whole->positions) {
                const Vec3 world = p + whole->frame.origin;
                lines += fmt::format("{} {} {}\n", world.x(), world.y(), world.z());
            }
            expect_as_read_whole(folder.write("a.xyz", lines));
        }
}

/// `begins_so`: only later content prevents streaming.
void expect_not_read_so(std::string_view content, const char* name, bool begins_so = false) {
    const TemporaryFolder folder;
    const fs::path path = folder.write(name, content);
    EXPECT_FALSE(open_point_stream(path, {}, 2)) << name;
    EXPECT_EQ(may_be_point_stream(path), begins_so) << name;
}

TEST(PointStream, OfFloats_IsTheFileReadWhole) {
    const TemporaryFolder folder;
    expect_as_read_whole(folder.write("a.ply", ply_of<float>(200'000, "float")));
    expect_as_read_whole(folder.write("one.ply", ply_of<float>(1, "float")));
    expect_as_read_whole(folder.write("exact.ply", ply_of<float>(1 << 16, "float")));
}

TEST(PointStream, OfCoordinatesFarFromZero_ChoosesTheSameOrigin) {
    const TemporaryFolder folder;
    expect_as_read_whole(folder.write("a.ply", ply_of<double>(70'000, "double", 5e6)));
    expect_as_read_whole(folder.write("a.xyz", text(70'000, 5e6)));
}

TEST(PointStream, OfBigEndianAndOfWholeNumbers_IsTheFileReadWhole) {
    const TemporaryFolder folder;
    expect_as_read_whole(folder.write("a.ply", ply_of<double>(70'000, "double", -3, true)));
    expect_as_read_whole(folder.write("b.ply", ply_of<std::int16_t>(70'000, "short", 100)));
}

TEST(PointStream, OfAFileThatEndsWithALinesEnd_IsTheFileReadWhole) {
    const TemporaryFolder folder;
    for (const char* end :
         {"\n", "\r\n", "\n\n\r\n\r", "\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n"})
        expect_as_read_whole(folder.write("a.ply", ply_of<float>(70'000, "float") + end));
    expect_not_read_so(ply_of<float>(3, "float") + "\n.", "behind.ply");
}

TEST(PointStream, OfText_IsTheFileReadWhole) {
    const TemporaryFolder folder;
    expect_as_read_whole(folder.write("a.xyz", text(200'000)));
    expect_as_read_whole(folder.write("a.csv", "# unit cm\nz,x,y\n1,2,3\n4,5,6\n# frame rig\n7,8,9"));
    expect_as_read_whole(folder.write("a.txt", "\xef\xbb\xbf  1 2 3\n"));
}

TEST(PointStream, OfManyComments_DeclaresWhatTheFileReadWholeDoes) {
    const TemporaryFolder folder;
    std::string between = "# unit m\n";
    for (int row = 0; row < 40'000; ++row) between += "1 2 " + std::to_string(row) + (row % 8 ? "\n" : " # remark\n");
    for (const char* last :
         {"", "# unit mm\n# frame part\n", "# unit parsec\n", "# unit m\n# unit mm\n1 2 3 # unit in\n"})
        expect_as_read_whole(folder.write("a.xyz", between + last + between.substr(9)));
}

TEST(PointStream, TellsWhatReadingTells) {
    const TemporaryFolder folder;
    const auto path = folder.write("a.xyz", "# unit furlong\n1 2 3\n");
    Warnings warnings;
    ASSERT_TRUE(open_point_stream(path, warnings.reading(), 1));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("furlong")));
    expect_as_read_whole(path);
}

TEST(PointStream, Renamed_GivesPointsInTheFrameOfThatName) {
    const TemporaryFolder folder;
    const auto stream = open_point_stream(folder.write("a.ply", ply_of<float>(3, "float")), {}, 1);
    ASSERT_TRUE(stream);
    EXPECT_EQ(stream->frame().name, "part");
    stream->rename_frame("other");
    const std::vector<u32> last{2};
    EXPECT_EQ(stream->gather(last, 1).frame, (Frame{LengthUnit::millimetre, Vec3::Zero(), "other"}));
}

TEST(PointStream, IsNotHadOfFilesThatHoldMore) {
    expect_not_read_so(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n1 2 3\n",
        "ascii.ply");
    const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
    expect_not_read_so(ply_of<float>(3, "float", 0, false, face) + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13),
                       "mesh.ply");
    expect_not_read_so(ply_of<float>(3, "float", 0, false, "property list uchar int more\n"), "list.ply");
    expect_not_read_so(ply_of<float>(3, "float", 0, false, "element thing 2\n"), "things_without_bytes.ply");
    expect_not_read_so(ply_of<float>(3, "float") + "more", "trailing.ply");
    const std::string whole = ply_of<float>(3, "float");
    expect_not_read_so(whole.substr(0, whole.size() - 1), "truncated.ply");
    expect_not_read_so("1 2 3 4\n5 6 7 8\n", "intensity.xyz");
    expect_not_read_so("2\n1 2 3\n4 5 6\n", "count.xyz");
    expect_not_read_so("p 1 2 3\n", "tagged.txt");
    expect_not_read_so("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "mesh.off");
}

TEST(PointStream, IsNotHadOfFilesThatAreWrong_SoThatReadingThemSaysWhy) {
    expect_not_read_so("1 2 3\n4 5\n", "short.xyz", true);
    expect_not_read_so("1 2 3\n4 5 6 7\n", "long.xyz", true);
    expect_not_read_so("1 2 3\n4 5 six\n", "word.xyz", true);
    expect_not_read_so("1 2 3\n4,5 6\n", "mixed.xyz", true);
    expect_not_read_so(",1,2,3\n4,5,6\n", "empty_field.csv", true);
    expect_not_read_so("1 2 3\n4 5 nan\n", "nan.xyz", true);
    std::string nan = ply_of<float>(3, "float");
    nan.replace(nan.size() - 24, 4, bytes_of(std::numeric_limits<float>::quiet_NaN()));
    expect_not_read_so(nan, "nan.ply", true);
    EXPECT_FALSE(open_point_stream("/nowhere/at/all.ply", {}, 1));
    EXPECT_FALSE(may_be_point_stream("/nowhere/at/all.ply"));
}

TEST(PointStream, WholeBodyOfFarRowsInText_KeepsMistakesBehindTheFirstPiece) {
    expect_not_read_so(text(150'000) + "1 2\n", "late.xyz", true);
}

}  // namespace
}  // namespace scanmill::test
