// SPDX-License-Identifier: GPL-3.0-or-later
// A file that changes while its stream is open: content that does not fit the first reading throws, and is never
// returned.
#include <limits>

#include "core/formats/support.hpp"
#include "scanmill/formats/files.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

/// Opens `before`, writes `after` into the same file, and reads everything.
void expect_reported(const char* name, const std::string& before, const std::string& after) {
    ASSERT_EQ(before.size(), after.size()) << "a truncated file would end the program";
    const TemporaryFolder folder;
    const fs::path path = folder.write(name, before);
    const auto stream = open_point_stream(path, {}, 1);
    ASSERT_TRUE(stream);
    std::vector<u32> all(stream->size());
    for (u32 row = 0; row < all.size(); ++row) all[row] = row;
    Array<Vec3> room;
    stream->read(0, room);
    EXPECT_EQ(room.size(), all.size());
    EXPECT_EQ(stream->gather(all, 1).size(), all.size());
    folder.write(name, after);
    EXPECT_THAT(sentence_of([&] { stream->read(0, room); }), HasSubstr("changed while it was read")) << after;
    EXPECT_EQ(error_of([&] { stream->read(0, room); }).hint(), "run it again");
}

TEST(PointStreamOfAFileThatChanges, TextOfOtherRows_IsReported) {
    const std::string before = "1 2 3\n4 5 6\n7 8 9.00000\n";
    expect_reported("fewer.xyz", before, "1 2 3\n4 5 6\n           \n");
    expect_reported("more.xyz", before, "1 2 3\n4 5 6\n7 8 9\n1 2 3\n");
    expect_reported("short_row.xyz", before, "1 2 3\n4   6\n7 8 9.00000\n");
    expect_reported("word.xyz", before, "1 2 3\n4 x 6\n7 8 9.00000\n");
    expect_reported("nan.xyz", before, "1 2 3\n4 5 6\n7 8     nan\n");
}

TEST(PointStreamOfAFileThatChanges, CoordinatesOutsideTheBounds_AreReported) {
    expect_reported("outside.xyz", "1 2 3\n4 5 6\n", "1 2 3\n4 5 7\n");
    const auto ply = [](float number) {
        std::string file =
            "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
            "property float z\nend_header\n";
        for (const float each : {1.f, 2.f, 3.f, 4.f, 5.f, number}) file += bytes_of(each);
        return file;
    };
    expect_reported("outside.ply", ply(6), ply(2));
    expect_reported("nan.ply", ply(6), ply(std::numeric_limits<float>::quiet_NaN()));
}

TEST(PointStreamOfAFileThatChanges, GatheringWhatIsThereNoMore_IsReported) {
    const TemporaryFolder folder;
    const fs::path path = folder.write("a.xyz", "1 2 3\n4 5 6\n7 8 9\n");
    const auto stream = open_point_stream(path, {}, 1);
    ASSERT_TRUE(stream);
    for (const char* after : {"1 2 3\n4 5 6\n     \n", "1 2 3\n4 5 6\n7 8  \n", "1 2 3\n4 5 6\n7 8 0\n"}) {
        folder.write("a.xyz", after);
        const std::vector<u32> last{2};
        EXPECT_THAT(sentence_of([&] { stream->gather(last, 1); }), HasSubstr("changed while it was read")) << after;
    }
}

}  // namespace
}  // namespace scanmill::test
