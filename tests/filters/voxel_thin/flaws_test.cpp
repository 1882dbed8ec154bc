// SPDX-License-Identifier: GPL-3.0-or-later
/// Derived voxel sizes on imperfect scans: duplicates, uneven density, noise, distant scan lines.
#include <gmock/gmock.h>

#include <numeric>

#include "filters/voxel_thin/cases.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::HasSubstr;
using Rule = VoxelThinParams::Rule;
using Guarantee = VoxelThinParams::Guarantee;

TEST(VoxelThinFlaws, Duplicates_ChangeNoSizeAndAreCounted) {
    const PointCloud sphere = random_sphere(5000, 1);
    const VoxelThinResult one = thin(sphere, within(0.02)), two = thin(joined(sphere, sphere), within(0.02));
    EXPECT_EQ(one.bin_size, two.bin_size);
    EXPECT_EQ(one.kept, two.kept) << "the first of each";
    const auto single = column<u32>(one, "stands-for"), twice = column<u32>(two, "stands-for");
    for (std::size_t i = 0; i < single.size(); ++i) ASSERT_EQ(twice[i], 2 * single[i]);
}

TEST(VoxelThinFlaws, HalfOfTheScanAHundredTimesAsDense_GivesTheSameSize) {
    Array<Vec3> points;
    for (const Vec3& p : random_sphere(100'000, 1).positions)
        if (p.x() < 0) points.push_back(p);
    for (const Vec3& p : random_sphere(1000, 2).positions)
        if (p.x() >= 0) points.push_back(p);
    const VoxelThinResult result = thin({{}, std::move(points), {}}, within(0.01));
    EXPECT_NEAR(result.bin_size / size_for(2, 0.01, Guarantee::points), 1, 0.1);
}

/// Noise of a voxel's size looks like curvature. The derived size falls, but not below the closest points.
TEST(VoxelThinFlaws, NoiseOfAVoxel_MakesVoxelsSmaller) {
    const PointCloud clean = random_sphere(20'000, 1);
    const double size = thin(clean, within(0.01)).bin_size;
    Random random(5);
    Array<Vec3> noisy;
    for (const Vec3& p : clean.positions) noisy.push_back(p * (1 + size * random.normal()));
    const PointCloud cloud{{}, std::move(noisy), {}};
    const VoxelThinResult minimum = thin(cloud, within(0.01, Rule::minimum)), quantile = thin(cloud, within(0.01));
    EXPECT_LT(minimum.bin_size, quantile.bin_size);
    EXPECT_LT(quantile.bin_size, size);
    EXPECT_GT(minimum.bin_size, 0);
    EXPECT_EQ(quantile.kept.size() + quantile.removed, cloud.size());
}

TEST(VoxelThinFlaws, MinPointsAndMargin_WorkAsWithAGivenSize) {
    const PointCloud sphere = random_sphere(20'000, 1);
    VoxelThinParams params = within(0.02);
    params.min_points = 4;
    params.margin = 0.01;
    const VoxelThinResult derived = thin(sphere, params);
    EXPECT_GT(derived.noise, 0u);
    params.bin_size = derived.bin_size;
    const VoxelThinResult given = thin(sphere, params);
    EXPECT_EQ(derived.kept, given.kept);
    EXPECT_EQ(derived.noise, given.noise);
    EXPECT_EQ(derived.grid_origin, given.grid_origin);
    for (const u32 count : column<u32>(derived, "stands-for")) EXPECT_GE(count, 4u);
}

TEST(VoxelThinFlaws, DistantScanLines_AreCountedWithAWarning) {
    // Lines 50 spacings apart: 25 neighbours lie on one line. The sphere beside them determines a size.
    Array<Vec3> points;
    for (int line = 0; line < 4; ++line)
        for (int i = 0; i < 200; ++i) points.push_back(Vec3(i * 0.01, line * 0.5, 0));
    const PointCloud cloud = joined({{}, std::move(points), {}}, moved(fibonacci_sphere(3000), 1, {5, 0, 0}));
    Context context;
    const VoxelThinResult result = voxel_thin(cloud, within(0.01), context);
    EXPECT_EQ(context.metrics().find("undetermined")->value, 800);
    ASSERT_EQ(context.warnings().size(), 1u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("800 of 3800 distinct points"));
    EXPECT_NEAR(result.bin_size / size_for(2, 0.01, Guarantee::points), 1, 0.05) << "the lines are ignored";
}

TEST(VoxelThinFlaws, VoxelsAsLargeAsTheScan_AreDoubtful) {
    const PointCloud sphere = moved(fibonacci_sphere(20'000), 1, {10'000, 0, 0});
    PointCloud zeros;
    zeros.positions = Array<Vec3>(300, Vec3::Zero());  // too many to be stray
    VoxelThinParams params;
    params.bin_size = Length(100);  // 1 % of the distance
    Context context;
    EXPECT_LT(voxel_thin(joined(sphere, zeros), params, context).points.size(), 10u);
    EXPECT_THAT(doubts_of(context), testing::ElementsAre(HasSubstr("of 20300 points stay")));
    Context without;
    params.bin_size = Length(0.05);
    voxel_thin(sphere, params, without);
    EXPECT_THAT(doubts_of(without), testing::IsEmpty());
}

TEST(VoxelThinFlaws, APartTinyBesideTheRest_IsDoubtful) {
    const auto doubts_with = [](double radius) {
        VoxelThinParams params;
        params.bin_size = Length(0.02);
        Context context;
        voxel_thin(joined(fibonacci_sphere(8000), moved(fibonacci_sphere(8000), radius, {1.2, 0, 0})), params, context);
        return doubts_of(context);
    };
    EXPECT_THAT(doubts_with(0.01), testing::ElementsAre(testing::ContainsRegex("^50 % of the points are in [48] vox")));
    EXPECT_THAT(doubts_with(0.2), testing::IsEmpty());
}

TEST(VoxelThinFlaws, RealScan_IsThinnedByEveryRule) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/bunny00.off");
    const auto cloud = read_points(path);
    const double diagonal = bounding_box(cloud->positions.span()).diagonal();
    const auto with = [&](Rule rule) { return thin(*cloud, within(0.001 * diagonal, rule), 2); };
    const VoxelThinResult minimum = with(Rule::minimum), quantile = with(Rule::quantile),
                          adaptive = with(Rule::adaptive);
    EXPECT_LT(minimum.bin_size, quantile.bin_size);
    EXPECT_GT(minimum.kept.size(), quantile.kept.size());
    EXPECT_LT(adaptive.kept.size(), quantile.kept.size());
    for (const VoxelThinResult* result : {&minimum, &quantile, &adaptive}) {
        const auto stands_for = column<u32>(*result, "stands-for");
        EXPECT_EQ(std::accumulate(stands_for.begin(), stands_for.end(), std::size_t(0)), cloud->size());
    }
}

}  // namespace
}  // namespace scanmill::test
