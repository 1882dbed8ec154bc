// SPDX-License-Identifier: GPL-3.0-or-later
#include <random>

#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TriangleMesh far_triangle() {
    TriangleMesh mesh;
    mesh.positions = {Vec3(0.1, 0, -2), Vec3(1e21, 0, 0), Vec3(0, 1, 0)};
    mesh.triangles = {Triangle{0, 2, 1}};
    return mesh;
}

std::string written(const TriangleMesh& mesh, const char* name, Warnings* warnings = nullptr) {
    const TemporaryFolder folder;
    write_file(folder / name, std::make_shared<const TriangleMesh>(mesh),
               warnings ? warnings->writing() : WriteOptions{});
    return content_of(folder / name);
}

TEST(ObjWriter_File, IsThisForOneTriangle) {
    TriangleMesh mesh = far_triangle();
    EXPECT_EQ(written(mesh, "a.obj"), "v 0.1 0 -2\nv 1e+21 0 0\nv 0 1 0\nf 1 3 2\n");
    mesh.frame.unit = LengthUnit::millimetre;
    mesh.frame.name = "part 7";
    mesh.vertex_columns.add(Column("normal", 3, Buffer<float>{0, 0, 1, 0, 0.1f, 1, 0, 0, 1}));
    EXPECT_EQ(written(mesh, "a.obj"),
              "# unit mm\n# frame part 7\nv 0.1 0 -2\nv 1e+21 0 0\nv 0 1 0\n"
              "vn 0 0 1\nvn 0 0.1 1\nvn 0 0 1\nf 1//1 3//3 2//2\n");
    mesh.vertex_columns.add(Column("colour", 3, Buffer<u8>{0, 255, 128, 51, 1, 7, 2, 3, 254}));
    mesh.vertex_columns.add(Column("texture", 2, Buffer<double>{0, 0, 1, 0, 0, 0.25}));
    EXPECT_EQ(written(mesh, "a.obj"),
              "# unit mm\n# frame part 7\nv 0.1 0 -2 0 1 0.502\nv 1e+21 0 0 0.2 0.004 0.0275\nv 0 1 0 0.008 0.012 "
              "0.9961\nvt 0 0\nvt 1 0\nvt 0 0.25\nvn 0 0 1\nvn 0 0.1 1\nvn 0 0 1\nf 1/1/1 3/3/3 2/2/2\n");
    mesh.vertex_columns = {};
    mesh.vertex_columns.add(Column("texture", 2, Buffer<double>{0, 0, 1, 0, 0, 0.25}));
    EXPECT_THAT(written(mesh, "a.obj"), HasSubstr("\nf 1/1 3/3 2/2\n"));
}

/// A random mesh with every column that the text formats of meshes carry, and vertices that no triangle uses.
TriangleMesh random_mesh(u32 seed) {
    std::mt19937_64 random(seed);
    const auto number = [&] { return std::bit_cast<double>((random() & ~(u64(1) << 62)) | (u64(1) << 61)); };
    const std::size_t size = 30;
    TriangleMesh mesh;
    mesh.frame = {LengthUnit::foot, Vec3(4194304, 0, 0), "site 7"};
    Array<Vec3> positions(size);
    for (Vec3& p : positions) p = Vec3(static_cast<double>(random() % 4096) / 4096, number(), number());
    Array<Triangle> triangles(20);
    for (Triangle& t : triangles) t = {u32(random() % size), u32(random() % size), u32(random() % size)};
    Array<double> normals(3 * size), texture(2 * size);
    for (double& n : normals) n = number();
    for (double& t : texture) t = number();
    Array<u8> colours(3 * size);
    for (u8& c : colours) c = static_cast<u8>(random());
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    mesh.vertex_columns.add(Column("normal", 3, Buffer(std::move(normals))));
    mesh.vertex_columns.add(Column("colour", 3, Buffer(std::move(colours))));
    mesh.vertex_columns.add(Column("texture", 2, Buffer(std::move(texture))));
    return mesh;
}

TEST(ObjWriter_RandomMesh, ComesBackExactly_WithAllThatIsCarried_AndFromOffTheSame) {
    for (u32 seed = 1; seed <= 50; ++seed) {
        const TriangleMesh mesh = random_mesh(seed);
        for (const char* name : {"a.obj", "a.off"}) {
            Warnings warnings;
            const auto back = mesh_in(written(mesh, name, &warnings), name, &warnings);
            ASSERT_EQ(back->positions.size(), mesh.positions.size());
            for (std::size_t i = 0; i < mesh.positions.size(); ++i)
                ASSERT_EQ(back->frame.origin + back->positions[i], mesh.frame.origin + mesh.positions[i]) << seed;
            EXPECT_EQ(rows_of(back->triangles), rows_of(mesh.triangles)) << seed;
            EXPECT_EQ(back->vertex_columns, mesh.vertex_columns) << seed;
            EXPECT_EQ(back->frame.unit, mesh.frame.unit);
            EXPECT_EQ(back->frame.name, mesh.frame.name);
            EXPECT_THAT(warnings.sentences, IsEmpty()) << seed;
        }
    }
}

TEST(ObjWriter_ColourOfEveryByte, ComesBack) {
    TriangleMesh mesh;
    Array<Vec3> positions(256, Vec3::Zero());
    Array<u8> colours(3 * 256);
    for (std::size_t i = 0; i < 256; ++i)
        for (std::size_t channel = 0; channel < 3; ++channel)
            colours[3 * i + channel] = static_cast<u8>(i + 85 * channel);
    mesh.positions = std::move(positions);
    mesh.triangles = {Triangle{0, 1, 2}};
    mesh.vertex_columns.add(Column("colour", 3, Buffer(std::move(colours))));
    EXPECT_EQ(mesh_in(written(mesh, "a.obj"), "a.obj")->vertex_columns, mesh.vertex_columns);
    // The darkest of all could be taken for whole numbers.
    mesh = far_triangle();
    mesh.vertex_columns.add(Column("colour", 3, Buffer<u8>{0, 0, 0, 1, 0, 0, 1, 1, 1}));
    EXPECT_EQ(mesh_in(written(mesh, "a.obj"), "a.obj")->vertex_columns, mesh.vertex_columns);
}

TEST(ObjWriter_MeshWithoutTriangles, ComesBackAsItsVertices) {
    TriangleMesh mesh = far_triangle();
    mesh.triangles = {};
    mesh.vertex_columns.add(Column("normal", 3, Buffer<double>{0, 0, 1, 0, 1, 0, 1, 0, 0}));
    const auto back = points_in(written(mesh, "a.obj"), "a.obj");
    EXPECT_EQ(back->size(), 3u);
    EXPECT_EQ(back->columns, mesh.vertex_columns);
}

TEST(ObjWriter_Losses, AreReported) {
    Warnings warnings;
    TriangleMesh mesh = far_triangle();
    mesh.vertex_columns.add(Column("normal", 3, Buffer<u8>{0, 0, 1, 0, 0, 1, 0, 0, 1}));
    mesh.vertex_columns.add(Column("weight", 1, Buffer<float>{0, 0, 1}));
    mesh.vertex_columns.add(Column("colour", 4, Buffer<u8>{1, 2, 3, 255, 1, 2, 3, 254, 1, 2, 3, 0}));
    mesh.face_columns.add(Column("colour", 3, Buffer<u8>{1, 2, 3}));
    mesh.edges = {Edge{0, 1}};
    mesh.edge_columns.add(Column("bend", 1, Buffer<u8>{1}));
    mesh.sharp_edges = {Edge{0, 1}};
    const std::string text = written(mesh, "a.obj", &warnings);
    EXPECT_THAT(text, HasSubstr("v 0.1 0 -2 0.004 0.008 0.012\n"));
    EXPECT_THAT(
        warnings.sentences,
        ElementsAre(HasSubstr("2 columns of the vertices (normal, weight); PLY"),
                    HasSubstr("1 column of the faces (colour)"), HasSubstr("1 column of the edges (bend)"),
                    HasSubstr("1 edge are sharp"), HasSubstr("the opacity (the fourth channel of 'colour') of 2 ")));
}

TEST(ObjWriter_Points, AreNotWritten) {
    const TemporaryFolder folder;
    PointCloud cloud;
    cloud.positions = {Vec3(0, 0, 0)};
    EXPECT_FALSE(can_write("obj", kind_of<PointCloud>()));
    EXPECT_TRUE(can_write("obj", kind_of<TriangleMesh>()));
    EXPECT_THROW(write_file(folder / "a.obj", std::make_shared<const PointCloud>(cloud)), Error);
}

TEST(ObjWriter_Colours, ThatAreNoBytes_ComeBack) {
    const TemporaryFolder folder;
    Warnings warnings;
    const auto mesh = read_mesh(
        folder.write("a.obj", "v 0 0 0 0.5 0.25 1\nv 1 0 0 0 0.1 0.7\nv 0 1 0 1 1 1\nf 1 2 3\n"), warnings.reading());
    EXPECT_THAT(warnings.sentences,
                testing::ElementsAre(testing::HasSubstr("are not bytes; they are kept as columns")));
    warnings.sentences.clear();
    write_file(folder / "b.obj", mesh, warnings.writing());
    EXPECT_THAT(warnings.sentences, testing::IsEmpty());
    const auto back = read_mesh(folder / "b.obj");
    for (const char* channel : {"red", "green", "blue"})
        EXPECT_EQ(*back->vertex_columns.find(channel), *mesh->vertex_columns.find(channel));
}

}  // namespace
}  // namespace scanmill::test
