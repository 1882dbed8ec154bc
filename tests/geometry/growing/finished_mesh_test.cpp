// SPDX-License-Identifier: GPL-3.0-or-later
/// Vertices in the order of the cloud, triangles in that of their creation.
#include <gmock/gmock.h>

#include "geometry/growing/patch.hpp"
#include "scanmill/geometry/growing/finished_mesh.hpp"

namespace scanmill::growing {
namespace {

using testing::ElementsAre;

TEST(FinishedMesh, HasTheUsedPointsInInputOrderWithTheirColumns) {
    // Row 2 is in no triangle, row 4 repeats row 1.
    const std::vector<Vec3> positions{Vec3(3, 0, 0), Vec3(0, 0, 0), Vec3(9, 9, 9),
                                      Vec3(0, 2, 0), Vec3(0, 0, 0), Vec3(3, 2, 0)};
    PointCloud cloud;
    cloud.positions = Array<Vec3>(positions.begin(), positions.end());
    cloud.frame.origin = Vec3(7, 8, 9);
    Array<double> numbers(6);
    for (std::size_t row = 0; row < 6; ++row) numbers[row] = static_cast<double>(row);
    cloud.columns.add(Column("row", 1, Buffer<double>(std::move(numbers))));
    Patch patch(positions);
    patch.add(5, 3, 0);
    patch.add(3, 1, 0);

    const FinishedMesh finished = finish_mesh(cloud, patch.surface());
    EXPECT_THAT(finished.rows, ElementsAre(0, 1, 3, 5));
    EXPECT_THAT(finished.mesh.positions.span(), ElementsAre(positions[0], positions[1], positions[3], positions[5]));
    EXPECT_THAT(finished.mesh.triangles.span(), ElementsAre(Triangle{0, 3, 2}, Triangle{0, 2, 1}));
    EXPECT_EQ(finished.mesh.frame.origin, cloud.frame.origin);
    const Column* column = finished.mesh.vertex_columns.find("row");
    ASSERT_TRUE(column);
    EXPECT_EQ(column->number(3, 0), 5);
    EXPECT_EQ(finished.mesh.sharp_edges.size(), 0u);
    EXPECT_EQ(finished.vertex_of_point[patch.point(3)], 2u);
    EXPECT_EQ(finished.vertex_of_point[patch.point(2)], invalid_index);
}

}  // namespace
}  // namespace scanmill::growing
