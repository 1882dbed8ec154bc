// SPDX-License-Identifier: GPL-3.0-or-later
/// Views that lie in one frame are not doubted, whether or not they overlap; views of one object that do not are.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "filters/merge/cases.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

const std::vector<Vec3> six_directions{Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
                                       -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};

PointCloud cloud_of(Array<Vec3> positions) {
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

/// Random points on a body without symmetry, seen from a direction, with noise.
PointCloud view_of_body(const Vec3& direction, u64 seed, double noise = 0.003, std::size_t points = 4000) {
    Random random(seed);
    Array<Vec3> positions;
    while (positions.size() < points) {
        const Vec3 d = Vec3(random.normal(), random.normal(), random.normal()).normalized();
        if (d.dot(direction) < 0.2) continue;
        const double radius = 1 + 0.25 * std::sin(4 * d.x() + 1) * std::cos(3 * d.y()) + 0.15 * std::sin(5 * d.z()) +
                              noise * random.normal();
        positions.push_back(radius * d);
    }
    return cloud_of(std::move(positions));
}

Clouds views_of_body() {
    Clouds views;
    for (const Vec3& direction : six_directions) views.push_back(view_of_body(direction, views.size()));
    return views;
}

PointCloud turned(const PointCloud& cloud, const Eigen::Matrix3d& rotation) {
    Array<Vec3> positions;
    for (const Vec3& p : cloud.positions) positions.push_back(rotation * p);
    return cloud_of(std::move(positions));
}

/// As a scanner sees them that always looks along -z.
Clouds in_their_own_frames(const Clouds& views) {
    Clouds result;
    for (std::size_t i = 0; i < views.size(); ++i)
        result.push_back(
            turned(views[i], Eigen::Quaterniond::FromTwoVectors(six_directions[i], Vec3::UnitZ()).toRotationMatrix()));
    return result;
}

/// 4,000 random points of the unit square at `height` over the plane perpendicular to `axis`.
PointCloud square(int axis, double height, u64 seed) {
    Random random(seed);
    Array<Vec3> positions(4000);
    for (Vec3& p : positions) {
        p = Vec3(random.uniform(), random.uniform(), random.uniform());
        p[axis] = height;
    }
    return cloud_of(std::move(positions));
}

TEST(MergeOneFrame, ViewsInOneFrame_AreNotDoubted) { EXPECT_THAT(merged(views_of_body()).doubts, IsEmpty()); }

TEST(MergeOneFrame, ViewsInTheirOwnFrames_AreDoubtfulWithTheWorstPairs) {
    const Clouds views = in_their_own_frames(views_of_body());
    const Merged found = merged(views);
    ASSERT_EQ(found.doubts.size(), 1u);
    EXPECT_THAT(found.doubts[0].text, AllOf(HasSubstr("of 6 views do not lie in one frame"), HasSubstr("inputs"),
                                            HasSubstr("give the poses")));
    EXPECT_EQ(found.points.size(), 24'000u) << "the result itself is not changed";
    const Merged with_poses = merged(views, posed(std::vector<RigidTransform>(6)));
    ASSERT_EQ(with_poses.doubts.size(), 1u);
    EXPECT_THAT(with_poses.doubts[0].text, HasSubstr("check the poses"));
    const Merged again = merged(views, {}, 2);
    ASSERT_EQ(again.doubts.size(), 1u);
    EXPECT_EQ(again.doubts[0].text, found.doubts[0].text) << "for any number of threads";
}

TEST(MergeOneFrame, ViewsOfManyPoints_AreJudgedAlike) {
    Clouds views;
    for (const Vec3& direction : six_directions) views.push_back(view_of_body(direction, views.size(), 0.003, 12'000));
    EXPECT_THAT(merged(views).doubts, IsEmpty());
    EXPECT_EQ(merged(in_their_own_frames(views)).doubts.size(), 1u);
}

TEST(MergeOneFrame, OneViewThatIsTurned_IsTheOneThatIsCounted) {
    Clouds views = views_of_body();
    views[2] = turned(views[2], Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitZ()).toRotationMatrix());
    const Merged found = merged(views);
    ASSERT_EQ(found.doubts.size(), 1u);
    EXPECT_THAT(found.doubts[0].text, HasSubstr("1 of 6 views"));
}

TEST(MergeOneFrame, ViewsThatDoNotOverlap_AreNotDoubted) {
    for (const double thickness : {0.01, 0.1, 1.0})
        EXPECT_THAT(merged({square(2, 0, 1), square(2, thickness, 2)}).doubts, IsEmpty())
            << "both sides of a plate, " << thickness;
    Clouds cube;
    for (int axis = 0; axis < 3; ++axis)
        for (const double height : {0.0, 1.0}) cube.push_back(square(axis, height, cube.size()));
    EXPECT_THAT(merged(cube).doubts, IsEmpty()) << "six sides that meet at their borders";
    EXPECT_THAT(merged({square(2, 0, 1), turned(square(2, 100, 2), Eigen::Matrix3d::Identity())}).doubts, IsEmpty());
}

TEST(MergeOneFrame, SurfacesThatCross_AreDoubtful) {
    // Two squares that cross in their middles.
    PointCloud upright = square(0, 0.5, 2);
    Array<Vec3> lower(upright.positions.begin(), upright.positions.end());
    for (Vec3& p : lower) p.z() -= 0.5;
    const Merged found = merged({square(2, 0, 1), cloud_of(std::move(lower))});
    ASSERT_EQ(found.doubts.size(), 1u);
    EXPECT_THAT(found.doubts[0].text, AllOf(HasSubstr("2 of 2 views"), HasSubstr("0 with 1")));
}

TEST(MergeOneFrame, FewPoints_ProveNothing) {
    Clouds views;
    for (const PointCloud& view : in_their_own_frames(views_of_body()))
        views.push_back(cloud_of(Array<Vec3>(view.positions.begin(), view.positions.begin() + 20)));
    EXPECT_THAT(merged(views).doubts, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
