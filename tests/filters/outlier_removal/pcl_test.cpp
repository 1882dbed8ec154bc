// SPDX-License-Identifier: GPL-3.0-or-later
/// With `min-component: 0` outlier-removal removes the same points as PCL, where no point is at the limit.
#ifdef SCANMILL_PCL

#include <gmock/gmock.h>
#include <pcl/filters/radius_outlier_removal.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_types.h>

#include "filters/outlier_removal/cases.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using Point = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Point>;

/// A sphere with outliers; coordinates are floats.
PointCloud dirty_sphere(std::uint64_t seed) {
    std::vector<Vec3> points;
    for (const Vec3& p : with_outliers(random_sphere(3000, seed), 150, 2, seed + 1).positions)
        points.push_back(p.cast<float>().cast<double>());
    return cloud_of_points(points);
}

Cloud::Ptr as_pcl(const PointCloud& cloud) {
    const auto result = pcl::make_shared<Cloud>();
    for (const Vec3& p : cloud.positions)
        result->emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
    return result;
}

template <class Filter>
std::vector<u32> kept_by(Filter& filter, const PointCloud& cloud) {
    filter.setInputCloud(as_pcl(cloud));
    pcl::Indices kept;
    filter.filter(kept);
    return {kept.begin(), kept.end()};
}

TEST(OutlierRemovalPcl, Statistical_KeepsTheSameRows) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        for (const u32 neighbours : {1u, 8u, 16u, 50u})
            for (const double factor : {0.5, 1.0, 3.0}) {
                const PointCloud cloud = dirty_sphere(seed);
                pcl::StatisticalOutlierRemoval<Point> filter;
                filter.setMeanK(static_cast<int>(neighbours));
                filter.setStddevMulThresh(factor);
                const std::vector<u32> expected = kept_by(filter, cloud);
                EXPECT_LT(expected.size(), cloud.size());
                EXPECT_THAT(clean(cloud, suspects_only(neighbours, factor)).kept, testing::ElementsAreArray(expected))
                    << "seed " << seed << ", " << neighbours << " neighbours, factor " << factor;
            }
}

TEST(OutlierRemovalPcl, Radius_KeepsTheSameRows) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        for (const u32 neighbours : {1u, 5u, 12u}) {
            const PointCloud cloud = dirty_sphere(seed);
            pcl::RadiusOutlierRemoval<Point> filter;
            filter.setRadiusSearch(0.15);
            filter.setMinNeighborsInRadius(static_cast<int>(neighbours));
            const std::vector<u32> expected = kept_by(filter, cloud);
            EXPECT_LT(expected.size(), cloud.size());
            EXPECT_THAT(clean(cloud, by_radius(neighbours, 0.15)).kept, testing::ElementsAreArray(expected))
                << "seed " << seed << ", " << neighbours << " neighbours";
        }
}

}  // namespace
}  // namespace scanmill::test

#endif
