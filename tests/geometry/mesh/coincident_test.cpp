// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/coincident.hpp"

#include <gmock/gmock.h>

#include "scanmill/data/half_edges.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;

TEST(Coincident, LowestAtPosition_IsExact) {
    const Array<Vec3> positions{{1, 0, 0}, {0, 0, 0}, {1, 1e-300, 0}, {-0.0, 0, 0}, {1, 0, 0}};
    EXPECT_THAT(lowest_at_position(positions), ElementsAre(0, 1, 2, 1, 0));
}

TEST(Coincident, Edges_OfTwoTrianglesThatAreCut) {
    // A square of two triangles without common vertices, and a third triangle that touches it in a corner.
    TriangleMesh mesh;
    mesh.positions =
        Array<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {1, 2, 0}};
    mesh.triangles = Array<Triangle>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    std::vector<u32> boundary;
    for (u32 half = 0; half < 9; ++half) boundary.push_back(half);
    const std::vector<u32> cut = coincident_edges(mesh, boundary);
    ASSERT_EQ(cut.size(), 2u);
    EXPECT_EQ(half_edges::start(mesh, cut[0]), 1u);
    EXPECT_EQ(half_edges::end(mesh, cut[0]), 2u);
    EXPECT_EQ(half_edges::start(mesh, cut[1]), 5u);
    EXPECT_EQ(half_edges::end(mesh, cut[1]), 3u);
    EXPECT_TRUE(coincident_edges(mesh, {}).empty());
}

}  // namespace
}  // namespace scanmill
