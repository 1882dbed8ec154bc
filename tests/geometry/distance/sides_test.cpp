// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/sides.hpp"

#include <gmock/gmock.h>

#include <utility>

#include "support/shapes.hpp"

namespace scanmill {
namespace {

TriangleMesh reversed(TriangleMesh mesh) {
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
    mesh.triangles = std::move(triangles);
    return mesh;
}

TriangleMesh joined(std::initializer_list<TriangleMesh> parts) {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (const TriangleMesh& part : parts) {
        const u32 shift = static_cast<u32>(positions.size());
        positions.insert(positions.end(), part.positions.begin(), part.positions.end());
        for (const Triangle& t : part.triangles) triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    }
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

/// The volume after all components face outwards.
double volume_after(TriangleMesh mesh) {
    Execution execution;
    face_outwards(mesh, execution);
    EXPECT_EQ(face_outwards(mesh, execution), 0u) << "a second time nothing is reversed";
    return test::signed_volume(mesh);
}

TEST(FaceOutwards, ComponentInsideOutIsReversed_OthersStay) {
    const TriangleMesh out = test::geodesic_sphere(1, 6), in = reversed(out);
    const double volume = test::signed_volume(out);
    EXPECT_DOUBLE_EQ(volume_after(out), volume);
    EXPECT_DOUBLE_EQ(volume_after(in), volume);
}

TEST(FaceOutwards, CavityFacesInwards_ABodyInItOutwards) {
    const TriangleMesh large = test::geodesic_sphere(3, 6), middle = test::geodesic_sphere(2, 6);
    const TriangleMesh small = test::geodesic_sphere(1, 6);
    const double expected = test::signed_volume(large) - test::signed_volume(middle) + test::signed_volume(small);
    for (const bool a : {false, true})
        for (const bool b : {false, true})
            for (const bool c : {false, true})
                EXPECT_NEAR(volume_after(joined({a ? reversed(large) : large, b ? reversed(middle) : middle,
                                                 c ? reversed(small) : small})),
                            expected, 1e-9);
}

TEST(FaceOutwards, BoxesNestedButBodiesApart_BothFaceOutwards) {
    // The small sphere is in the hole of the torus.
    const TriangleMesh torus = test::torus(2, 0.5, 40, 20), ball = test::geodesic_sphere(0.4, 5);
    EXPECT_NEAR(volume_after(joined({reversed(torus), reversed(ball)})),
                test::signed_volume(torus) + test::signed_volume(ball), 1e-9);
}

TEST(FaceOutwards, PartsThatTouch_FaceOutwardsWhicheverVertexIsFirst) {
    // The small cube is in the corner of the L-shaped block, at its wall.
    const TriangleMesh block = test::l_block(10);
    for (u32 first = 0; first < 8; ++first) {
        TriangleMesh cube = test::cube(2);
        Array<Vec3> positions(cube.positions.begin(), cube.positions.end());
        for (Vec3& p : positions) p += Vec3(10, 12, 2);
        std::swap(positions[0], positions[first]);
        Array<Triangle> triangles(cube.triangles.begin(), cube.triangles.end());
        for (Triangle& t : triangles)
            for (u32& v : t) v = v == 0 ? first : v == first ? 0 : v;
        cube.positions = std::move(positions);
        cube.triangles = std::move(triangles);
        const double expected = test::signed_volume(block) + 8;
        EXPECT_NEAR(volume_after(joined({block, cube})), expected, 1e-9) << first;
        EXPECT_NEAR(volume_after(joined({block, reversed(cube)})), expected, 1e-9) << first;
        EXPECT_NEAR(volume_after(joined({cube, cube})), 16, 1e-9) << "coincident";
    }
}

TEST(FaceOutwards, OpenAndUnorientedComponentsStay) {
    Execution execution;
    TriangleMesh open = test::without_triangles(reversed(test::geodesic_sphere(1, 4)), {0});
    EXPECT_EQ(face_outwards(open, execution), 0u);
    TriangleMesh mixed = test::cube();
    Array<Triangle> triangles(mixed.triangles.begin(), mixed.triangles.end());
    std::swap(triangles[0][1], triangles[0][2]);
    mixed.triangles = std::move(triangles);
    EXPECT_EQ(face_outwards(mixed, execution), 0u);
    TriangleMesh nothing;
    EXPECT_EQ(face_outwards(nothing, execution), 0u);
}

TEST(FaceOutwards, FlatComponentHasNoOutside) {
    Execution execution;
    TriangleMesh flat;
    flat.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    flat.triangles = {Triangle{0, 1, 2}, Triangle{0, 2, 1}};
    EXPECT_EQ(face_outwards(flat, execution), 0u);
}

TEST(FaceOutwards, NormalsTurnWithTheTriangles) {
    Execution execution;
    TriangleMesh mesh = reversed(test::regular_tetrahedron());
    Array<float> normals, corners;
    for (const Vec3& p : mesh.positions)
        for (const double number : p) normals.push_back(static_cast<float>(-number));
    for (int t = 0; t < 4; ++t)
        for (int i = 0; i < 9; ++i) corners.push_back(static_cast<float>(i));
    mesh.vertex_columns.add(Column("normal", 3, Buffer<float>(std::move(normals))));
    mesh.face_columns.add(Column("corner-normals", 9, Buffer<float>(std::move(corners))));
    EXPECT_EQ(face_outwards(mesh, execution), 4u);
    for (u32 v = 0; v < 4; ++v)
        for (u32 axis = 0; axis < 3; ++axis)
            EXPECT_EQ(mesh.vertex_columns.find("normal")->number(v, axis),
                      static_cast<float>(mesh.positions[v][static_cast<int>(axis)]));
    const Column& turned = *mesh.face_columns.find("corner-normals");
    const double expected[] = {0, -1, -2, -6, -7, -8, -3, -4, -5};
    for (u32 i = 0; i < 9; ++i) EXPECT_EQ(turned.number(0, i), expected[i]);
}

}  // namespace
}  // namespace scanmill
