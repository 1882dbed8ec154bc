// SPDX-License-Identifier: GPL-3.0-or-later
/// Surfaces that do not determine the motion: named, and never followed along themselves.

#include <gmock/gmock.h>

#include "filters/icp/cases.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

/// What is left of a motion after the fit.
RigidTransform left_of(const RigidTransform& motion, const Refined& result) {
    return composed(result.transform, motion);
}

/// The angle about an axis of a small turn.
double turn_about(const RigidTransform& motion, const Vec3& axis) {
    const Eigen::Matrix3d& r = motion.rotation;
    return Vec3(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1)).dot(axis) / 2;
}

constexpr double degree = std::numbers::pi / 180;
/// The free direction itself turns with the scan, by up to a degree: a second-order effect of the motion, no drift.
constexpr double second_order = 0.05 * degree;

TEST(IcpSlides, APlane_IsNotMovedWithinItself) {
    std::vector<Vec3> points;
    add_lattice(points, 20, 80, 2);
    const RigidTransform motion = motion_about(Vec3(50, 50, 0), 1, Vec3(1, 0, 0), Vec3(0.7, -0.4, 0.9));
    const Refined result = refined(cloud(moved(points, motion)), square(100));
    EXPECT_EQ(result.free_directions, 3u);
    EXPECT_THAT(result.doubts, Contains(AllOf(HasSubstr("only 3 of 6"), HasSubstr("as a plane does"))));
    const RigidTransform left = left_of(motion, result);
    for (const Vec3& p : points) ASSERT_NEAR(left.apply(p).z(), 0, 1e-9);
    EXPECT_NEAR(turn_about(left, Vec3::UnitZ()), 0, 1e-4);
    EXPECT_LT((left.apply(Vec3(50, 50, 0)) - Vec3(50.7, 49.6, 0)).norm(), 0.02);
}

TEST(IcpSlides, ASphere_IsNotTurned) {
    Random random(1);
    const TriangleMesh sphere = geodesic_sphere(10, 40);
    const Scan scan = scan_of(sphere, 5000, 0.01, random);
    const Vec3 shift(0.2, -0.3, 0.1);
    const RigidTransform motion = motion_about(Vec3::Zero(), 1, Vec3(1, 2, 3), shift);
    const Refined result = refined(cloud(moved(scan.points, motion)), sphere);
    EXPECT_EQ(result.free_directions, 3u);
    EXPECT_THAT(result.doubts, Contains(AllOf(HasSubstr("only 3 of 6"), HasSubstr("as a sphere does"))));
    EXPECT_LT((result.transform.apply(shift)).norm(), 0.002);
    EXPECT_LT((result.transform.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-3);
}

TEST(IcpSlides, ACylinder_IsNeitherTurnedNorShiftedAlongItsAxis) {
    Random random(2);
    const TriangleMesh cylinder = revolved({{10, 0, -30}, {10, 0, 0}, {10, 0, 30}}, 180);
    const TriangleMesh middle = revolved({{10, 0, -20}, {10, 0, 0}, {10, 0, 20}}, 180);
    const Scan scan = scan_of(middle, 5000, 0.01, random);
    RigidTransform motion = motion_about(Vec3::Zero(), 1, Vec3(0, 0, 1), Vec3::Zero());
    motion = composed(motion_about(Vec3::Zero(), 0.5, Vec3(1, 1, 0), Vec3(0.3, -0.4, 0.8)), motion);
    const Refined result = refined(cloud(moved(scan.points, motion)), cylinder);
    EXPECT_EQ(result.free_directions, 2u);
    EXPECT_THAT(result.doubts, Contains(AllOf(HasSubstr("only 4 of 6"), HasSubstr("as a cylinder does"))));
    const RigidTransform left = left_of(motion, result);
    EXPECT_NEAR(turn_about(left, Vec3::UnitZ()), degree, second_order);
    EXPECT_NEAR(left.apply(Vec3::Zero()).z(), 0.8, 0.01);
    EXPECT_LT((left.apply(Vec3(0, 0, 20)).head<2>()).norm(), 0.005);
    EXPECT_LT((left.apply(Vec3(0, 0, -20)).head<2>()).norm(), 0.005);
}

TEST(IcpSlides, ATorus_IsNotTurnedAboutItsAxis) {
    Random random(3);
    const TriangleMesh ring = torus(20, 6, 180, 60);
    const Scan scan = scan_of(ring, 5000, 0.01, random);
    RigidTransform motion = motion_about(Vec3::Zero(), 1, Vec3(0, 0, 1), Vec3::Zero());
    motion = composed(motion_about(Vec3::Zero(), 0.5, Vec3(1, 1, 0), Vec3(0.3, -0.4, 0.5)), motion);
    const Refined result = refined(cloud(moved(scan.points, motion)), ring);
    EXPECT_EQ(result.free_directions, 1u);
    EXPECT_THAT(result.doubts,
                Contains(AllOf(HasSubstr("only 5 of 6"), HasSubstr("as a body of revolution or an extrusion does"))));
    const RigidTransform left = left_of(motion, result);
    EXPECT_NEAR(turn_about(left, Vec3::UnitZ()), degree, second_order);
    EXPECT_LT(left.apply(Vec3::Zero()).norm(), 0.005);
}

TEST(IcpSlides, AnExtrusion_IsNotShiftedAlongItself) {
    Random random(4);
    // The sides of a box, without its ends.
    const auto sides = [](double from, double to) { return revolved({{20, 0, from}, {20, 0, to}}, 4); };
    const Scan scan = scan_of(sides(-20, 20), 5000, 0.01, random);
    const RigidTransform motion = motion_about(Vec3::Zero(), 0.5, Vec3(1, 2, 2), Vec3(0.3, -0.4, 0.8));
    const Refined result = refined(cloud(moved(scan.points, motion)), sides(-30, 30));
    EXPECT_EQ(result.free_directions, 1u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("the source is not moved along the other one")));
    const RigidTransform left = left_of(motion, result);
    EXPECT_NEAR(left.apply(Vec3::Zero()).z(), 0.8, 0.01);
    EXPECT_LT(left.apply(Vec3::Zero()).head<2>().norm(), 0.002);
    EXPECT_LT((left.rotation - Eigen::Matrix3d::Identity()).norm(), 2e-4);
}

TEST(IcpSlides, ThePointsOfASphere_SlideOnPoints) {
    Random random(5);
    const TriangleMesh sphere = geodesic_sphere(10, 40);
    const Refined result =
        refined(cloud(scan_of(sphere, 5000, 0.01, random).points), cloud(scan_of(sphere, 8000, 0.01, random).points));
    EXPECT_EQ(result.free_directions, 3u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("as a sphere does")));
}

TEST(IcpSlides, ABoxWithAKey_DoesNotSlide) {
    Random random(6);
    const Refined result = refined(cloud(scan_of(l_block(40), 5000, 0.02, random).points), l_block(40));
    EXPECT_EQ(result.free_directions, 0u);
    EXPECT_GT(result.slide, 0.01);
}

}  // namespace
}  // namespace scanmill::test
