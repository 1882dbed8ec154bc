// SPDX-License-Identifier: GPL-3.0-or-later
// GLB: shape, size and place as assimp sees them, and the rules of the container and its JSON.

#include <nlohmann/json.hpp>

#include "exports/assimp_support.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
    T number;
    std::memcpy(&number, bytes.substr(at, sizeof(T)).data(), sizeof(T));
    return number;
}

/// A GLB taken apart by its specification.
struct Container {
    std::string bytes;
    Json json;
    std::string_view numbers;

    template <class T>
    explicit Container(const T& object, Told* told = nullptr)
        : bytes(write_bytes("a.glb", std::make_shared<const T>(object), told ? told->writing() : WriteOptions{})) {
        const auto length = number_at<u32>(bytes, 12);
        json = Json::parse(std::string_view(bytes).substr(20, length));
        numbers = std::string_view(bytes).substr(28 + length);
    }
    const Json& primitive() const { return json["meshes"][0]["primitives"][0]; }
    const Json* attribute(const std::string& name) const {
        const Json& all = primitive()["attributes"];
        return all.contains(name) ? &json["accessors"][all[name].get<std::size_t>()] : nullptr;
    }
    template <class T>
    T number(const std::string& name, std::size_t row, std::size_t component) const {
        const Json& view = json["bufferViews"][(*attribute(name))["bufferView"].get<std::size_t>()];
        return number_at<T>(numbers, view.value("byteOffset", std::size_t(0)) +
                                         row * view["byteStride"].get<std::size_t>() + component * sizeof(T));
    }
};

TriangleMesh cube_in(LengthUnit unit, double edge = 1) {
    TriangleMesh mesh = cube(edge);
    mesh.frame.unit = unit;
    return mesh;
}

PointCloud two_points() {
    PointCloud cloud;
    cloud.frame.unit = LengthUnit::metre;
    cloud.positions = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
    return cloud;
}

TEST(GlbWriter, VertexOfNoTriangle_IsLeftOutAndMovesNothing) {
    TriangleMesh mesh = cube_in(LengthUnit::metre, 0.125);
    Array<Vec3> positions;
    for (const Vec3& p : mesh.positions) positions.push_back(p + Vec3(432100, 5421000, 0));
    positions.push_back({0, 0, 0});
    mesh.positions = std::move(positions);
    Told told;
    const Container written(mesh, &told);
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("GLB left out 1 vertex that no triangle uses")));
    const Json& accessor = *written.attribute("POSITION");
    EXPECT_EQ(accessor["count"], 8);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(accessor["max"][axis].get<double>() - accessor["min"][axis].get<double>(), 0.125);
}

TEST(GlbWriter, MillimetresWithZUp_BecomeMetresWithYUp) {
    PointCloud cloud = two_points();
    cloud.frame.unit = LengthUnit::millimetre;
    Told told;
    const SeenByAssimp seen = through_assimp(cloud, "a.glb", &told);
    EXPECT_THAT(told.sentences, IsEmpty());
    ASSERT_EQ(seen.vertices, 2u) << seen.error;
    EXPECT_EQ(seen.primitive_types, static_cast<unsigned>(aiPrimitiveType_POINT));
    EXPECT_LT((seen.positions[0] - Vec3(0.001, 0.003, -0.002)).norm(), 1e-9);
    EXPECT_LT((seen.positions[1] - Vec3(0.004, 0.006, -0.005)).norm(), 1e-9);
}

TEST(GlbWriter, Mesh_HasItsTrianglesAndBoxInEveryUnit) {
    for (const auto& [unit, metres] : {std::pair(LengthUnit::micrometre, 1e-6),
                                       {LengthUnit::centimetre, 0.01},
                                       {LengthUnit::inch, 0.0254},
                                       {LengthUnit::foot, 0.3048}}) {
        const SeenByAssimp seen = through_assimp(cube_in(unit, 2), "a.glb");
        EXPECT_EQ(seen.error, "");
        EXPECT_EQ(seen.faces, 12u);
        EXPECT_EQ(seen.vertices, 8u);
        EXPECT_EQ(seen.primitive_types, static_cast<unsigned>(aiPrimitiveType_TRIANGLE));
        EXPECT_LT((seen.box.low - metres * Vec3(0, 0, -2)).norm(), 1e-6 * metres);
        EXPECT_LT((seen.box.high - metres * Vec3(2, 2, 0)).norm(), 1e-6 * metres);
    }
}

TEST(GlbWriter, Container_ObeysItsSpecification) {
    const Container glb(cube_in(LengthUnit::metre));
    EXPECT_TRUE(glb.bytes.starts_with("glTF"));
    EXPECT_EQ(number_at<u32>(glb.bytes, 4), 2u);
    EXPECT_EQ(number_at<u32>(glb.bytes, 8), glb.bytes.size());
    EXPECT_EQ(glb.bytes.size() % 4, 0u);
    EXPECT_EQ(glb.json["buffers"][0]["byteLength"], 8 * 12 + 12 * 12);
    const Json& indices = glb.json["accessors"][glb.primitive()["indices"].get<std::size_t>()];
    EXPECT_EQ(indices["componentType"], 5125) << "32 bits";
    EXPECT_EQ(indices["count"], 36);
    EXPECT_EQ((*glb.attribute("POSITION"))["min"], Json::array({0.0, 0.0, -1.0}));
    EXPECT_EQ((*glb.attribute("POSITION"))["max"], Json::array({1.0, 1.0, 0.0}));
    EXPECT_FALSE(glb.json["nodes"][0].contains("translation"));
    for (const Json& view : glb.json["bufferViews"]) EXPECT_EQ(view.value("byteOffset", 0) % 4, 0);
}

TEST(GlbWriter, FarFromZero_TheNodeHoldsThePlaceAndVerticesTheirMicrometres) {
    PointCloud cloud;
    cloud.frame = {LengthUnit::metre, Vec3(5e5, 5.5e6, 0), "site"};
    cloud.positions = {Vec3(0, 0, 0), Vec3(1e-6, 0.25, 0.5), Vec3(1, 1, 1)};
    Told told;
    const Container glb(cloud, &told);
    EXPECT_THAT(told.sentences, IsEmpty());
    const Json& node = glb.json["nodes"][0];
    EXPECT_EQ(node["name"], "site");
    ASSERT_TRUE(node.contains("translation"));
    for (std::size_t row = 0; row < 3; ++row) {
        const Vec3 world = cloud.frame.origin + cloud.positions[row];
        const double expected[3] = {world.x(), world.z(), -world.y()};
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(node["translation"][axis].get<double>() + glb.number<float>("POSITION", row, axis),
                        expected[axis], 2e-7);
    }
}

TEST(GlbWriter, UnknownUnit_IsTakenAsMetreAndTold) {
    Told told;
    const SeenByAssimp seen = through_assimp(cube(3), "a.glb", &told);
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("the unit is not known: 1 was written as 1 m; say the unit")));
    EXPECT_EQ(seen.box.high, Vec3(3, 3, 0));
}

TEST(GlbWriter, UnitAndFrame_AreExtrasOfTheNode) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    mesh.frame.name = "bench \xff";
    const Container glb(mesh);
    EXPECT_EQ(glb.json["nodes"][0]["extras"], (Json{{"unit", "mm"}, {"frame", "bench _"}}));
}

TEST(GlbWriter, Normals_AreTurnedAndMadeUnit_AndColoursAreLinear) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("normal", 3, Buffer<float>{0, 0, 2, 0.6f, 0.8f, 0}));
    cloud.columns.add(Column("colour", 3, Buffer<u8>{0, 188, 255, 10, 0, 0}));
    Told told;
    const SeenByAssimp seen = through_assimp(cloud, "a.glb", &told);
    EXPECT_THAT(told.sentences, IsEmpty());
    ASSERT_EQ(seen.normals.size(), 2u);
    EXPECT_LT((seen.normals[0] - Vec3(0, 1, 0)).norm(), 1e-6);
    EXPECT_LT((seen.normals[1] - Vec3(0.6, 0, -0.8)).norm(), 1e-6);
    const Container glb(cloud);
    EXPECT_EQ((*glb.attribute("COLOR_0"))["normalized"], true);
    EXPECT_EQ((*glb.attribute("COLOR_0"))["type"], "VEC4");
    // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4 = 0.502886; 10/255/12.92 = 0.003035.
    EXPECT_EQ(glb.number<std::uint16_t>("COLOR_0", 0, 0), 0);
    EXPECT_NEAR(glb.number<std::uint16_t>("COLOR_0", 0, 1), 0.502886 * 65535, 1);
    EXPECT_EQ(glb.number<std::uint16_t>("COLOR_0", 0, 2), 65535);
    EXPECT_NEAR(glb.number<std::uint16_t>("COLOR_0", 1, 0), 0.0030353 * 65535, 1);
    EXPECT_EQ(glb.number<std::uint16_t>("COLOR_0", 1, 3), 65535);
    EXPECT_FALSE(glb.json["materials"][0].contains("alphaMode"));
}

TEST(GlbWriter, Opacity_IsKept) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("colour", 4, Buffer<u8>{1, 2, 3, 255, 4, 5, 6, 51}));
    const Container glb(cloud);
    EXPECT_EQ(glb.number<std::uint16_t>("COLOR_0", 1, 3), 51 * 257);
    EXPECT_EQ(glb.json["materials"][0]["alphaMode"], "BLEND");
}

TEST(GlbWriter, OtherColumns_AreAttributesOfTheirOwn) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("ring", 1, Buffer<std::uint16_t>{7, 65535}));
    cloud.columns.add(Column("bits", 3, Buffer<std::int8_t>{-1, 2, 3, 4, -5, -128}));
    cloud.columns.add(Column("id", 1, Buffer<u32>{16777216, 3}));
    cloud.columns.add(Column("intensity", 1, Buffer<double>{0.5, 0.25}));
    Told told;
    const Container glb(cloud, &told);
    EXPECT_THAT(told.sentences, IsEmpty());
    EXPECT_EQ((*glb.attribute("_RING"))["componentType"], 5123);
    EXPECT_EQ(glb.number<std::uint16_t>("_RING", 1, 0), 65535);
    EXPECT_EQ((*glb.attribute("_BITS"))["componentType"], 5120);
    EXPECT_EQ((*glb.attribute("_BITS"))["type"], "VEC3");
    EXPECT_EQ(glb.number<std::int8_t>("_BITS", 1, 2), -128);
    EXPECT_EQ(glb.number<float>("_ID", 0, 0), 16777216.f);
    EXPECT_EQ(glb.number<float>("_INTENSITY", 1, 0), 0.25f);
}

TEST(GlbWriter_Losses, AreToldByName) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("lists", Buffer<u64>{0, 1, 1}, Buffer<u32>{4}));
    cloud.columns.add(Column("wide", 5, Buffer<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
    cloud.columns.add(Column("holes", 1, Buffer<float>{NAN, 1}));
    cloud.columns.add(Column("id", 1, Buffer<std::int64_t>{16777217, -3}));
    cloud.columns.add(Column("vast", 1, Buffer<double>{1e300, 1}));
    cloud.columns.add(Column("time", 1, Buffer<double>{0.1, 1}));
    cloud.columns.add(Column("a b", 1, Buffer<float>{1, 2}));
    cloud.columns.add(Column("A_B", 1, Buffer<float>{1, 2}));
    Told told;
    const Container glb(cloud, &told);
    EXPECT_THAT(told.sentences,
                ElementsAre(HasSubstr("left out the column 'lists': it holds lists"),
                            HasSubstr("left out the column 'wide': it has 5 numbers per row"),
                            HasSubstr("left out the column 'holes': 1 of its numbers is NaN or infinite"),
                            HasSubstr("left out the column 'id': 1 of its numbers is a whole number beyond 2^24"),
                            HasSubstr("left out the column 'vast': 1 of its numbers is beyond"),
                            HasSubstr("rounded the column 'time' to single precision"),
                            HasSubstr("the column 'a b' under the name '_A_B'"),
                            HasSubstr("the column 'A_B' under the name '_A_B_2'")));
    EXPECT_EQ(glb.primitive()["attributes"].size(), 4u) << "POSITION, _TIME, _A_B, _A_B_2";
}

TEST(GlbWriter_Losses, NormalsWithoutDirection_AreNoNormals) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("normal", 3, Buffer<float>{0, 0, 1, 0, 0, 0}));
    Told told;
    const Container glb(cloud, &told);
    EXPECT_FALSE(glb.attribute("NORMAL"));
    EXPECT_EQ(glb.number<float>("_NORMAL", 0, 2), 1.f);
    EXPECT_THAT(told.sentences,
                ElementsAre(HasSubstr("'normal' as '_NORMAL' and not as its normals: 1 of them has no")));
}

TEST(GlbWriter_Losses, OfFacesAndEdges_AreTold) {
    TriangleMesh mesh = cube_in(LengthUnit::metre);
    mesh.face_columns.add(Column("group", 1, Buffer<u8>(Array<u8>(12, u8(1)))));
    mesh.sharp_edges = {{0, 1}};
    Told told;
    through_assimp(mesh, "a.glb", &told);
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("GLB left out 1 column of the faces (group)"),
                                            HasSubstr("GLB left out that 1 edge are sharp")));
}

TEST(GlbWriter_Refuses, WhatGltfForbids) {
    PointCloud cloud = two_points();
    cloud.positions = {Vec3(1, 2, 3), Vec3(NAN, 0, 0)};
    EXPECT_THAT(sentence_of([&] { Container glb(cloud); }), HasSubstr("NaN"));
    TriangleMesh mesh = cube_in(LengthUnit::metre);
    mesh.triangles = {};
    EXPECT_THAT(sentence_of([&] { Container glb(mesh); }), HasSubstr("the mesh has 8 vertices and no triangles"));
    cloud.positions = {Vec3(1e300, 0, 0)};
    EXPECT_THAT(sentence_of([&] { Container glb(cloud); }), HasSubstr("beyond what GLB can write"));
    EXPECT_THAT(error_of([] { write_bytes("a.glb", std::make_shared<const TetMesh>(TetMesh{})); }).what(),
                HasSubstr("extensions for it: vtu"));
}

TEST(GlbWriter_Refuses, MoreThan32BitsCount_BeforeItReadsThem) {
    PointCloud cloud;
    const Vec3 one(1, 2, 3);
    cloud.positions = Buffer<Vec3>(nullptr, &one, 400'000'000);  // only counted
    EXPECT_THAT(sentence_of([&] { Container glb(cloud); }),
                HasSubstr("needs 4800000000 bytes; a GLB file holds at most 4294967295"));
}

TEST(GlbWriter, EqualValues_GiveEqualBytes) {
    const Value mesh = std::make_shared<const TriangleMesh>(geodesic_sphere(2, 8));
    EXPECT_EQ(write_bytes("a.glb", mesh), write_bytes("b.glb", mesh));
    EXPECT_THAT(refusal_of(write_bytes("a.glb", mesh), "a.bin"), HasSubstr("GLB is written for other programs"));
}

TEST(GlbWriter, RealMesh_HasItsCountsAndBox) {
    SCANMILL_REAL_SCAN(file, fetched_data, "meshes/fandisk_large.off");
    TriangleMesh mesh = *read_mesh(file);
    mesh.frame.unit = LengthUnit::centimetre;
    const SeenByAssimp seen = through_assimp(mesh, "a.glb");
    EXPECT_EQ(seen.vertices, mesh.positions.size());
    EXPECT_EQ(seen.faces, mesh.triangles.size());
    const BoundingBox box = bounding_box(mesh.positions.span());
    const Vec3 low = 0.01 * (box.low + mesh.frame.origin), high = 0.01 * (box.high + mesh.frame.origin);
    const double bearable = 1e-8 * box.diagonal();  // float, in metres
    EXPECT_LT((seen.box.low - Vec3(low.x(), low.z(), -high.y())).norm(), bearable);
    EXPECT_LT((seen.box.high - Vec3(high.x(), high.z(), -low.y())).norm(), bearable);
}

}  // namespace
}  // namespace scanmill::test
