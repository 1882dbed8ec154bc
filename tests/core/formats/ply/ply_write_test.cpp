// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

template <class T>
Column column(std::string name, u32 components, std::initializer_list<T> values) {
    return Column(std::move(name), components, Buffer<T>(values));
}

PointCloud rich_cloud() {
    PointCloud cloud;
    cloud.frame = {LengthUnit::millimetre, Vec3(1048576, 0, -4096), "left arm, station 2"};
    cloud.positions = {Vec3(0.1, 0.25, 1e-7), Vec3(-0.5, 0.5, 0.75)};
    cloud.columns.add(column<float>("normal", 3, {0.6f, 0.8f, 0, 0, 0, 1}));
    cloud.columns.add(column<u8>("colour", 3, {1, 2, 3, 253, 254, 255}));
    cloud.columns.add(column<double>("weight", 1, {0.1, 1e300}));
    cloud.columns.add(column<std::int8_t>("i8", 1, {-128, 127}));
    cloud.columns.add(column<std::uint16_t>("u16", 1, {0, 65535}));
    cloud.columns.add(column<std::int16_t>("i16", 1, {-32768, 32767}));
    cloud.columns.add(column<u32>("u32", 1, {0, ~u32(0)}));
    cloud.columns.add(column<std::int32_t>("direction", 2, {-1, 2, 3, -4}));
    cloud.columns.add(Column("near", Buffer<u64>{0, 2, 2}, Buffer<std::int32_t>{7, -8}));
    return cloud;
}

TEST(PlyWriter_Points, WithEveryKindOfColumn_ComeBackTheSame) {
    const TemporaryFolder folder;
    Warnings warnings;
    const PointCloud cloud = rich_cloud();
    write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud), warnings.writing());
    expect_same_points(*read_points(folder / "a.ply", warnings.reading()), cloud);
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(PlyWriter_Points, LongLists_GetALongerCount) {
    const TemporaryFolder folder;
    Array<u8> values(300);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<u8>(i);
    PointCloud cloud{{}, {Vec3(0, 0, 0), Vec3(1, 1, 1)}, {}};
    cloud.columns.add(Column("tail", Buffer<u64>{0, 44, 300}, Buffer(std::move(values))));
    write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud));
    expect_same_points(*read_points(folder / "a.ply"), cloud);
}

TEST(PlyWriter_Mesh, WithColumnsEdgesAndSharpEdges_ComesBackTheSame) {
    const TemporaryFolder folder;
    Warnings warnings;
    TriangleMesh mesh;
    mesh.frame = {LengthUnit::inch, Vec3::Zero(), "part"};
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1.0 / 3)};
    mesh.triangles = {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{3, 3, 2}};
    mesh.vertex_columns.add(column<double>("normal", 3, {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0}));
    mesh.face_columns.add(column<u8>("colour", 4, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
    mesh.face_columns.add(Column("wedge", Buffer<u64>{0, 1, 1, 3}, Buffer<float>{0.5f, 1, 2}));
    mesh.edges = {Edge{1, 3}, Edge{0, 1}};
    mesh.edge_columns.add(column<float>("bend", 1, {0.5f, -0.5f}));
    mesh.sharp_edges = {Edge{0, 1}, Edge{0, 3}, Edge{2, 3}};
    write_file(folder / "a.ply", std::make_shared<const TriangleMesh>(mesh), warnings.writing());
    const auto back = read_mesh(folder / "a.ply", warnings.reading());
    EXPECT_EQ(back->frame, mesh.frame);
    EXPECT_TRUE(std::ranges::equal(back->positions, mesh.positions));
    EXPECT_TRUE(std::ranges::equal(back->triangles, mesh.triangles));
    EXPECT_TRUE(std::ranges::equal(back->edges, mesh.edges));
    EXPECT_TRUE(std::ranges::equal(back->sharp_edges, mesh.sharp_edges));
    EXPECT_EQ(back->vertex_columns, mesh.vertex_columns);
    EXPECT_EQ(back->face_columns, mesh.face_columns);
    EXPECT_EQ(back->edge_columns, mesh.edge_columns);
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(PlyWriter_Coordinates, AreFloatOnlyWhenEveryOneIsExactlyAFloat) {
    const TemporaryFolder folder;
    const auto type_written = [&](Vec3 origin, Vec3 p) {
        PointCloud cloud{{LengthUnit::unknown, origin, ""}, {Vec3(0, 0, 0), p}, {}};
        write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud));
        EXPECT_EQ(world_of(*read_points(folder / "a.ply"), 1), origin + p);
        return content_of(folder / "a.ply").find("property float z") != std::string::npos ? "float" : "double";
    };
    EXPECT_STREQ(type_written(Vec3::Zero(), Vec3(0.5, -0.25, 0.1f)), "float");
    EXPECT_STREQ(type_written(Vec3::Zero(), Vec3(0.5, -0.25, 0.1)), "double");
    // Position and origin are floats, but their sum, the world coordinate, is not.
    EXPECT_STREQ(type_written(Vec3(0, 0, 16777216), Vec3(0, 0, 1)), "double");
    EXPECT_STREQ(type_written(Vec3(0, 0, 16777216), Vec3(0, 0, 2)), "float");
}

TEST(PlyWriter_File, IsThisForOnePoint) {
    const TemporaryFolder folder;
    PointCloud cloud{{LengthUnit::metre, Vec3::Zero(), "two\nlines"}, {Vec3(1, 2, 3)}, {}};
    cloud.columns.add(column<u8>("colour", 3, {9, 8, 7}));
    write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud));
    EXPECT_EQ(
        content_of(folder / "a.ply"),
        "ply\nformat binary_little_endian 1.0\ncomment written by scanmill\ncomment unit m\ncomment frame two lines\n"
        "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\nend_header\n" +
            bytes_of(1.0f) + bytes_of(2.0f) + bytes_of(3.0f) + "\x09\x08\x07");
}

TEST(Writers_FrameName, IsWrittenAsItWillBeRead) {
    for (const auto& [name, kept] : {std::pair("part \x16 ", "part"), {" \x01 a\tb", "a b"}, {"\n\x7f ", ""}})
        for (const char* file : {"a.ply", "a.xyz"}) {
            const Value cloud = std::make_shared<const PointCloud>(
                PointCloud{{LengthUnit::unknown, Vec3::Zero(), name}, {Vec3(1, 2, 3)}, {}});
            const std::string once = write_bytes(file, cloud);
            const auto copy = points_in(once, file);
            EXPECT_EQ(copy->frame.name, kept);
            EXPECT_EQ(write_bytes(file, copy), once);
        }
}

TEST(PlyWriter_Columns, OfLongIntegers_BecomeDoubleAndAreReported) {
    const TemporaryFolder folder;
    Warnings warnings;
    PointCloud cloud{{}, {Vec3(1, 2, 3)}, {}};
    cloud.columns.add(column<std::int64_t>("exact", 1, {-(std::int64_t(1) << 53)}));
    cloud.columns.add(column<u64>("rounded", 1, {(u64(1) << 53) + 1}));
    cloud.columns.add(column<u64>("largest", 1, {~u64(0)}));
    write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud), warnings.writing());
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("every number is kept"), HasSubstr("rounded"), HasSubstr("were rounded")));
    const auto back = read_points(folder / "a.ply");
    EXPECT_THAT(numbers_of<double>(back->columns.find("exact")), ElementsAre(-9007199254740992.0));
    EXPECT_THAT(numbers_of<double>(back->columns.find("rounded")), ElementsAre(9007199254740992.0));
}

TEST(PlyWriter_Columns, WithNamesThatPlyForbids_AreRenamedAndReported) {
    const TemporaryFolder folder;
    Warnings warnings;
    PointCloud cloud{{}, {Vec3(1, 2, 3)}, {}};
    cloud.columns.add(column<float>("normal", 3, {0, 0, 1}));
    cloud.columns.add(column<float>("nx", 1, {4}));
    cloud.columns.add(column<float>("x", 1, {5}));
    cloud.columns.add(column<float>("two words\n", 1, {6}));
    write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud), warnings.writing());
    const auto back = read_points(folder / "a.ply");
    EXPECT_EQ(world_of(*back, 0), Vec3(1, 2, 3));
    EXPECT_THAT(numbers_of<float>(back->columns.find("normal")), ElementsAre(0, 0, 1));
    EXPECT_THAT(numbers_of<float>(back->columns.find("nx_")), ElementsAre(4));
    EXPECT_THAT(numbers_of<float>(back->columns.find("x_")), ElementsAre(5));
    EXPECT_THAT(numbers_of<float>(back->columns.find("two_words_")), ElementsAre(6));
    EXPECT_EQ(warnings.sentences.size(), 3u);
}

TEST(PlyWriter_Precision, LostInTheSumWithTheOrigin_IsReported) {
    const TemporaryFolder folder;
    Warnings warnings;
    // 2^40 + 1e-6: the nearest double is 2^40 itself, and the cloud is 2e-6 wide.
    PointCloud cloud{{LengthUnit::unknown, Vec3(1099511627776.0, 0, 0), ""}, {Vec3(1e-6, 0, 0), Vec3(-1e-6, 0, 0)}, {}};
    write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud), warnings.writing());
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("moved by up to 1e-06, 0.5 of the diagonal")));
    warnings.sentences.clear();
    cloud.positions = {Vec3(1, 0, 0), Vec3(-1, 0, 0)};
    write_file(folder / "a.ply", std::make_shared<const PointCloud>(cloud), warnings.writing());
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
