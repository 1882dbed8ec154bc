// SPDX-License-Identifier: GPL-3.0-or-later
// Files that hold several views, and the names of views.
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A PTX scan of one point, moved by z along the z axis.
std::string ptx_scan(double x, double z) {
    return fmt::format("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 {} 1\n{} 0 0 0.5\n", z, x);
}

std::string refusal_of_file(const fs::path& file) {
    try {
        read_file(file);
    } catch (const Error& error) {
        return error.sentence();
    }
    return "it was read";
}

TEST(Views, Name_IsThatOfAView_IfTheFileIsThere) {
    const TemporaryFolder folder;
    folder.write("a.ptx", ptx_scan(1, 2));
    const fs::path file = folder / "a.ptx";
    const auto parts = [](const fs::path& name) {
        const FileView view = file_view(name);
        return std::pair(view.file, view.view);
    };
    EXPECT_EQ(parts(file), std::pair(file, 0u));
    EXPECT_EQ(parts(view_name(file, 12)), std::pair(file, 12u));
    for (const char* name : {"b.ptx#1", "a.ptx#", "a.ptx#0", "a.ptx#01", "a.ptx#x", "a.ptx#-1", "a.ptx#99999999999"})
        EXPECT_EQ(parts(folder / name), std::pair(folder / name, 0u)) << name;
    folder.write("a.ptx#3", "a file of this name");
    EXPECT_EQ(parts(folder / "a.ptx#3"), std::pair(folder / "a.ptx#3", 0u));
}

TEST(Views, StemAndExtension_AreThoseOfOutputNames) {
    EXPECT_EQ(stem_of("in/room.e57#2"), "room-2");
    EXPECT_EQ(stem_of("in/room.ptx.gz#10"), "room-10");
    EXPECT_EQ(extension_of("in/room.e57#2"), "e57");
    EXPECT_EQ(extension_of("in/room.ptx.gz#10"), "ptx");
    EXPECT_EQ(stem_of("in/a#b.ply"), "a#b");
}

TEST(Views, OfAPtxFile_AreCountedAndReadAlone) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("a.ptx", ptx_scan(1, 10) + ptx_scan(2, 20) + ptx_scan(3, 30));
    EXPECT_EQ(count_views(file), 3u);
    EXPECT_EQ(read_points(file)->size(), 3u);
    const auto second = read_points(view_name(file, 2));
    ASSERT_EQ(second->size(), 1u);
    EXPECT_EQ(world_of(*second, 0), Vec3(2, 0, 20));
    EXPECT_EQ(second->columns.find("scan"), nullptr);
    EXPECT_THAT(refusal_of_file(view_name(file, 4)), HasSubstr("a.ptx#4': has no scan 4; it has 3 scans"));
    EXPECT_EQ(memory_to_read(view_name(file, 2)), memory_to_read(file));
}

TEST(Views, OfOtherFiles_AreOne) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("a.xyz", right_triangle);
    EXPECT_EQ(count_views(file), 1u);
    EXPECT_EQ(count_views(folder / "missing.xyz"), 1u);
    EXPECT_EQ(count_views(folder.write("broken.ptx", "1\n")), 1u);
    EXPECT_EQ(read_points(view_name(file, 1))->size(), 3u);
    EXPECT_THAT(refusal_of_file(view_name(file, 2)), HasSubstr("has no view 2"));
    // A stream would be that of the whole file.
    EXPECT_TRUE(may_be_point_stream(view_name(file, 1)));
    EXPECT_TRUE(open_point_stream(view_name(file, 1), {}, 1));
    EXPECT_FALSE(may_be_point_stream(view_name(file, 2)));
    EXPECT_FALSE(open_point_stream(view_name(file, 2), {}, 1));
}

}  // namespace
}  // namespace scanmill::test
