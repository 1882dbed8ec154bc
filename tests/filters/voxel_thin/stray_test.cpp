// SPDX-License-Identifier: GPL-3.0-or-later
// Stray points change neither the grid nor the voxel size of the others.
#include <gmock/gmock.h>

#include "filters/voxel_thin/cases.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/kinds/length_scale.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::HasSubstr;

PointCloud with_point(const PointCloud& cloud, const Vec3& point) {
    Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
    positions.push_back(point);
    PointCloud more;
    more.frame = cloud.frame;
    more.positions = std::move(positions);
    return more;
}

/// The default parameters, or another rule, as the engine resolves them.
VoxelThinParams defaults_for(const PointCloud& cloud) {
    VoxelThinParams params;
    params.tolerance = params.tolerance.resolved(length_scale(std::make_shared<const PointCloud>(cloud)));
    return params;
}

/// Everything that is kept without the stray point, and that point.
void expect_only_the_stray_point_more(const PointCloud& cloud, const Vec3& stray, const VoxelThinResult& without,
                                      const VoxelThinResult& with) {
    EXPECT_EQ(with.bin_size, without.bin_size);
    std::vector<u32> expected(without.kept.begin(), without.kept.end());
    expected.push_back(static_cast<u32>(cloud.size()));
    EXPECT_EQ(std::vector<u32>(with.kept.begin(), with.kept.end()), expected);
    EXPECT_EQ(with.points.positions[with.points.size() - 1], stray);
}

TEST(VoxelThinStray, SphereWithOneFarPoint_KeepsTheSamePointsAtDefaults) {
    const PointCloud sphere = random_sphere(50'000, 1, 5);
    for (const Vec3& stray : {Vec3(300, 0, 0), Vec3(-300, 20, -1), Vec3(0, 0, -300)}) {
        const PointCloud scan = with_point(sphere, stray);
        const VoxelThinResult without = thin(sphere, defaults_for(sphere)), with = thin(scan, defaults_for(scan));
        expect_only_the_stray_point_more(sphere, stray, without, with);
    }
}

TEST(VoxelThinStray, EveryRule_KeepsTheObject) {
    const PointCloud sphere = random_sphere(20'000, 2, 5);
    const PointCloud scan = with_point(sphere, Vec3(-300, 0, 0));
    for (const auto rule : {VoxelThinParams::Rule::minimum, VoxelThinParams::Rule::adaptive}) {
        VoxelThinParams params = defaults_for(sphere), same = defaults_for(scan);
        params.rule = same.rule = rule;
        const VoxelThinResult without = thin(sphere, params), with = thin(scan, same);
        EXPECT_EQ(with.bin_size, without.bin_size);
        EXPECT_EQ(with.points.size(), without.points.size() + 1);
    }
}

TEST(VoxelThinStray, RowOfZerosInASurveyedScan_KeepsTheSamePoints) {
    // As a scan at (500000, 4500000, 300) is stored, with its origin near it.
    const PointCloud scan = moved(random_sphere(50'000, 3), 50);
    const Vec3 zero(-500'000, -4'500'000, -300);
    VoxelThinParams params;
    for (const double edge : {3.0, 0.3}) {
        params.bin_size = edge;
        expect_only_the_stray_point_more(scan, zero, thin(scan, params), thin(with_point(scan, zero), params));
    }
}

TEST(VoxelThinStray, StrayPointBeyondTheNumbersOfVoxels_IsRefusedWithAWayOut) {
    const PointCloud scan = with_point(random_cube(1000, 4), Vec3(4e8, 0, 0));
    VoxelThinParams params;
    params.bin_size = 0.1;
    Context context;
    try {
        voxel_thin(scan, params, context);
        FAIL() << "no refusal";
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), HasSubstr("a stray point lies 4e+09 voxels of 0.1 u away"));
        EXPECT_THAT(error.hint(), HasSubstr("remove the stray points"));
    }
}

}  // namespace
}  // namespace scanmill::test
