// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/rigid_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "scanmill/geometry/registration/plane_equations.hpp"

namespace scanmill {
namespace {

const RigidMotion quarter_turn{(Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished(), Vec3(1, 2, 3)};

std::vector<Vec3> moved(const std::vector<Vec3>& points, const RigidMotion& motion) {
    std::vector<Vec3> result;
    for (const Vec3& p : points) result.push_back(motion.apply(p));
    return result;
}

TEST(RigidMotion, ThenAndInverse_AreThoseOfMaps) {
    const RigidMotion twice = quarter_turn.then(quarter_turn);
    EXPECT_LT((twice.apply(Vec3(1, 0, 5)) - Vec3(-2, 3, 11)).norm(), 1e-15);
    EXPECT_LT((quarter_turn.inverse().apply(quarter_turn.apply(Vec3(4, 5, 6))) - Vec3(4, 5, 6)).norm(), 1e-15);
}

TEST(RigidMotion, Displacement_OfAShiftIsItsLength_AndOfATurnItsArc) {
    RigidMotion shift;
    shift.translation = Vec3(3, 4, 0);
    EXPECT_NEAR(displacement(shift, {}, Vec3(7, 8, 9), 2), 5, 1e-15);
    // About the centre, a half turn moves the two points on each of x and y by twice the radius: √(4 · 4 / 8) radii.
    RigidMotion turn;
    turn.rotation = Vec3(-1, -1, 1).asDiagonal();
    EXPECT_NEAR(displacement(turn, {}, Vec3::Zero(), 3), 3 * std::sqrt(2.0), 1e-14);
}

TEST(FittedMotion, OfMovedPoints_IsTheMotion) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
    const RigidMotion fit = fitted_motion(points, moved(points, quarter_turn));
    EXPECT_LT(displacement(fit, quarter_turn, Vec3::Zero(), 1), 1e-14);
}

TEST(FittedMotion, OfPointsInAPlane_IsNoReflection) {
    const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 1, 0}};
    const RigidMotion fit = fitted_motion(square, moved(square, quarter_turn));
    EXPECT_NEAR(fit.rotation.determinant(), 1, 1e-14);
    EXPECT_LT(displacement(fit, quarter_turn, Vec3::Zero(), 1), 1e-14);
}

TEST(FittedMotion, OfAMirrorImage_IsARotation) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
    std::vector<Vec3> mirrored = points;
    for (Vec3& p : mirrored) p.x() = -p.x();
    EXPECT_NEAR(fitted_motion(points, mirrored).rotation.determinant(), 1, 1e-14);
}

TEST(FittedMotion, PairsOfWeightZero_DoNotCount) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
    std::vector<Vec3> targets = moved(points, quarter_turn), sources = points;
    sources.emplace_back(5, 5, 5), targets.emplace_back(-90, 0, 0);
    const std::vector<double> weights{1, 2, 1, 1, 0};
    EXPECT_LT(displacement(fitted_motion(sources, targets, weights), quarter_turn, Vec3::Zero(), 1), 1e-14);
}

TEST(PlaneEquations, OfAPlane_LeaveThreeDirectionsFree) {
    std::vector<PlanePair> pairs;
    for (int x = -3; x <= 3; ++x)
        for (int y = -3; y <= 3; ++y) pairs.push_back({Vec3(x, y, 0), Vec3(0, 0, 1), 0.25});
    const PlaneEquations equations = plane_equations(pairs);
    const Vector6 values = equations.eigenvalues();
    EXPECT_NEAR(values[2], 0, 1e-14);
    EXPECT_NEAR(values[3], 0.5, 1e-14);  // turns about x and y: the mean square of a coordinate is half of R²
    EXPECT_NEAR(values[5], 1, 1e-14);  // the shift along the normal
    const RigidMotion motion = equations.motion(1e-3);
    EXPECT_LT((motion.translation - Vec3(0, 0, -0.25)).norm(), 1e-14);
    EXPECT_LT((motion.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(PlaneEquations, WithoutPairs_DoNotMove) { EXPECT_EQ(plane_equations({}).motion(0).translation, Vec3::Zero()); }

}  // namespace
}  // namespace scanmill
