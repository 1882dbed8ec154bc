// SPDX-License-Identifier: GPL-3.0-or-later
/// Boxes and balls: cases by hand, borders, laws.

#include <gmock/gmock.h>

#include <cmath>

#include "filters/crop/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"
#include "support/same_points.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

/// With a column of the rows, and others of lists and of several components.
PointCloud numbered(PointCloud cloud) {
    Array<u32> number(cloud.size());
    Array<float> normal(3 * cloud.size());
    for (u32 row = 0; row < number.size(); ++row) {
        number[row] = row;
        normal[3 * row + 1] = static_cast<float>(row);
    }
    cloud.columns.add(Column("number", 1, Buffer<u32>(std::move(number))));
    cloud.columns.add(Column("normal", 3, Buffer<float>(std::move(normal))));
    return cloud;
}

TEST(Crop, Box_KeepsThePointsInItInOrder) {
    const PointCloud cloud = cloud_of({{5, 5, 5}, {-1, 5, 5}, {1, 2, 3}, {5, 11, 5}, {9, 9, 9}, {5, 5, 20}});
    const Cropped result = cropped(cloud, in_box({0, 0, 0}, {10, 10, 10}));
    EXPECT_THAT(rows(result), ElementsAre(0u, 2u, 4u));
    EXPECT_THAT(result.points.positions.span(), ElementsAre(Vec3(5, 5, 5), Vec3(1, 2, 3), Vec3(9, 9, 9)));
    EXPECT_EQ(result.removed, 3u);
    EXPECT_EQ(result.metrics.find("kept")->value, 3);
    EXPECT_EQ(result.metrics.find("removed")->value, 3);
}

TEST(Crop, Box_KeepsPointsOnItsBorder) {
    const double beyond = std::nextafter(10.0, 11.0), before = std::nextafter(-2.0, -3.0);
    const PointCloud cloud = cloud_of({{10, 0, 0}, {-2, 3, 4}, {10, 10, 10}, {beyond, 0, 0}, {0, before, 0}});
    EXPECT_THAT(rows(cropped(cloud, in_box({-2, -2, -2}, {10, 10, 10}))), ElementsAre(0u, 1u, 2u));
    EXPECT_THAT(rows(cropped(cloud, in_box({10, 10, 10}, {10, 10, 10}))), ElementsAre(2u)) << "a box of one point";
}

TEST(Crop, Ball_KeepsPointsOnItsBorder) {
    // 3-4-5 and 2-3-6-7 triangles: the distances from (1, 1, 1) are 5, 5, 7 and a little more than 5.
    const PointCloud cloud = cloud_of({{4, 5, 1}, {1, -2, 5}, {3, 4, 7}, {1, 1, 6.000001}, {1, 1, 1}});
    EXPECT_THAT(rows(cropped(cloud, in_ball({1, 1, 1}, 5))), ElementsAre(0u, 1u, 4u));
    EXPECT_THAT(rows(cropped(cloud, in_ball({1, 1, 1}, 7))), ElementsAre(0u, 1u, 2u, 3u, 4u));
    EXPECT_THAT(rows(cropped(cloud, in_ball({1, 1, 1}, 0))), ElementsAre(4u));
}

TEST(Crop, Coordinates_AreThoseOfTheFile) {
    PointCloud cloud = cloud_of({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
    cloud.frame.origin = {4e6, 5e6, 0};
    EXPECT_THAT(rows(cropped(cloud, in_box({4e6 + 2, 5e6, 0}, {4e6 + 9, 5e6, 0}))), ElementsAre(1u, 2u));
    const Cropped ball = cropped(cloud, in_ball({4e6 + 1, 5e6, 0}, 1));
    EXPECT_THAT(rows(ball), ElementsAre(0u, 1u));
    EXPECT_EQ(ball.points.frame, cloud.frame);
    EXPECT_EQ(ball.points.positions[1], Vec3(2, 0, 0));
}

TEST(Crop, EveryColumn_IsCarried) {
    PointCloud cloud = numbered(random_cube(1000, 3));
    cloud.frame = {LengthUnit::millimetre, {0, 0, 0}, "part"};
    const Cropped result = cropped(cloud, in_box({0, 0, 0}, {0.5, 1, 1}));
    EXPECT_TRUE(same_points(result.points, gather(cloud, result.kept)));
    EXPECT_EQ(result.points.columns.size(), 2u);
    EXPECT_EQ(result.points.columns.find("number")->values<u32>()[7], result.kept[7]);
}

TEST(Crop, RegionsAroundEverything_ChangeNothing) {
    const PointCloud cloud = numbered(random_sphere(2000, 5));
    EXPECT_TRUE(same_points(cropped(cloud, in_box({-1, -1, -1}, {1, 1, 1})).points, cloud));
    EXPECT_TRUE(same_points(cropped(cloud, in_ball({0, 0, 0}, 1.001)).points, cloud));
}

TEST(Crop, Box_AndItsComplement_AreTheCloud) {
    // Six boxes around a box: no point is in none, and none in two, as none lies on a border.
    const PointCloud cloud = random_cube(20'000, 7);
    const Vec3 low(0.31, 0.22, 0.43), high(0.74, 0.65, 0.86);
    std::vector<u32> all = rows(cropped(cloud, in_box(low, high)));
    const std::size_t inner = all.size();
    Vec3 least(-1, -1, -1), most(2, 2, 2);
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 below = most, above = least;
        below[axis] = low[axis];
        above[axis] = high[axis];
        for (const CropParams& beside : {in_box(least, below), in_box(above, most)})
            for (const u32 row : rows(cropped(cloud, beside))) all.push_back(row);
        least[axis] = low[axis];
        most[axis] = high[axis];
    }
    EXPECT_NEAR(static_cast<double>(inner), 20'000 * 0.43 * 0.43 * 0.43, 150);
    std::ranges::sort(all);
    ASSERT_EQ(all.size(), cloud.size());
    for (u32 row = 0; row < all.size(); ++row) ASSERT_EQ(all[row], row);
}

TEST(Crop, Twice_IsTheIntersection) {
    const PointCloud cloud = random_cube(20'000, 8);
    const CropParams box = in_box({0.2, 0.2, 0.2}, {0.9, 0.7, 0.9}), ball = in_ball({0.5, 0.5, 0.5}, 0.4);
    const PointCloud one = cropped(cropped(cloud, box).points, ball).points;
    const PointCloud other = cropped(cropped(cloud, ball).points, box).points;
    EXPECT_TRUE(same_points(one, other));
    EXPECT_GT(one.size(), 1000u);
    EXPECT_TRUE(same_points(cropped(one, box).points, one));
}

TEST(Crop, AnyNumberOfThreads_GivesTheSame) {
    const PointCloud cloud = numbered(random_cube(200'000, 9));
    for (const CropParams& params : {in_box({0.1, 0.2, 0.3}, {0.6, 0.7, 0.8}), in_ball({0.4, 0.4, 0.4}, 0.3)}) {
        const Cropped one = cropped(cloud, params, 1), three = cropped(cloud, params, 3);
        EXPECT_TRUE(same_points(one.points, three.points));
        EXPECT_EQ(one.metrics.values, three.metrics.values);
        EXPECT_GT(one.removed, 100'000u);
    }
}

TEST(Crop, Cancelled_Ends) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(crop(random_cube(1000, 1), in_box({0, 0, 0}, {1, 1, 1}), context), Cancelled);
}

TEST(Crop, Progress_RisesToOne) {
    ContextOptions options;
    std::vector<double> fractions;
    options.on_progress = [&](double fraction) { fractions.push_back(fraction); };
    Context context(options);
    crop(random_cube(100'000, 1), in_box({0, 0, 0}, {1, 1, 1}), context);
    EXPECT_GT(fractions.size(), 3u);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1);
}

TEST(Crop, RealScan_BoxOfItsLeftHalfAndOfItsRightHalf) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/bun_zipper.ply");
    const PointCloud cloud = points_of(*read_mesh(path));
    const BoundingBox box = bounding_box(cloud.positions.span());
    const Vec3 low = cloud.frame.origin + box.low, high = cloud.frame.origin + box.high;
    // Between two floats, as the file has floats: no point is on the border.
    const double middle = std::nextafter(static_cast<double>(static_cast<float>((low.x() + high.x()) / 2)), 1.0);
    const Cropped left = cropped(cloud, in_box(low, {middle, high.y(), high.z()}));
    const Cropped right = cropped(cloud, in_box({middle, low.y(), low.z()}, high));
    EXPECT_EQ(left.kept.size() + right.kept.size(), cloud.size());
    EXPECT_EQ(left.removed, right.kept.size());
    EXPECT_LT(bounding_box(left.points.positions.span()).high.x(), bounding_box(right.points.positions.span()).low.x());
}

}  // namespace
}  // namespace scanmill::test
