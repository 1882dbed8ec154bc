// SPDX-License-Identifier: GPL-3.0-or-later
/// Searches among the points of a view: thinning, nearest points, lines of sight.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "scanmill/base/random.hpp"
#include "scanmill/geometry/registration/line_of_sight.hpp"
#include "scanmill/geometry/registration/nearest_within.hpp"
#include "scanmill/geometry/registration/rigid_motion.hpp"
#include "scanmill/geometry/registration/thinning.hpp"

namespace scanmill {
namespace {

std::vector<Vec3> random_points(std::size_t count, u64 seed) {
    Random random(seed);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) points.emplace_back(random.uniform(), random.uniform(), random.uniform());
    return points;
}

/// By trying all points. The lower index wins ties.
u32 nearest_of_all(const std::vector<Vec3>& points, const Vec3& position, double distance) {
    u32 best = ~u32(0);
    double least = distance * distance;
    for (u32 i = 0; i < points.size(); ++i)
        if (const double squared = (points[i] - position).squaredNorm(); squared < least) least = squared, best = i;
    return best;
}

TEST(NearestWithin, FindsWhatATrialOfAllPointsFinds) {
    const std::vector<Vec3> points = random_points(500, 1);
    const NearestWithin nearest(points, 0.2);
    Random random(2);
    for (int i = 0; i < 5000; ++i) {
        const Vec3 at(random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5));
        for (const double distance : {0.05, 0.2})
            ASSERT_EQ(nearest.nearest(at, distance), nearest_of_all(points, at, distance));
    }
}

TEST(NearestWithin, OfTwoEquallyNearPoints_FindsTheLowerIndex) {
    const std::vector<Vec3> points{{1, 0, 0}, {-1, 0, 0}};
    EXPECT_EQ(NearestWithin(points, 2).nearest(Vec3::Zero(), 2), 0u);
}

TEST(NearestWithin, AnOutlierFarAway_IsAllowed) {
    const std::vector<Vec3> points{{0, 0, 0}, {1e9, 0, 0}};
    EXPECT_EQ(NearestWithin(points, 1).nearest(Vec3(1e9, 0.5, 0), 1), 1u);
    EXPECT_EQ(NearestWithin(points, 1).nearest(Vec3(1e8, 0, 0), 1), NearestWithin::none);
}

TEST(ProjectedGrid, FindsTheNearestPointFromAnyGuess) {
    const std::vector<Vec3> points = random_points(500, 3);
    const ProjectedGrid grid(points, Vec3(1, 2, 2) / 3, 0.05);
    Random random(4);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 at(random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5));
        const u32 expected = nearest_of_all(points, at, 0.3);
        for (const double guess : {0.0, 0.1, 5.0}) {
            const ProjectedGrid::Nearest found = grid.nearest(at, guess, 0.3);
            ASSERT_EQ(found.row, expected);
            if (expected == ~u32(0)) continue;
            ASSERT_NEAR(found.distance, (points[expected] - at).norm(), 1e-14);
            // No other point is nearer than what is returned as the distance of the second.
            for (u32 row = 0; row < points.size(); ++row) {
                if (row == expected) continue;
                ASSERT_GE((points[row] - at).norm(), found.second - 1e-14);
            }
        }
    }
}

TEST(Thinning, KeptPointsAreApart_AndNearAllOthers) {
    const std::vector<Vec3> points = random_points(2000, 5);
    const double distance = 0.15;
    const Array<u32> rows = thinned_rows(points, distance);
    EXPECT_EQ(rows[0], 0u);
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) ASSERT_GE((points[rows[i]] - points[rows[j]]).norm(), distance);
    for (const Vec3& p : points) {
        const bool is_near =
            std::ranges::any_of(rows, [&](u32 row) { return (points[row] - p).norm() < distance || points[row] == p; });
        ASSERT_TRUE(is_near);
    }
}

TEST(Thinning, Means_AreThoseOfTheNearestPoints) {
    const std::vector<Vec3> points{{0, 0, 0}, {0.4, 0, 0}, {1, 0, 0}, {0.8, 0, 0}, {5, 5, 5}};
    const Array<Vec3> means = thinned_means(points, 0.9);
    ASSERT_EQ(means.size(), 3u);
    EXPECT_LT((means[0] - Vec3(0.2, 0, 0)).norm(), 1e-15);
    EXPECT_LT((means[1] - Vec3(0.9, 0, 0)).norm(), 1e-15);
    EXPECT_EQ(means[2], Vec3(5, 5, 5));
}

TEST(Thinning, MovesWithThePoints) {
    // A lattice has many equal distances, which rounding must not decide.
    std::vector<Vec3> points, turned;
    for (int x = 0; x < 40; ++x)
        for (int y = 0; y < 40; ++y) points.emplace_back(x, y, 0);
    const RigidMotion motion{Eigen::Quaterniond(0.3, 0.5, -0.2, 0.8).normalized().toRotationMatrix(), Vec3(1, 2, 3)};
    for (const Vec3& p : points) turned.push_back(motion.apply(p));
    const Array<Vec3> before = thinned_means(points, 2.1), after = thinned_means(turned, 2.1);
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_LT((motion.apply(before[i]) - after[i]).norm(), 1e-12);
}

TEST(SightLines, APlate_HidesWhatIsBehindAndIsContradictedInFront) {
    std::vector<Vec3> plate;
    for (int x = 0; x <= 30; ++x)
        for (int y = 0; y <= 30; ++y) plate.emplace_back(0.1 * x, 0.1 * y, 0);
    const SightLines sight(plate, Vec3::UnitZ(), 0.5);
    using Place = SightLines::Place;
    EXPECT_EQ(sight.place_of(Vec3(1, 1, 0.6)), Place::in_front);
    EXPECT_EQ(sight.place_of(Vec3(1, 1, 0.4)), Place::behind);
    EXPECT_EQ(sight.place_of(Vec3(1, 1, -9)), Place::behind);
    EXPECT_EQ(sight.place_of(Vec3(3.2, 1, 0.6)), Place::in_front);
    EXPECT_EQ(sight.place_of(Vec3(3.3, 1, 0.6)), Place::unknown);
    EXPECT_FALSE(sight.is_empty_at(Vec3(3.4, 1, 7)));
    EXPECT_TRUE(sight.is_empty_at(Vec3(3.6, 1, 0)));
}

}  // namespace
}  // namespace scanmill
