// SPDX-License-Identifier: GPL-3.0-or-later
// 3MF: which meshes are no solids, and what is left out of those that are.

#include "formats/cube_in_unit.hpp"
#include "formats/threemf_package.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(ThreemfLosses, AreToldByName) {
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

TEST(ThreemfRefuses, WhatIsNoSolid_WithNumbers) {
    const auto refusal = [](const TriangleMesh& mesh) { return sentence_of([&] { bytes_of_3mf(mesh); }); };
    EXPECT_THAT(refusal(without_triangles(cube(1), {0})),
                HasSubstr("3 boundary edges in 1 loop, 0 edges in three or more triangles"));
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
    EXPECT_THAT(refusal(unfinite), HasSubstr("1 of 8 vertices has a NaN or an infinity"));
    EXPECT_THAT(refusal(cube(3e9)), HasSubstr("has the coordinate 3e+09, and 3MF's library takes none beyond 1e+09"));
}

TEST(ThreemfRefuses, OtherKinds_AndToRead) {
    EXPECT_THAT(error_of([] { write_bytes("a.3mf", std::make_shared<const PointCloud>(random_cube(9, 1))); }).what(),
                AllOf(HasSubstr("points cannot be written with the extension '.3mf'"), HasSubstr("ply, xyz")));
    EXPECT_THAT(refusal_of(bytes_of_3mf(cube_in(LengthUnit::millimetre)), "a.3mf"),
                HasSubstr("3MF is written for other programs, and not read"));
}

TEST(ThreemfRefuses, SolidBelowSixDecimals) {
    EXPECT_THAT(sentence_of([] { bytes_of_3mf(cube_in(LengthUnit::millimetre, 3e-7)); }),
                HasSubstr("nothing is left of the object: its diagonal is 5.2e-07 mm"));
    EXPECT_THAT(sentence_of([] { bytes_of_3mf(cube_in(LengthUnit::millimetre, 1e-160)); }),
                HasSubstr("comes to 0 mm³"));
}

}  // namespace
}  // namespace scanmill::test
