// SPDX-License-Identifier: GPL-3.0-or-later
// What holds of whatever points.
#include <gmock/gmock.h>

#include "filters/region_grow_cases.hpp"

namespace scanmill {
namespace {

using namespace test;

class RegionGrowOfAnything : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RegionGrowOfAnything, IsAManifoldAndCountsEveryPoint) {
    const std::uint64_t seed = GetParam();
    PointCloud flat = flat_square(0.02);
    for (const PointCloud& cloud : {random_cube(300, seed), random_sphere(400, seed), shuffled(flat, seed),
                                    joined(random_sphere(200, seed), flat), lattice_cube(5),
                                    l_block_surface(4, 1, 4, 0.02, seed), fibonacci_sphere(500, 0.05, seed)}) {
        for (const auto score : {RegionGrowParams::Score::circumradius, RegionGrowParams::Score::midpoint}) {
            RegionGrowParams params;
            params.score = score;
            params.close_holes = static_cast<u32>(seed % 3) * 5;
            params.max_normal_angle = Angle::degrees(60 + 30 * static_cast<double>(seed % 5));
            const RegionGrowResult result = grown(cloud, params);
            expect_consistent(result);
            // Counted again: every row is a vertex, repeats an earlier row, or is the first of a place without one.
            std::set<std::array<double, 3>> places, used;
            for (const Vec3& p : cloud.positions) places.insert({p.x(), p.y(), p.z()});
            for (const u32 row : result.rows) {
                const Vec3& p = cloud.positions[row];
                used.insert({p.x(), p.y(), p.z()});
            }
            EXPECT_EQ(result.duplicates, cloud.size() - places.size());
            EXPECT_EQ(result.unused_points, places.size() - used.size());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RegionGrowOfAnything, testing::Range<std::uint64_t>(1, 13));

}  // namespace
}  // namespace scanmill
