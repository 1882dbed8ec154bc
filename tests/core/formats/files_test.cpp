// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <limits>

#include "core/formats/support.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class Action>
std::string report_of(Action&& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

Value one_point() { return std::make_shared<const PointCloud>(PointCloud{{}, {Vec3(1, 2, 3)}, {}}); }

Value one_triangle() {
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    mesh.triangles = {Triangle{0, 1, 2}};
    return std::make_shared<const TriangleMesh>(mesh);
}

TEST(ReadFile_Refuses, WhatIsNoReadableFile) {
    const TemporaryFolder folder;
    EXPECT_THAT(report_of([&] { read_file(folder / "none.ply"); }), HasSubstr("none.ply': there is no such file"));
    put_file(folder / "file", "x");
    EXPECT_THAT(report_of([&] { read_file(folder / "file/none.ply"); }), HasSubstr("there is no such file"));
    EXPECT_THAT(report_of([&] { read_file(folder.path()); }), HasSubstr("is a folder"));
    put_file(folder / "empty.ply", "");
    EXPECT_THAT(report_of([&] { read_file(folder / "empty.ply"); }), HasSubstr("is empty"));
    ASSERT_EQ(::mkfifo((folder / "pipe.ply").c_str(), 0600), 0);
    EXPECT_THAT(report_of([&] { read_file(folder / "pipe.ply"); }), HasSubstr("is not a regular file"));
}

TEST(ReadFile_Refuses, WhatWeMayNotRead) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
    const TemporaryFolder folder;
    put_file(folder / "secret.ply", "ply\n");
    fs::permissions(folder / "secret.ply", fs::perms::none);
    EXPECT_THAT(report_of([&] { read_file(folder / "secret.ply"); }), HasSubstr("no permission"));
}

TEST(ReadFile_Format, IsDecidedByContent_NotByExtension) {
    const TemporaryFolder folder;
    for (const char* extension : {"ply", "stl", "off", "obj"}) {
        write_file(folder / (std::string("a.") + extension), one_triangle());
        fs::rename(folder / (std::string("a.") + extension), folder / "misnamed.xyz");
        EXPECT_EQ(plain_extension(read_file(folder / "misnamed.xyz").format), extension);
    }
}

TEST(ReadPoints_OfAMesh, GivesItsVertices_AndTellsTheFacesLeftOut) {
    const TemporaryFolder folder;
    Warnings warnings;
    write_file(folder / "a.ply", one_triangle());
    EXPECT_THAT(rows_of(read_points(folder / "a.ply", warnings.reading())->positions),
                ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)));
    EXPECT_THAT(warnings.sentences,
                ElementsAre(testing::AllOf(HasSubstr("a.ply"), HasSubstr("1 triangle was left out"))));
}

TEST(ReadMesh_OfPoints, IsRefusedWithAWayOut) {
    const TemporaryFolder folder;
    write_file(folder / "a.ply", one_point());
    EXPECT_THAT(report_of([&] { read_mesh(folder / "a.ply"); }),
                testing::AllOf(HasSubstr("has 1 point and no faces"), HasSubstr("hint:")));
}

TEST(CanWrite_Table, KnowsExtensionsInAnyCase_AndKinds) {
    EXPECT_TRUE(can_write("ply", kind_of<PointCloud>()));
    EXPECT_TRUE(can_write(".STL", kind_of<TriangleMesh>()));
    EXPECT_FALSE(can_write("stl", kind_of<PointCloud>()));
    EXPECT_FALSE(can_write("xyz", kind_of<TriangleMesh>()));
    EXPECT_FALSE(can_write("", kind_of<TriangleMesh>()));
    EXPECT_FALSE(can_write("ply", kind_of<Metrics>()));
    // Formats of modules follow, when they were built.
    EXPECT_TRUE(writable_extensions(kind_of<TriangleMesh>()).starts_with("ply, stl, off, obj"));
    EXPECT_TRUE(writable_extensions(kind_of<PointCloud>()).starts_with("ply, xyz, txt"));
    EXPECT_EQ(writable_extensions(kind_of<Metrics>()), "json");
    EXPECT_EQ(writable_extensions(kind_of<Transforms>()), "json");
}

TEST(WriteFile_Refuses, WhatCannotBe_LeavesNothing) {
    const TemporaryFolder folder;
    const Value nothing = std::make_shared<const PointCloud>();
    EXPECT_THAT(report_of([&] { write_file(folder / "a.stl", one_point()); }),
                testing::AllOf(HasSubstr("points cannot be written"), HasSubstr("ply, xyz")));
    EXPECT_THAT(report_of([&] { write_file(folder / "a", one_point()); }), HasSubstr("extension ''"));
    EXPECT_THAT(report_of([&] { write_file(folder / "a.ply", nothing); }), HasSubstr("has no points"));
    EXPECT_THAT(report_of([&] { write_file(folder / "none/a.ply", one_point()); }), HasSubstr("there is no folder"));
    EXPECT_EQ(folder.files(), 0u);
    fs::create_directory(folder / "b.ply");
    EXPECT_THAT(report_of([&] { write_file(folder / "b.ply", one_point()); }), HasSubstr("a folder has this name"));
    ASSERT_EQ(::mkfifo((folder / "c.ply").c_str(), 0600), 0);
    EXPECT_THAT(report_of([&] { write_file(folder / "c.ply", one_point()); }),
                HasSubstr("a pipe or device has this name"));
    EXPECT_EQ(folder.files(), 2u);
}

TEST(WriteBytes_OfAValue, GivesWhatTheFileWouldHold_AndRefusesAlike) {
    const TemporaryFolder folder;
    for (const char* name : {"a.ply", "a.xyz"}) {
        write_file(folder / name, one_point());
        EXPECT_EQ(write_bytes(name, one_point()), content_of(folder / name));
    }
    EXPECT_THAT(report_of([&] { write_bytes("a.stl", one_point()); }), HasSubstr("'a.stl': points cannot be written"));
    EXPECT_THAT(report_of([&] { write_bytes("a.ply", std::make_shared<const PointCloud>()); }),
                HasSubstr("has no points"));
}

TEST(WriteFile_WhenItsWarningThrows, LeavesTheOldFileAndNoOther) {
    const TemporaryFolder folder;
    put_file(folder / "a.xyz", "old");
    PointCloud cloud{{}, {Vec3(1, 2, 3)}, {}};
    cloud.columns.add(Column("weight", 1, Buffer<float>{2}));
    const WriteOptions strict{[](const std::string& sentence) { throw std::runtime_error(sentence); }};
    EXPECT_THROW(write_file(folder / "a.xyz", std::make_shared<const PointCloud>(cloud), strict), std::runtime_error);
    EXPECT_EQ(content_of(folder / "a.xyz"), "old");
    EXPECT_EQ(folder.files(), 1u);
}

TEST(WriteFile_OverAFile, ReplacesIt_WithTheUsersUmask) {
    const TemporaryFolder folder;
    put_file(folder / "a.xyz", "old");
    const mode_t mask = ::umask(0027);
    write_file(folder / "a.xyz", one_point());
    ::umask(mask);
    EXPECT_EQ(content_of(folder / "a.xyz"), "1 2 3\n");
    struct stat facts;
    ASSERT_EQ(::stat((folder / "a.xyz").c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 0777, 0640u);
    EXPECT_EQ(folder.files(), 1u);
}

TEST(WriteFile_ThroughALink, ReplacesTheLink_NotWhatItNames) {
    const TemporaryFolder folder;
    put_file(folder / "kept.xyz", "old");
    fs::create_symlink(folder / "kept.xyz", folder / "a.xyz");
    write_file(folder / "a.xyz", one_point());
    EXPECT_EQ(content_of(folder / "kept.xyz"), "old");
    EXPECT_EQ(content_of(folder / "a.xyz"), "1 2 3\n");
}

/// Simulates a full disk with a limit on the size of files: write() fails at the same point. Leaves the process
/// unusable.
bool reports_a_full_disk() {
    const TemporaryFolder folder;
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit tiny{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &tiny);
    const Value cloud =
        std::make_shared<const PointCloud>(PointCloud{{}, Buffer(Array<Vec3>(1000, Vec3(1, 2, 3))), {}});
    const std::string warnings = report_of([&] { write_file(folder / "a.ply", cloud); });
    return warnings.find("writing failed") != std::string::npos && folder.files() == 0;
}

TEST(WriteFile_OnAFullDisk, SaysSo) {
    EXPECT_EXIT(::_exit(reports_a_full_disk() ? 0 : 1), testing::ExitedWithCode(0), "");
}

TEST(WithoutInvalidPoints_OfACloud, DropsThemWithTheirRows) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    PointCloud cloud{{}, {Vec3(0, nan, 0), Vec3(1, 2, 3), Vec3(inf, 0, 0), Vec3(4, 5, 6)}, {}};
    cloud.columns.add(Column("row", 1, Buffer<u8>{0, 1, 2, 3}));
    const auto clean = without_invalid_points(cloud);
    EXPECT_EQ(clean.points, 2u);
    EXPECT_THAT(rows_of(clean.result.positions), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    EXPECT_THAT(numbers_of<u8>(clean.result.columns.find("row")), ElementsAre(1, 3));
    EXPECT_EQ(without_invalid_points(clean.result).points, 0u);
}

TEST(WithoutInvalidPoints_OfAMesh, DropsWhatTheyCarry_KeepsUnusedVertices) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    TriangleMesh mesh;
    mesh.positions = {Vec3(nan, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(9, 9, 9)};
    mesh.triangles = {Triangle{0, 1, 2}, Triangle{3, 2, 1}};
    mesh.vertex_columns.add(Column("row", 1, Buffer<u8>{0, 1, 2, 3, 4}));
    mesh.face_columns.add(Column("part", 1, Buffer<u8>{7, 8}));
    mesh.edges = {Edge{0, 1}, Edge{1, 3}};
    mesh.edge_columns.add(Column("bend", 1, Buffer<u8>{5, 6}));
    mesh.sharp_edges = {Edge{0, 2}, Edge{2, 3}};
    const auto clean = without_invalid_points(mesh);
    EXPECT_EQ(clean.points, 1u);
    EXPECT_EQ(clean.triangles, 1u);
    EXPECT_THAT(rows_of(clean.result.triangles), ElementsAre(Triangle{2, 1, 0}));
    EXPECT_THAT(rows_of(clean.result.edges), ElementsAre(Edge{0, 2}));
    EXPECT_THAT(rows_of(clean.result.sharp_edges), ElementsAre(Edge{1, 2}));
    EXPECT_THAT(numbers_of<u8>(clean.result.vertex_columns.find("row")), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(numbers_of<u8>(clean.result.face_columns.find("part")), ElementsAre(8));
    EXPECT_THAT(numbers_of<u8>(clean.result.edge_columns.find("bend")), ElementsAre(6));
    require_consistent(clean.result);
}

}  // namespace
}  // namespace scanmill::test
