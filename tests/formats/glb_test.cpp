// SPDX-License-Identifier: GPL-3.0-or-later
// GLB: shape, size and position as read by assimp, and the rules of the container and its JSON.

#include "formats/assimp_support.hpp"
#include "formats/cube_in_unit.hpp"
#include "formats/glb_container.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(GlbWriter, VertexOfNoTriangle_IsLeftOutAndMovesNothing) {
    TriangleMesh mesh = cube_in(LengthUnit::metre, 0.125);
    Array<Vec3> positions;
    for (const Vec3& p : mesh.positions) positions.push_back(p + Vec3(432100, 5421000, 0));
    positions.push_back({0, 0, 0});
    mesh.positions = std::move(positions);
    Warnings warnings;
    const Container written(mesh, &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("GLB left out 1 vertex that no triangle uses")));
    const Json& accessor = *written.attribute("POSITION");
    EXPECT_EQ(accessor["count"], 8);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(accessor["max"][axis].get<double>() - accessor["min"][axis].get<double>(), 0.125);
}

TEST(GlbWriter, MillimetresWithZUp_BecomeMetresWithYUp) {
    PointCloud cloud = two_points();
    cloud.frame.unit = LengthUnit::millimetre;
    Warnings warnings;
    const SeenByAssimp seen = through_assimp(cloud, "a.glb", &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
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

TEST(GlbWriter, Container_FollowsItsSpecification) {
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

TEST(GlbWriter, FarFromZero_TheNodeHasTheOriginAndVerticesKeepMicrometres) {
    PointCloud cloud;
    cloud.frame = {LengthUnit::metre, Vec3(5e5, 5.5e6, 0), "site"};
    cloud.positions = {Vec3(0, 0, 0), Vec3(1e-6, 0.25, 0.5), Vec3(1, 1, 1)};
    Warnings warnings;
    const Container glb(cloud, &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
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

TEST(GlbWriter, UnknownUnit_IsAssumedToBeMetreWithAWarning) {
    Warnings warnings;
    const SeenByAssimp seen = through_assimp(cube(3), "a.glb", &warnings);
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("the unit is not known: 1 was written as 1 m; declare the scan's unit")));
    EXPECT_EQ(seen.box.high, Vec3(3, 3, 0));
}

TEST(GlbWriter, UnitAndFrame_AreExtrasOfTheNode) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    mesh.frame.name = "bench \xff";
    const Container glb(mesh);
    EXPECT_EQ(glb.json["nodes"][0]["extras"], (Json{{"unit", "mm"}, {"frame", "bench _"}}));
}

TEST(GlbRefuses, WhatGltfForbids) {
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

TEST(GlbRefuses, MoreThan32BitSizes_BeforeReadingThePoints) {
    PointCloud cloud;
    const Vec3 one(1, 2, 3);
    cloud.positions = Buffer<Vec3>(nullptr, &one, 400'000'000);  // only counted
    EXPECT_THAT(sentence_of([&] { Container glb(cloud); }),
                HasSubstr("needs 4800000000 bytes; GLB allows at most 4294967295"));
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
