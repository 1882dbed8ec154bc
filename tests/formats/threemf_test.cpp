// SPDX-License-Identifier: GPL-3.0-or-later
// 3MF as read by assimp and lib3mf.

#include <fmt/format.h>

#include "formats/assimp_support.hpp"
#include "formats/cube_in_unit.hpp"
#include "formats/threemf_package.hpp"
#include "scanmill/data/quantity.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ThreemfWriter, Cube_IsReadAsACube) {
    Warnings warnings;
    const SeenByAssimp seen = through_assimp(cube_in(LengthUnit::millimetre, 2.5), "a.3mf", &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    ASSERT_EQ(seen.error, "");
    EXPECT_EQ(seen.meshes, 1u);
    EXPECT_EQ(seen.vertices, 8u);
    EXPECT_EQ(seen.faces, 12u);
    EXPECT_EQ(seen.box.low, Vec3(0, 0, 0));
    EXPECT_EQ(seen.box.high, Vec3(2.5, 2.5, 2.5));
}

TEST(ThreemfWriter, ColoursOfVertices_AreAGroupOfColours) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre, 2.5);
    Array<u8> colours;
    for (u8 vertex = 0; vertex < 8; ++vertex)
        for (const int channel : {10 * vertex, 255, 0}) colours.push_back(static_cast<u8>(channel));
    mesh.vertex_columns.add(Column("colour", 3, Buffer<u8>(std::move(colours))));
    Warnings warnings;
    const std::string bytes = bytes_of_3mf(mesh, &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    EXPECT_EQ(read_by_3mf(bytes).vertices.size(), 8u) << "in lib3mf's strict mode";
    const std::string model = model_in_3mf(bytes);
    const Triangle& first = mesh.triangles[0];
    EXPECT_THAT(model,
                AllOf(HasSubstr("<m:color color=\"#00FF00\"/>\n<m:color color=\"#0AFF00\"/>"),
                      HasSubstr("<object id=\"1\" pid=\"2\" pindex=\"0\">"),
                      HasSubstr(fmt::format("pid=\"2\" p1=\"{}\" p2=\"{}\" p3=\"{}\"", first[0], first[1], first[2]))));
    EXPECT_THAT(through_assimp(mesh, "a.3mf").error, "");
}

TEST(ThreemfWriter, NumbersOfFewDecimals_AreWrittenExactly) {
    for (const double edge : {10.0, 12.0, 15.5, 0.001, 8.123, 1234.5}) {
        const SeenByAssimp seen = through_assimp(cube_in(LengthUnit::millimetre, edge), "a.3mf");
        EXPECT_EQ(seen.box.high.cast<float>(), Vec3(edge, edge, edge).cast<float>()) << edge;
        EXPECT_EQ(seen.box.low, Vec3(0, 0, 0));
    }
}

/// A solid far from zero, optionally with a vertex at zero that no triangle uses.
TriangleMesh far_cube(const Vec3& offset, bool has_stray) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre, 2000);
    Array<Vec3> positions;
    for (const Vec3& p : mesh.positions) positions.push_back(p + offset);
    if (has_stray) positions.push_back({0, 0, 0});
    mesh.positions = std::move(positions);
    return mesh;
}

TEST(ThreemfWriter, FarOffset_IsTheSameInSingleAndDouble) {
    for (const double far : {123456.75, 432099123.0, 5.421e9, 9.99e11}) {
        const std::string bytes = bytes_of_3mf(far_cube({far, -far / 3, 0}, false));
        const SeenBy3mf seen = read_by_3mf(bytes);
        const std::string model = model_in_3mf(bytes);
        const std::string transform =
            fmt::format("transform=\"1 0 0 0 1 0 0 0 1 {} {} 0\"", seen.offset.x(), seen.offset.y());
        EXPECT_THAT(model, HasSubstr(transform));
    }
}

TEST(ThreemfWriter, VertexOfNoTriangle_IsLeftOutAndMovesNothing) {
    Warnings warnings;
    const SeenBy3mf seen = read_by_3mf(bytes_of_3mf(far_cube({4.321e8, 5.421e8, 0}, true), &warnings));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("3MF left out 1 vertex that no triangle uses")));
    ASSERT_EQ(seen.vertices.size(), 8u);
    BoundingBox box;
    for (const Vec3& v : seen.vertices) {
        box.low = box.low.cwiseMin(seen.offset + v);
        box.high = box.high.cwiseMax(seen.offset + v);
    }
    EXPECT_LT((box.low - Vec3(4.321e8, 5.421e8, 0)).cwiseAbs().maxCoeff(), 2e-3);
    EXPECT_LT((box.high - Vec3(4.321e8 + 2000, 5.421e8 + 2000, 2000)).cwiseAbs().maxCoeff(), 2e-3);
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

TEST(ThreemfWriter, UnknownUnit_IsAssumedToBeMillimetreWithAWarning) {
    Warnings warnings;
    EXPECT_EQ(read_by_3mf(bytes_of_3mf(cube(1), &warnings)).unit, static_cast<DWORD>(NMR::MODELUNIT_MILLIMETER));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 was written as 1 mm; declare the scan's unit")));
}

TEST(ThreemfWriter, FrameName_IsTheObjects) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    mesh.frame.name = "Teil <7> & \xfe";
    EXPECT_EQ(read_by_3mf(bytes_of_3mf(mesh)).name, "Teil <7> & _");
}

TEST(ThreemfWriter, Coordinates_AreTheNearestFloats) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& p : positions) p = p * 0.9999999 - Vec3::Constant(0.4999999);
    mesh.positions = positions;
    const std::vector<Vec3> seen = read_by_3mf(bytes_of_3mf(mesh)).vertices;
    ASSERT_EQ(seen.size(), positions.size());
    for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], positions[i].cast<float>().cast<double>());
}

TEST(ThreemfWriter, TinyShapes_KeepTheirDigits) {
    for (const double edge : {0.0123456789, 3e-7}) {
        Warnings warnings;
        const SeenBy3mf seen = read_by_3mf(bytes_of_3mf(cube_in(LengthUnit::metre, edge), &warnings));
        EXPECT_THAT(warnings.sentences, IsEmpty());
        for (const Vec3& v : seen.vertices)
            for (const double number : v) EXPECT_NEAR(number, number < edge / 2 ? 0 : edge, 1e-7 * edge);
    }
}

TEST(ThreemfWriter, VerticesThatFloatsJoin_AreReported) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    Array<Vec3> positions;
    for (const Vec3& p : mesh.positions) positions.push_back({1 + 1e-9 * p.x(), p.y(), p.z()});
    mesh.positions = positions;
    Warnings warnings;
    bytes_of_3mf(mesh, &warnings);
    EXPECT_THAT(warnings.sentences, testing::Contains(HasSubstr("4 vertices became equal to others in 3MF's single")));
}

TEST(ThreemfWriter, FarFromZero_OffsetAndVerticesAddUp) {
    TriangleMesh mesh = cube_in(LengthUnit::metre);
    mesh.frame.origin = Vec3(1234567, -7654321.5, 0);
    Warnings warnings;
    const SeenBy3mf seen = read_by_3mf(bytes_of_3mf(mesh, &warnings));
    EXPECT_THAT(warnings.sentences, IsEmpty());
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_LT((seen.offset + seen.vertices[i] - (mesh.frame.origin + mesh.positions[i])).norm(), 3e-6) << i;
    EXPECT_NE(seen.offset, Vec3::Zero());
}

TEST(ThreemfWriter, EqualValues_GiveEqualBytes) {
    const std::string bytes = bytes_of_3mf(cube_in(LengthUnit::millimetre, 2));
    EXPECT_EQ(bytes, bytes_of_3mf(cube_in(LengthUnit::millimetre, 2)));
    EXPECT_NE(bytes, bytes_of_3mf(cube_in(LengthUnit::millimetre, 3)));
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
