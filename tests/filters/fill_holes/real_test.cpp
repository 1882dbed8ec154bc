// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "filters/fill_holes/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST(FillHolesReal, TheBunny_IsWatertight) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/bun_zipper.ply");
    const TriangleMesh mesh = *read_mesh(path);
    const Filled result = filled(mesh, {}, 2);
    EXPECT_EQ(result.filled, 5u);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(topology(result.mesh).genus, 0);
    EXPECT_EQ(intersecting_fillings(mesh, result.mesh), 0u);
    EXPECT_TRUE(result.doubts.empty());
}

TEST(FillHolesReal, AFaceMask_IsClosedAtItsHolesAndDoubtfulAtItsOutline) {
    SCANMILL_REAL_SCAN(path, shared_data, "4-open/holes.off");
    const TriangleMesh mesh = *read_mesh(path);
    const Filled result = filled(mesh, every_loop(), 2);
    EXPECT_EQ(result.filled + result.failed, 7u);
    EXPECT_GE(result.filled, 6u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("longer than the diagonal")));
    EXPECT_EQ(intersecting_fillings(mesh, result.mesh), 0u);
    FillHolesParams params = every_loop();
    params.max_edges = 100;
    const Filled small = filled(mesh, params);
    EXPECT_EQ(small.beyond_limits, 1u);
    EXPECT_THAT(small.doubts, Not(Contains(HasSubstr("longer"))));
    const Filled open = filled(mesh);
    EXPECT_EQ(open.outer, 5u) << "the outline and four openings stay; two with less than 2 % of the area are filled";
    EXPECT_EQ(open.filled, 2u);
    EXPECT_TRUE(open.doubts.empty());
}

}  // namespace
}  // namespace scanmill::test
