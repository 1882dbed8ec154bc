// SPDX-License-Identifier: GPL-3.0-or-later
/// Loops that must stay open although holes near them are closed.
#include <gtest/gtest.h>

#include "filters/region_grow/cases.hpp"
#include "scanmill/base/random.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill {
namespace {

using namespace test;

constexpr double degree = std::numbers::pi / 180;

/// Two planes of step 1 that meet in a crease of `angle` degrees, which fades out towards both of its ends.
PointCloud fading_crease(double angle) {
    std::vector<Vec3> points;
    for (int across = -10; across <= 10; ++across)
        for (int y = -20; y <= 20; ++y) {
            const double half = angle / 2 * degree * std::cos(std::numbers::pi * y / 40);
            points.push_back(Vec3(across * std::cos(half), y, -std::abs(across) * std::sin(half)));
        }
    return cloud_from(std::move(points));
}

TEST(RegionGrow_CreasesThatFadeOut, ArePatchEdgesWhateverIsClosed) {
    for (const double angle : {70.0, 90.0, 100.0, 110.0, 120.0, 130.0}) {
        SCOPED_TRACE(angle);
        RegionGrowParams params = with_max_normal_angle(60);
        params.search_radius = Length(2 * std::numbers::sqrt3);
        const RegionGrowResult result = grown(fading_crease(angle), params);
        expect_consistent(result);
        params.close_holes = 0;
        const RegionGrowResult open = grown(fading_crease(angle), params);
        EXPECT_EQ(result.loops, angle > 80 ? 2u : 1u);
        EXPECT_EQ(result.patch_edges > 0, angle > 80);
        EXPECT_EQ(result.patch_edges, open.patch_edges);
        EXPECT_EQ(result.mesh.triangles.size(), open.mesh.triangles.size());
    }
}

TEST(RegionGrow_OpenPocket, StaysOpenThoughNarrow) {
    // 30 x 2.5 x 10: no circle as large as a hole fits into its opening.
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        Random random(seed);
        std::vector<Vec3> points;
        const Vec3 size(30, 2.5, 10);
        const double sides = size.x() * size.z(), ends = size.y() * size.z(), floor = size.x() * size.y();
        for (int i = 0; i < 60'000; ++i) {
            Vec3 p(random.uniform(0, size.x()), random.uniform(0, size.y()), random.uniform(0, size.z()));
            const double face = random.uniform(0, 2 * sides + 2 * ends + floor);
            if (face < 2 * sides)
                p.y() = face < sides ? 0 : size.y();
            else if (face < 2 * sides + 2 * ends)
                p.x() = face < 2 * sides + ends ? 0 : size.x();
            else
                p.z() = 0;
            points.push_back(p + Vec3(0.3, 0.2, 0.1));
        }
        VoxelThinParams params;
        params.bin_size = Length(1);
        Context context;
        const RegionGrowResult result = grown(voxel_thin(cloud_from(std::move(points)), params, context).points);
        expect_consistent(result);
        EXPECT_EQ(result.components, 1u) << seed;
        EXPECT_EQ(result.loops, 1u) << seed;
        EXPECT_EQ(topology(result.mesh).euler, 1) << seed;
    }
}

}  // namespace
}  // namespace scanmill
