// SPDX-License-Identifier: GPL-3.0-or-later
/// Descriptors, correspondences and the motions that these agree on.
#include "scanmill/geometry/registration/consensus.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

const RigidMotion motion{Eigen::Quaterniond(0.3, 0.5, -0.2, 0.8).normalized().toRotationMatrix(), Vec3(1, 2, 3)};

/// A bumpy height field with its normals, in the order of a tree.
struct Surface {
    Array<Vec3> points, normals;
};
Surface bumps() {
    Surface surface;
    for (int i = 0; i < 30; ++i)
        for (int j = 0; j < 30; ++j) {
            const double x = i + 0.1 * (j % 3), y = j + 0.07 * (i % 4);
            surface.points.emplace_back(x, y, 2 * std::sin(x / 3) * std::cos(y / 4) + 0.01 * x * x);
        }
    const PointTree tree(surface.points);
    surface.points.assign(tree.positions().begin(), tree.positions().end());
    for (const Vec3& p : surface.points) {
        const double dx = 2.0 / 3 * std::cos(p.x() / 3) * std::cos(p.y() / 4) + 0.02 * p.x(),
                     dy = -0.5 * std::sin(p.x() / 3) * std::sin(p.y() / 4);
        surface.normals.push_back(Vec3(-dx, -dy, 1).normalized());
    }
    return surface;
}

TEST(Descriptors, OfAMovedSurface_AreTheSame) {
    const Surface surface = bumps();
    const Array<Descriptor> before = point_descriptors(PointTree(surface.points), surface.normals, 5, 100);
    Array<Vec3> points;
    for (const Vec3& p : surface.points) points.push_back(motion.apply(p));
    const PointTree tree(points);
    Array<Vec3> normals(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) normals[tree.index_of_row()[i]] = motion.turned(surface.normals[i]);
    const Array<Descriptor> after = point_descriptors(tree, normals, 5, 100);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k < descriptor_size; ++k)
            ASSERT_NEAR(before[i][k], after[tree.index_of_row()[i]][k], 1e-9);
}

TEST(Descriptors, EachAngle_AddsUpToTwiceAHundred) {
    const Surface surface = bumps();
    for (const Descriptor& d : point_descriptors(PointTree(surface.points), surface.normals, 5, 100))
        for (std::size_t angle = 0; angle < 3; ++angle) {
            double sum = 0;
            for (std::size_t k = 0; k < 11; ++k) sum += d[11 * angle + k];
            ASSERT_NEAR(sum, 200, 1e-9);
        }
}

TEST(Descriptors, APointAlone_HasZeros) {
    const std::vector<Vec3> points{{0, 0, 0}, {9, 0, 0}}, normals(2, Vec3::UnitZ());
    EXPECT_EQ(point_descriptors(PointTree(points), normals, 1, 10)[0], Descriptor{});
}

TEST(SimilarPoints, AreNearestInBothDirectionsWithoutRepeats) {
    const auto at = [](double value) {
        Descriptor d{};
        d[0] = value;
        return d;
    };
    const std::vector<Descriptor> first{at(0), at(10)}, second{at(1), at(2), at(11)};
    const Array<Correspondence> all = similar_points(first, second, 1, 100);
    // 0 -> 0, 1 -> 2; back 0 -> 0, 1 -> 0, 2 -> 1. The most similar first, then by index.
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(std::tuple(all[0].first, all[0].second, all[0].squared), std::tuple(0u, 0u, 1.0));
    EXPECT_EQ(std::tuple(all[1].first, all[1].second, all[1].squared), std::tuple(1u, 2u, 1.0));
    EXPECT_EQ(std::tuple(all[2].first, all[2].second, all[2].squared), std::tuple(0u, 1u, 4.0));
    EXPECT_EQ(similar_points(first, second, 1, 2).size(), 2u);
}

TEST(ConsistentMotions, AFewRightCorrespondencesAmongMany_DecideTheFirst) {
    const Surface surface = bumps();
    Array<Vec3> points, normals;
    for (const Vec3& p : surface.points) points.push_back(motion.apply(p));
    for (const Vec3& n : surface.normals) normals.push_back(motion.turned(n));
    Random random(1);
    Array<Correspondence> correspondences;
    for (u32 i = 0; i < 1000; ++i) {
        const u32 row = static_cast<u32>(random.index(points.size()));
        correspondences.push_back({row, i % 12 == 0 ? row : static_cast<u32>(random.index(points.size())), 0});
    }
    const std::vector<Hypothesis> found = consistent_motions({surface.points, surface.normals}, {points, normals},
                                                             correspondences, {1, Vec3(15, 15, 0), 12, 5});
    ASSERT_FALSE(found.empty());
    EXPECT_LE(found.size(), 5u);
    EXPECT_LT(displacement(found[0].motion, motion, Vec3(15, 15, 0), 12), 1);  // the tolerance
    EXPECT_GE(found[0].votes, 84u);
    EXPECT_TRUE(std::ranges::is_sorted(found, std::greater(), &Hypothesis::votes));
}

TEST(ConsistentMotions, WithoutCorrespondences_AreNone) {
    EXPECT_TRUE(consistent_motions({}, {}, {}, {1, Vec3::Zero(), 1, 5}).empty());
}

}  // namespace
}  // namespace scanmill
