// SPDX-License-Identifier: GPL-3.0-or-later
// 3MF: meshes that are not solids, and data that is left out.

#include "formats/cube_in_unit.hpp"
#include "formats/threemf_package.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(ThreemfLosses, AreReportedByName) {
    TriangleMesh mesh = cube_in(LengthUnit::millimetre);
    mesh.vertex_columns.add(Column("normal", 3, Buffer<float>(Array<float>(24, 1.f))));
    mesh.face_columns.add(Column("group", 1, Buffer<u8>(Array<u8>(12, u8(1)))));
    mesh.sharp_edges = {{0, 1}, {1, 2}};
    Warnings warnings;
    bytes_of_3mf(mesh, &warnings);
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("3MF left out 1 column of the vertices (normal)"),
                            HasSubstr("3MF left out 1 column of the faces (group)"), HasSubstr("2 edges are sharp")));
}

TEST(ThreemfRefuses, MeshesThatAreNotSolids_WithNumbers) {
    const auto refusal = [](const TriangleMesh& mesh) { return sentence_of([&] { bytes_of_3mf(mesh); }); };
    EXPECT_THAT(refusal(without_triangles(cube(1), {0})),
                AllOf(HasSubstr("3 boundary edges in 1 loop"), testing::Not(HasSubstr(" 0 "))));
    TriangleMesh twice = cube(1);
    Array<Triangle> repeated(twice.triangles.begin(), twice.triangles.end());
    repeated.push_back({0, 0, 1});
    twice.triangles = repeated;
    EXPECT_THAT(refusal(twice), AllOf(HasSubstr("1 triangle with a repeated vertex"), testing::Not(HasSubstr(" 0 ")),
                                      testing::Not(HasSubstr("boundary"))));
    TriangleMesh turned = cube(2);
    Array<Triangle> triangles(turned.triangles.begin(), turned.triangles.end());
    for (Triangle& triangle : triangles) std::swap(triangle[0], triangle[1]);
    turned.triangles = triangles;
    EXPECT_THAT(refusal(turned), AllOf(HasSubstr("encloses the volume -8"), HasSubstr("do not face outwards")));
    TriangleMesh disagreeing = cube(1);
    triangles.assign(disagreeing.triangles.begin(), disagreeing.triangles.end());
    std::swap(triangles[0][0], triangles[0][1]);
    disagreeing.triangles = triangles;
    EXPECT_THAT(refusal(disagreeing), HasSubstr("3 edges between triangles of opposite orientation"));
    TriangleMesh empty = cube(1);
    empty.triangles = {};
    EXPECT_THAT(refusal(empty), HasSubstr("has no triangles, and 3MF holds solids only"));
    TriangleMesh not_finite = cube(1);
    Array<Vec3> positions(not_finite.positions.begin(), not_finite.positions.end());
    positions[3].x() = INFINITY;
    not_finite.positions = positions;
    EXPECT_THAT(refusal(not_finite), HasSubstr("1 of 8 vertices has a NaN or an infinity"));
    TriangleMesh flat;
    flat.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    flat.triangles = {{0, 1, 2}, {0, 2, 1}};
    EXPECT_THAT(refusal(flat), HasSubstr("the volume of the mesh is 0"));
}

TEST(ThreemfRefuses, OtherKinds_AndToRead) {
    EXPECT_THAT(error_of([] { write_bytes("a.3mf", std::make_shared<const PointCloud>(random_cube(9, 1))); }).what(),
                AllOf(HasSubstr("points cannot be written with the extension '.3mf'"), HasSubstr("ply, xyz")));
    EXPECT_THAT(refusal_of(bytes_of_3mf(cube_in(LengthUnit::millimetre)), "a.3mf"),
                HasSubstr("3MF is written for other programs, and not read"));
}

}  // namespace
}  // namespace scanmill::test
