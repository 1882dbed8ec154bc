// SPDX-License-Identifier: GPL-3.0-or-later
/// Columns of thinned points, and the column `bin-size`.
#include <gmock/gmock.h>

#include <limits>

#include "filters/voxel_thin/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(VoxelThinColumns, Columns_AreCarriedWithTheirRows) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {0.5, 0.5, 0.5}, {7, 7, 7}});
    cloud.frame = {LengthUnit::millimetre, Vec3(100, 0, 0), "part"};
    cloud.columns.add(Column("weight", 1, Buffer<float>{1.f, 2.f, 3.f}));
    cloud.columns.add(Column("colour", 3, Buffer<u8>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    const VoxelThinResult result = thin(cloud, voxels_of(1));
    EXPECT_EQ(result.points.frame, cloud.frame);
    EXPECT_THAT(result.points.columns.find("weight")->values<float>(), ElementsAre(2.f, 3.f));
    EXPECT_THAT(result.points.columns.find("colour")->values<u8>(), ElementsAre(4, 5, 6, 7, 8, 9));
}

TEST(VoxelThinColumns, BinSize_IsAColumnOfEveryKeptPoint) {
    const VoxelThinResult once = thin(cloud_of({{0, 0, 0}, {0.5, 0.5, 0.5}, {7, 7, 7}}), voxels_of(0.7));
    EXPECT_THAT(column<double>(once, "bin-size"), ElementsAre(0.7, 0.7));
    // Thinning again replaces the column, with a warning.
    Context context;
    const VoxelThinResult twice = voxel_thin(once.points, voxels_of(3.5), context);
    EXPECT_THAT(column<double>(twice, "bin-size"), ElementsAre(3.5, 3.5));
    EXPECT_EQ(twice.points.columns.size(), 1u);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("'bin-size'")));
}

TEST(VoxelThinColumns, BinSize_OfEarlierLargerVoxelsStays) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {5, 5, 5}, {7, 7, 7}});
    cloud.columns.add(Column("bin-size", 1, Buffer<float>{2.f, 1.f, 4.f}));
    Context context;
    const VoxelThinResult again = voxel_thin(cloud, voxels_of(1.5), context);
    EXPECT_THAT(column<double>(again, "bin-size"), ElementsAre(2, 1.5, 4));
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("2 of 3 kept points were thinned with larger voxels before"),
                                                HasSubstr("is replaced")));
    Context one;
    voxel_thin(again.points, voxels_of(3), one);
    EXPECT_THAT(one.warnings(), Contains(HasSubstr("1 of 3 kept points was thinned with larger voxels before; its")));
    // A column with a single invalid size is ignored.
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double invalid : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
        PointCloud other = cloud_of({{0, 0, 0}, {5, 5, 5}, {7, 7, 7}});
        other.columns.add(Column("bin-size", 1, Buffer<double>{2, invalid, 4}));
        EXPECT_THAT(column<double>(thin(other, voxels_of(1.5)), "bin-size"), Each(1.5)) << invalid;
    }
}

TEST(VoxelThinColumns, BinSize_IsADerivedSizeToo) {
    const VoxelThinResult result = thin(random_sphere(20'000, 1), within(0.02));
    EXPECT_THAT(column<double>(result, "bin-size"), Each(result.bin_size));
}

}  // namespace
}  // namespace scanmill::test
