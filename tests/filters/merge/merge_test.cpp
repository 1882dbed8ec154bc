// SPDX-License-Identifier: GPL-3.0-or-later
/// Positions and frames of merged points. Overlaps, columns and pose files are tested in other files.
#include <gmock/gmock.h>

#include <cmath>

#include "filters/merge/cases.hpp"
#include "support/poses.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Eigen::Matrix3d quarter_turn_about_z() {
    Eigen::Matrix3d rotation;
    rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    return rotation;
}

RigidTransform oblique() {
    RigidTransform pose;
    const Vec3 axis = Vec3(1, -2, 3).normalized();
    Eigen::Matrix3d cross;
    cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
    pose.rotation = Eigen::Matrix3d::Identity() + std::sin(1.1) * cross + (1 - std::cos(1.1)) * cross * cross;
    pose.translation = Vec3(5, -7, 11);
    return pose;
}

PointCloud framed(PointCloud cloud, const Frame& frame) {
    cloud.frame = frame;
    return cloud;
}

Vec3 world(const PointCloud& cloud, std::size_t row) { return cloud.frame.origin + cloud.positions[row]; }

TEST(Merge, TwoClouds_AreConcatenatedWithTheirSource) {
    const Merged result = merged({cloud_of({{0, 0, 0}, {1, 0, 0}}), cloud_of({{1, 0, 0}})});
    EXPECT_THAT(result.points.positions.span(), ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 0)));
    EXPECT_THAT(result.points.columns.find("source")->values<u32>(), ElementsAre(0u, 0u, 1u));
    EXPECT_THAT(result.kept, ElementsAre(0u, 1u, 2u));
    EXPECT_EQ(result.metrics.find("points")->value, 3);
    EXPECT_EQ(result.metrics.find("dropped")->value, 0);
    EXPECT_THAT(result.warnings, IsEmpty());
}

TEST(Merge, OneCloudWithoutPose_ComesBackWithASource) {
    PointCloud cloud = random_sphere(1000, 4);
    cloud.frame = {LengthUnit::millimetre, Vec3(1 << 20, 0, -3), "part"};
    cloud.columns.add(Column("weight", 1, Buffer<double>(Array<double>(1000, 2.5))));
    cloud.positions = Buffer<Vec3>([&] {
        Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
        positions[7] = Vec3(-0.0, 0.0, -0.0);
        return positions;
    }());
    const Merged result = merged({cloud}, within(0.1));
    EXPECT_EQ(result.points.frame, cloud.frame);
    EXPECT_EQ(std::memcmp(result.points.positions.data(), cloud.positions.data(), 1000 * sizeof(Vec3)), 0);
    EXPECT_EQ(*result.points.columns.find("weight"), *cloud.columns.find("weight"));
    EXPECT_EQ(result.points.columns.size(), 2u);
    EXPECT_EQ(result.dropped, 0u);
}

TEST(Merge, CloudsOfDifferentOrigins_AgreeInTheWorld) {
    const PointCloud near = framed(cloud_of({{3, 0, 0}}), {LengthUnit::metre, Vec3(100, 0, 0), ""});
    const PointCloud far = framed(cloud_of({{1, 0, 0}}), {LengthUnit::metre, Vec3(102, 0, 0), ""});
    const Merged result = merged({near, far}, within(0.001));
    EXPECT_EQ(result.points.frame.origin, Vec3(100, 0, 0));
    EXPECT_THAT(result.kept, ElementsAre(0u)) << "both are the world's point 103 0 0";
}

TEST(Merge, Pose_RotatesAndThenMoves) {
    RigidTransform pose{quarter_turn_about_z(), Vec3(10, 20, 30), LengthUnit::unknown, "", ""};
    const Merged result = merged({cloud_of({{1, 2, 3}}), cloud_of({{1, 2, 3}})}, posed({pose, RigidTransform{}}));
    EXPECT_EQ(world(result.points, 0), Vec3(8, 21, 33)) << "1 2 3 is rotated to -2 1 3";
    EXPECT_EQ(world(result.points, 1), Vec3(1, 2, 3));
}

TEST(Merge, Pose_ActsOnWorldCoordinatesOfDistantScans) {
    // World coordinates of a national grid with a millionth of a metre in them, exact as sums of powers of two.
    const double fine = 0x1p-20;
    const PointCloud cloud =
        framed(cloud_of({{fine, 1.5, 0}, {0.25, -1, 2}}), {LengthUnit::metre, Vec3(500'000, 4'900'000, 0), "grid"});
    const RigidTransform pose{quarter_turn_about_z(), Vec3(4'900'000, -500'000, 100), LengthUnit::metre, "", ""};
    const Merged result = merged({cloud}, posed({pose}));
    // (x, y) goes to (4.9e6 - y, x - 5e5).
    EXPECT_EQ(world(result.points, 0), Vec3(-1.5, fine, 100));
    EXPECT_EQ(world(result.points, 1), Vec3(1, 0.25, 102));
}

TEST(Merge, PoseToADistantPosition_LosesNoDigits) {
    const PointCloud local = cloud_of({{1e-9, 0, 0}, {0, 3e-9, 0}, {2, 2, 2}});
    const RigidTransform pose{Eigen::Matrix3d::Identity(), Vec3(500'000, 4'900'000, 0), LengthUnit::unknown, "", ""};
    const Merged result = merged({local}, posed({pose}));
    const auto& p = result.points.positions;
    EXPECT_NEAR((p[0] - p[1]).x(), 1e-9, 1e-15) << "which 500000.000000001 would have rounded away";
    EXPECT_NEAR((p[1] - p[0]).y(), 3e-9, 1e-15);
    EXPECT_LT((world(result.points, 2) - Vec3(500'002, 4'900'002, 2)).norm(), 1e-8);
}

TEST(Merge, PoseAndItsInverse_RestoreTheCloud) {
    const PointCloud cloud = framed(random_sphere(500, 2, 3), {LengthUnit::unknown, Vec3(1000, -2000, 500), ""});
    const PointCloud there = merged({cloud}, posed({oblique()})).points;
    const PointCloud back = merged({there}, posed({inverse_of(oblique())})).points;
    double farthest = 0, moved = 1e9;
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        farthest = std::max(farthest, (world(back, row) - world(cloud, row)).norm());
        moved = std::min(moved, (world(there, row) - world(cloud, row)).norm());
    }
    EXPECT_LT(farthest, 1e-11);
    EXPECT_GT(moved, 1);
}

TEST(Merge, IdentityPoses_MoveNoPoint) {
    const PointCloud cloud = framed(random_cube(500, 2, 3), {LengthUnit::metre, Vec3(1 << 22, 0, 0), "a"});
    const PointCloud result = merged({cloud, cloud}, posed({RigidTransform{}, RigidTransform{}})).points;
    for (std::size_t row = 0; row < cloud.size(); ++row)
        ASSERT_LT((world(result, row) - world(cloud, row)).norm(), 1e-9) << row;
}

TEST(Merge, Normals_RotateWithTheirPoseAndKeepTheirType) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {1, 0, 0}});
    cloud.columns.add(Column("normal", 3, Buffer<float>{1, 0, 0, 0, 0, 1}));
    cloud.columns.add(Column("direction", 3, Buffer<float>{1, 0, 0, 0, 0, 1}));
    const RigidTransform pose{quarter_turn_about_z(), Vec3(9, 9, 9), LengthUnit::unknown, "", ""};
    const Merged result = merged({cloud}, posed({pose}));
    EXPECT_THAT(result.points.columns.find("normal")->values<float>(), ElementsAre(0, 1, 0, 0, 0, 1));
    EXPECT_THAT(result.points.columns.find("direction")->values<float>(), ElementsAre(1, 0, 0, 0, 0, 1))
        << "only `normal` is known to be a direction";
    EXPECT_THAT(merged({cloud}).points.columns.find("normal")->values<float>(), ElementsAre(1, 0, 0, 0, 0, 1));
}

TEST(Merge, TranslationsInAnotherUnit_AreConverted) {
    RigidTransform pose;
    pose.translation = Vec3(0.5, 0, 0);
    pose.unit = LengthUnit::metre;
    const Merged result =
        merged({framed(cloud_of({{1, 0, 0}}), {LengthUnit::millimetre, Vec3::Zero(), ""})}, posed({pose}));
    EXPECT_EQ(world(result.points, 0), Vec3(501, 0, 0));
}

TEST(Merge, FrameNames_OfTheFirstInputOrOfThePoses) {
    const PointCloud a = framed(cloud_of({{1, 0, 0}}), {LengthUnit::unknown, Vec3::Zero(), "a"});
    const PointCloud b = framed(cloud_of({{2, 0, 0}}), {LengthUnit::unknown, Vec3::Zero(), "b"});
    const Merged unposed = merged({a, b, b});
    EXPECT_EQ(unposed.points.frame.name, "a");
    EXPECT_THAT(unposed.warnings, ElementsAre(AllOf(HasSubstr("2 of 3 inputs have another frame than 'a'"),
                                                    HasSubstr("input 1 in 'b'"))));
    RigidTransform pose;
    pose.to = "common";
    const Merged placed = merged({a, b}, posed({pose, pose}));
    EXPECT_EQ(placed.points.frame.name, "common");
    EXPECT_THAT(placed.warnings, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
