// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/boundary_loops.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

/// A unit square at z = 0, left of the y axis, and a rectangle of 1 by 3 that hangs down from it.
TriangleMesh bracket() {
    TriangleMesh mesh;
    mesh.positions = {Vec3(-1, 0, 0), Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(-1, 1, 0), Vec3(0, 0, -3), Vec3(0, 1, -3)};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
    return mesh;
}

TEST(BoundaryLoops, OfABracket_AreOneInTheTrianglesDirection) {
    const TriangleMesh mesh = bracket();
    const auto loops = boundary_loops(mesh, half_edges::opposites(mesh));
    ASSERT_EQ(loops.size(), 1u);
    std::vector<u32> vertices;
    for (const u32 side : loops[0]) vertices.push_back(half_edges::start(mesh, side));
    EXPECT_THAT(vertices, ElementsAre(0, 1, 4, 5, 2, 3));
}

TEST(BoundaryLoops, OfClosedSurfaces_AreNone) {
    const TriangleMesh mesh = torus(3, 1, 12, 8);
    EXPECT_TRUE(boundary_loops(mesh, half_edges::opposites(mesh)).empty());
}

TEST(LoopShape, SeesTheLoopAlongTheMeanNormal_WeightedByTheSides) {
    // Sides of length 3 in all beside the square, normal z; of length 7 beside the rectangle, normal x. The vector area
    // of the loop is (3, 0, 1), seen along (7, 0, 3).
    const TriangleMesh mesh = bracket();
    const Array<u32> opposite = half_edges::opposites(mesh);
    const FacetNormals normals = facet_normals(mesh, opposite, 1);
    const LoopShape shape = loop_shape(mesh, boundary_loops(mesh, opposite)[0], normals.unit);
    EXPECT_EQ(shape.length, 10);
    EXPECT_NEAR(shape.area, (3 * 7 + 1 * 3) / std::sqrt(7 * 7 + 3 * 3), 1e-14);
    EXPECT_TRUE(shape.clear);
}

}  // namespace
}  // namespace scanmill::test
