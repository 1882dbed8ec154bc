// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/rigid_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
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

/// The ends of half axes of these lengths, in both directions.
std::vector<Vec3> ends_of_axes(double x, double y, double z) {
    return {{x, 0, 0}, {-x, 0, 0}, {0, y, 0}, {0, -y, 0}, {0, 0, z}, {0, 0, -z}};
}

TEST(PairsFit, OfAnEnlargedMirrorImage_IsComputedByHand) {
    // The sums of products are 2 · 3 · axis². Without a reflection, the shortest axis is reversed.
    const std::vector<Vec3> from = ends_of_axes(1, 2, 4);
    std::vector<Vec3> to;
    for (const Vec3& p : from) to.emplace_back(7 - 3 * p.x(), 8 + 3 * p.y(), 9 + 3 * p.z());
    const PairsFit fit = pairs_fit(from, to);
    EXPECT_EQ(fit.from_mean, Vec3::Zero());
    EXPECT_EQ(fit.to_mean, Vec3(7, 8, 9));
    EXPECT_LT((fit.values - Vec3(96, 24, 6)).norm(), 1e-13);
    EXPECT_EQ(fit.from_squares, 42);
    EXPECT_TRUE(fit.mirrors);
    EXPECT_LT((fit.rotation() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_LT((fit.reflection() - Eigen::Matrix3d(Vec3(-1, 1, 1).asDiagonal())).norm(), 1e-14);
    EXPECT_NEAR(fit.scale(), (96.0 + 24 - 6) / 42, 1e-14);
    EXPECT_LT((fit.motion().translation - Vec3(7, 8, 9)).norm(), 1e-13);
}

TEST(PairsFit, OfAnEnlargedCopy_HasItsScale_AndTheReflectionReversesTheShortestAxis) {
    const std::vector<Vec3> from = ends_of_axes(1, 2, 4);
    std::vector<Vec3> to;
    for (const Vec3& p : from) to.push_back(2.5 * quarter_turn.apply(p));
    const PairsFit fit = pairs_fit(from, to);
    EXPECT_FALSE(fit.mirrors);
    EXPECT_NEAR(fit.scale(), 2.5, 1e-14);
    EXPECT_LT((fit.rotation() - quarter_turn.rotation).norm(), 1e-14);
    const Eigen::Matrix3d reflection = quarter_turn.rotation * Vec3(-1, 1, 1).asDiagonal();
    EXPECT_LT((fit.reflection() - reflection).norm(), 1e-14);
}

TEST(PairsFit, OfPointsAtOnePosition_HasTheScale1) {
    const std::vector<Vec3> from(3, Vec3(1, 2, 3)), to{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}};
    const PairsFit fit = pairs_fit(from, to);
    EXPECT_EQ(fit.scale(), 1);
    EXPECT_LT((fit.motion().apply(Vec3(1, 2, 3)) - Vec3(1, 1, 0)).norm(), 1e-14);
}

TEST(PairsFit, WeightsCountAsRepeatedPairs) {
    std::vector<Vec3> from = ends_of_axes(1, 2, 4), to = moved(from, quarter_turn);
    to[0] += Vec3(0.3, 0.2, -0.4), to[3] += Vec3(0, -0.5, 0.1);
    const std::vector<double> weights{2, 1, 1, 3, 1, 1};
    const PairsFit weighted = pairs_fit(from, to, weights);
    for (const std::size_t again : {0, 3, 3}) from.push_back(from[again]), to.push_back(to[again]);
    const PairsFit repeated = pairs_fit(from, to);
    EXPECT_LT((weighted.values - repeated.values).norm(), 1e-13);
    EXPECT_NEAR(weighted.from_squares, repeated.from_squares, 1e-13);
    EXPECT_NEAR(weighted.scale(), repeated.scale(), 1e-14);
    EXPECT_LT(displacement(weighted.motion(), repeated.motion(), Vec3::Zero(), 1), 1e-14);
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

TEST(PlaneEquations, EigenvectorsOfAPlane_AreItsTurnAndItsShifts_First) {
    std::vector<PlanePair> pairs;
    for (int x = -3; x <= 3; ++x)
        for (int y = -3; y <= 3; ++y) pairs.push_back({Vec3(x, y, 0), Vec3(0, 0, 1), 0});
    const Matrix6 vectors = plane_equations(pairs).eigenvectors();
    // The turn about z and the shifts along x and y are free; the others are not.
    for (const int row : {0, 1, 5}) EXPECT_LT(vectors.row(row).head<3>().norm(), 1e-14) << row;
    for (const int row : {2, 3, 4}) EXPECT_LT(vectors.row(row).tail<3>().norm(), 1e-14) << row;
    EXPECT_LT((vectors.col(5).cwiseAbs() - Vector6::Unit(5)).norm(), 1e-14);
}

/// Points on three planes, some beside them.
std::vector<PlanePair> pairs_of_a_corner() {
    std::vector<PlanePair> pairs;
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 1; i <= 3; ++i)
            for (int j = 1; j <= 3; ++j) {
                Vec3 point;
                point[axis] = 0, point[(axis + 1) % 3] = i, point[(axis + 2) % 3] = j;
                pairs.push_back({point, Vec3::Unit(axis), 0.01 * (i - j) + 0.02 * axis});
            }
    return pairs;
}

TEST(PlaneEquations, WeightsCountAsRepeatedPairs) {
    std::vector<PlanePair> weighted = pairs_of_a_corner(), repeated = weighted;
    weighted[0].weight = 3, weighted[13].weight = 2;
    for (const std::size_t again : {0, 0, 13}) repeated.push_back(repeated[again]);
    const PlaneEquations one = plane_equations(weighted), other = plane_equations(repeated);
    EXPECT_LT((one.centre - other.centre).norm(), 1e-14);
    EXPECT_NEAR(one.radius, other.radius, 1e-14);
    EXPECT_LT((one.matrix - other.matrix).norm(), 1e-14);
    EXPECT_LT((one.gradient - other.gradient).norm(), 1e-16);
    for (PlanePair& pair : weighted) pair.weight *= 0.125;
    EXPECT_EQ(plane_equations(weighted).matrix, one.matrix) << "only the ratios of the weights count";
}

TEST(PlaneEquations, PairsOfWeightZero_DoNotCount_WhateverTheirResidual) {
    std::vector<PlanePair> pairs = pairs_of_a_corner();
    const PlaneEquations without = plane_equations(pairs);
    pairs.push_back({Vec3(5, 5, 5), Vec3(0, 0, 1), std::nan(""), 0});
    const PlaneEquations with = plane_equations(pairs);
    EXPECT_EQ(with.centre, without.centre);
    EXPECT_EQ(with.radius, without.radius);
    EXPECT_EQ(with.matrix, without.matrix);
    EXPECT_EQ(with.gradient, without.gradient);
    EXPECT_EQ(plane_equations(std::span(pairs).last(1)).motion(0).translation, Vec3::Zero());
}

TEST(PlaneEquations, WithoutPairs_DoNotMove) { EXPECT_EQ(plane_equations({}).motion(0).translation, Vec3::Zero()); }

}  // namespace
}  // namespace scanmill
