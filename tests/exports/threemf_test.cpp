// SPDX-License-Identifier: GPL-3.0-or-later
// 3MF: what assimp and lib3mf's own reader find, and which meshes are no solids.

#include <Model/COM/NMR_DLLInterfaces.h>

#include <fmt/format.h>

#include "exports/assimp_support.hpp"
#include "scanmill/filter/quantity.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The one object of a package, with what assimp does not tell.
struct SeenBy3mf {
    DWORD unit = 99;
    std::string name, uuid;
    Vec3 place = Vec3::Zero();
    std::vector<Vec3> vertices;  ///< without the place
};

std::string bytes_of_3mf(const TriangleMesh& mesh, Told* told = nullptr) {
    return write_bytes("a.3mf", std::make_shared<const TriangleMesh>(mesh), told ? told->writing() : WriteOptions{});
}

/// lib3mf's objects are left to the end of the program.
SeenBy3mf read_by_3mf(std::string bytes) {
    using namespace NMR;
    SeenBy3mf seen;
    PLib3MFModel* model = nullptr;
    PLib3MFModelReader* reader = nullptr;
    PLib3MFModelBuildItemIterator* items = nullptr;
    PLib3MFModelBuildItem* item = nullptr;
    PLib3MFModelObjectResource* object = nullptr;
    BOOL found = 0;
    MODELTRANSFORM place;
    DWORD count = 0;
    char text[200] = "";
    ULONG length = 0;
    EXPECT_EQ(lib3mf_createmodel(&model), 0);
    EXPECT_EQ(lib3mf_model_queryreader(model, "3mf", &reader), 0);
    EXPECT_EQ(lib3mf_reader_setstrictmodeactive(reader, 1), 0);
    EXPECT_EQ(lib3mf_reader_readfrombuffer(reader, reinterpret_cast<BYTE*>(bytes.data()), bytes.size()), 0);
    EXPECT_EQ(lib3mf_model_getunit(model, &seen.unit), 0);
    EXPECT_EQ(lib3mf_model_getbuilditems(model, &items), 0);
    EXPECT_EQ(lib3mf_builditemiterator_movenext(items, &found), 0);
    EXPECT_TRUE(found);
    EXPECT_EQ(lib3mf_builditemiterator_getcurrent(items, &item), 0);
    EXPECT_EQ(lib3mf_builditem_getobjecttransform(item, &place), 0);
    EXPECT_EQ(lib3mf_builditem_getobjectresource(item, &object), 0);
    EXPECT_EQ(lib3mf_object_getnameutf8(object, text, sizeof text, &length), 0);
    seen.name = text;
    EXPECT_EQ(lib3mf_object_getuuidutf8(object, &found, text), 0);
    seen.uuid = text;
    EXPECT_EQ(lib3mf_meshobject_getvertexcount(object, &count), 0);
    for (DWORD i = 0; i < count; ++i) {
        MODELMESHVERTEX v;
        EXPECT_EQ(lib3mf_meshobject_getvertex(object, i, &v), 0);
        seen.vertices.emplace_back(v.m_fPosition[0], v.m_fPosition[1], v.m_fPosition[2]);
    }
    for (int axis = 0; axis < 3; ++axis) seen.place[axis] = place.m_fFields[axis][3];
    return seen;
}

TriangleMesh cube_in(LengthUnit unit, double edge = 1) {
    TriangleMesh mesh = cube(edge);
    mesh.frame.unit = unit;
    return mesh;
}

TEST(ThreemfWriter, Cube_IsACubeForOthers) {
    Told told;
    const SeenByAssimp seen = through_assimp(cube_in(LengthUnit::millimetre, 2.5), "a.3mf", &told);
    EXPECT_THAT(told.sentences, IsEmpty());
    ASSERT_EQ(seen.error, "");
    EXPECT_EQ(seen.meshes, 1u);
    EXPECT_EQ(seen.vertices, 8u);
    EXPECT_EQ(seen.faces, 12u);
    EXPECT_EQ(seen.box.low, Vec3(0, 0, 0));
    EXPECT_EQ(seen.box.high, Vec3(2.5, 2.5, 2.5));
}

TEST(ThreemfWriter, NumbersOfFewDecimals_AreWrittenAsTheyAre) {
    for (const double edge : {10.0, 12.0, 15.5, 0.001, 8.123, 1234.5}) {
        const SeenByAssimp seen = through_assimp(cube_in(LengthUnit::millimetre, edge), "a.3mf");
        EXPECT_EQ(seen.box.high.cast<float>(), Vec3(edge, edge, edge).cast<float>()) << edge;
        EXPECT_EQ(seen.box.low, Vec3(0, 0, 0));
    }
}

/// A solid far from zero, and a vertex of no triangle that is not.
TriangleMesh far_cube(const Vec3& place, bool has_stray) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre, 2000);
    Array<Vec3> positions;
    for (const Vec3& p : mesh.positions) positions.push_back(p + place);
    if (has_stray) positions.push_back({0, 0, 0});
    mesh.positions = std::move(positions);
    return mesh;
}

TEST(ThreemfWriter, FarPlace_IsTheSameInSingleAndDouble) {
    for (const double far : {123456.75, 432099123.0, 5.421e9, 9.99e11}) {
        const SeenBy3mf seen = read_by_3mf(bytes_of_3mf(far_cube({far, -far / 3, 0}, false)));
        for (int axis = 0; axis < 2; ++axis) {
            double text = 0;
            parse_number(fmt::format("{:.6g}", seen.place[axis]), text);
            EXPECT_EQ(text, seen.place[axis]) << far;
        }
    }
}

TEST(ThreemfWriter, VertexOfNoTriangle_IsLeftOutAndMovesNothing) {
    Told told;
    const SeenBy3mf seen = read_by_3mf(bytes_of_3mf(far_cube({4.321e8, 5.421e8, 0}, true), &told));
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("3MF left out 1 vertex that no triangle uses")));
    ASSERT_EQ(seen.vertices.size(), 8u);
    BoundingBox box;
    for (const Vec3& v : seen.vertices) {
        box.low = box.low.cwiseMin(seen.place + v);
        box.high = box.high.cwiseMax(seen.place + v);
    }
    EXPECT_LT((box.low - Vec3(4.321e8, 5.421e8, 0)).cwiseAbs().maxCoeff(), 2e-3);
    EXPECT_LT((box.high - Vec3(4.321e8 + 2000, 5.421e8 + 2000, 2000)).cwiseAbs().maxCoeff(), 2e-3);
}

TEST(ThreemfWriter, SolidBelowSixDecimals_IsRefused) {
    EXPECT_THAT(sentence_of([] { bytes_of_3mf(cube_in(LengthUnit::millimetre, 3e-7)); }),
                HasSubstr("nothing is left of the object: its diagonal is 5.2e-07 mm"));
    EXPECT_THAT(sentence_of([] { bytes_of_3mf(cube_in(LengthUnit::millimetre, 1e-160)); }),
                HasSubstr("comes to 0 mm³"));
}

TEST(ThreemfWriter, EveryUnit_IsDeclared) {
    for (const auto& [unit, declared] : {std::pair(LengthUnit::micrometre, NMR::MODELUNIT_MICROMETER),
                                         {LengthUnit::millimetre, NMR::MODELUNIT_MILLIMETER},
                                         {LengthUnit::centimetre, NMR::MODELUNIT_CENTIMETER},
                                         {LengthUnit::metre, NMR::MODELUNIT_METER},
                                         {LengthUnit::inch, NMR::MODELUNIT_INCH},
                                         {LengthUnit::foot, NMR::MODELUNIT_FOOT}}) {
        const SeenBy3mf seen = read_by_3mf(bytes_of_3mf(cube_in(unit, 3)));
        EXPECT_EQ(seen.unit, static_cast<DWORD>(declared)) << symbol(unit);
        EXPECT_EQ(seen.vertices.size(), 8u);
    }
}

TEST(ThreemfWriter, UnknownUnit_IsTakenAsMillimetreAndTold) {
    Told told;
    EXPECT_EQ(read_by_3mf(bytes_of_3mf(cube(1), &told)).unit, static_cast<DWORD>(NMR::MODELUNIT_MILLIMETER));
    EXPECT_THAT(told.sentences, ElementsAre(HasSubstr("1 was written as 1 mm; say the unit")));
}

TEST(ThreemfWriter, FrameName_IsTheObjects) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    mesh.frame.name = "Teil <7> & \xfe";
    EXPECT_EQ(read_by_3mf(bytes_of_3mf(mesh)).name, "Teil <7> & _");
}

TEST(ThreemfWriter, Coordinates_AreRoundedAtTheSixthDecimal_NotCut) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& p : positions) p = p * 0.9999999 - Vec3::Constant(0.4999999);
    mesh.positions = positions;
    for (const Vec3& v : read_by_3mf(bytes_of_3mf(mesh)).vertices)
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::abs(v[axis]), 0.5, 1e-7);
}

TEST(ThreemfWriter, TinyShapes_AreToldToMove) {
    Told told;
    bytes_of_3mf(cube_in(LengthUnit::metre, 0.0123456789), &told);
    EXPECT_THAT(told.sentences,
                ElementsAre(AllOf(HasSubstr("coordinates moved by up to"), HasSubstr("a smaller unit"))));
}

TEST(ThreemfWriter, FarFromZero_PlaceAndVerticesAddUp) {
    TriangleMesh mesh = cube_in(LengthUnit::metre);
    mesh.frame.origin = Vec3(1234567, -7654321.5, 0);
    Told told;
    const SeenBy3mf seen = read_by_3mf(bytes_of_3mf(mesh, &told));
    EXPECT_THAT(told.sentences, IsEmpty());
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_LT((seen.place + seen.vertices[i] - (mesh.frame.origin + mesh.positions[i])).norm(), 3e-6) << i;
    EXPECT_NE(seen.place, Vec3::Zero());
}

TEST(ThreemfWriter_Losses, AreToldByName) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    mesh.vertex_columns.add(Column("colour", 3, Buffer<u8>(Array<u8>(24, u8(9)))));
    mesh.face_columns.add(Column("group", 1, Buffer<u8>(Array<u8>(12, u8(1)))));
    mesh.sharp_edges = {{0, 1}, {1, 2}};
    Told told;
    bytes_of_3mf(mesh, &told);
    EXPECT_THAT(told.sentences,
                ElementsAre(HasSubstr("3MF left out 1 column of the vertices (colour)"),
                            HasSubstr("3MF left out 1 column of the faces (group)"), HasSubstr("2 edges are sharp")));
}

TEST(ThreemfWriter_Refuses, WhatIsNoSolid_WithNumbers) {
    const auto refusal = [](const TriangleMesh& mesh) { return sentence_of([&] { bytes_of_3mf(mesh); }); };
    EXPECT_THAT(refusal(without_triangles(cube(1), {0})),
                HasSubstr("3 boundary edges in 1 loops, 0 edges in three or more triangles"));
    TriangleMesh turned = cube(2);
    Array<Triangle> triangles(turned.triangles.begin(), turned.triangles.end());
    for (Triangle& triangle : triangles) std::swap(triangle[0], triangle[1]);
    turned.triangles = triangles;
    EXPECT_THAT(refusal(turned), AllOf(HasSubstr("encloses the volume -8"), HasSubstr("do not face outwards")));
    TriangleMesh disagreeing = cube(1);
    triangles.assign(disagreeing.triangles.begin(), disagreeing.triangles.end());
    std::swap(triangles[0][0], triangles[0][1]);
    disagreeing.triangles = triangles;
    EXPECT_THAT(refusal(disagreeing), HasSubstr("3 edges whose two triangles disagree"));
    TriangleMesh empty = cube(1);
    empty.triangles = {};
    EXPECT_THAT(refusal(empty), HasSubstr("has no triangles, and 3MF holds solids only"));
    TriangleMesh unfinite = cube(1);
    Array<Vec3> positions(unfinite.positions.begin(), unfinite.positions.end());
    positions[3].x() = INFINITY;
    unfinite.positions = positions;
    EXPECT_THAT(refusal(unfinite), HasSubstr("1 of 8 vertices have a NaN or an infinity"));
    EXPECT_THAT(refusal(cube(3e9)), HasSubstr("has the coordinate 3e+09, and 3MF's library takes none beyond 1e+09"));
}

TEST(ThreemfWriter_Refuses, OtherKinds_AndToRead) {
    EXPECT_THAT(error_of([] { write_bytes("a.3mf", std::make_shared<const PointCloud>(random_cube(9, 1))); }).what(),
                AllOf(HasSubstr("points cannot be written with the extension '.3mf'"), HasSubstr("ply, xyz")));
    EXPECT_THAT(refusal_of(bytes_of_3mf(cube_in(LengthUnit::millimetre)), "a.3mf"),
                HasSubstr("3MF is written for other programs, and not read"));
}

TEST(ThreemfWriter, EqualValues_GiveEqualBytes_AndOthersOtherUuids) {
    const std::string bytes = bytes_of_3mf(cube_in(LengthUnit::millimetre, 2));
    EXPECT_EQ(bytes, bytes_of_3mf(cube_in(LengthUnit::millimetre, 2)));
    const std::string uuid = read_by_3mf(bytes).uuid;
    EXPECT_THAT(uuid, testing::MatchesRegex("[0-9a-f]{8}-[0-9a-f]{4}-8[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}"));
    EXPECT_NE(uuid, read_by_3mf(bytes_of_3mf(cube_in(LengthUnit::millimetre, 3))).uuid);
}

TEST(ThreemfWriter, RealMesh_HasItsCountsAndBox) {
    SCANMILL_REAL_SCAN(file, fetched_data, "meshes/fandisk_large.off");
    TriangleMesh mesh = *read_mesh(file);
    mesh.frame.unit = LengthUnit::centimetre;
    const SeenByAssimp seen = through_assimp(mesh, "a.3mf");
    EXPECT_EQ(seen.vertices, mesh.positions.size());
    EXPECT_EQ(seen.faces, mesh.triangles.size());
    const BoundingBox box = bounding_box(mesh.positions.span());
    EXPECT_LT((seen.box.low - (box.low + mesh.frame.origin)).norm(), 3e-6);
    EXPECT_LT((seen.box.high - (box.high + mesh.frame.origin)).norm(), 3e-6);
}

}  // namespace
}  // namespace scanmill::test
