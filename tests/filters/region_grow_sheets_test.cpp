// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets that bend, and sheets beside each other.
#include <gmock/gmock.h>

#include "filters/region_grow_cases.hpp"

namespace scanmill {
namespace {

using namespace test;

/// A floor of step 1 and, along its side x = 0, a wall of so many rows.
PointCloud sheet_with_wall(u32 floor_rows, u32 along, u32 wall_rows) {
    std::vector<Vec3> points;
    for (u32 y = 0; y < along; ++y) {
        for (u32 x = 0; x < floor_rows; ++x) points.push_back(Vec3(x, y, 0));
        for (u32 z = 1; z <= wall_rows; ++z) points.push_back(Vec3(0, y, z));
    }
    return cloud_from(std::move(points));
}

TEST(RegionGrow_OpenSheets, ThatBendHaveNoPatchEdge) {
    for (const PointCloud& sheet :
         {sheet_with_wall(15, 20, 15), sheet_with_wall(30, 30, 1), sheet_with_wall(30, 30, 2)})
        for (const double angle : {0.0, 0.7}) {
            const RegionGrowResult result = grown(rotated(sheet, angle));
            expect_consistent(result);
            EXPECT_EQ(result.components, 1u);
            EXPECT_EQ(result.loops, 1u);
            EXPECT_EQ(result.patch_edges, 0u);
        }
}

TEST(RegionGrow_TwoSheets, AreNotBridgedThreeBinsApart) {
    // A grid of step 1 is as dense as what bins of 1.25 leave.
    std::vector<Vec3> points;
    for (const Vec3& p : grid(20, 20).positions) {
        points.push_back(p);
        points.push_back(p + Vec3(0, 0, 3.75));
    }
    const RegionGrowResult result = grown(cloud_from(std::move(points)));
    expect_consistent(result);
    EXPECT_EQ(result.components, 2u);
    EXPECT_EQ(result.loops, 2u);
    for (const Triangle& t : result.mesh.triangles) {
        EXPECT_EQ(result.mesh.positions[t[0]].z(), result.mesh.positions[t[1]].z());
        EXPECT_EQ(result.mesh.positions[t[0]].z(), result.mesh.positions[t[2]].z());
    }
}

}  // namespace
}  // namespace scanmill
