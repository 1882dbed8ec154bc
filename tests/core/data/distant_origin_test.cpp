// SPDX-License-Identifier: GPL-3.0-or-later
// The origin of distant scans: coordinates of 10^6 m keep their micrometres.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "scanmill/base/random.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill::test {
namespace {

/// The rounding error of a - b (Knuth's two-sum).
double lost_in_difference(double a, double b) {
    const double difference = a - b;
    const double back = difference - a;
    return (a - (difference - back)) - (b + back);
}

Vec3 random_point(Random& random, const Vec3& centre, double half) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = centre[axis] + random.uniform(-half, half);
    return p;
}

/// Subtracting the origin loses nothing and adding it gives back the same bits.
testing::AssertionResult is_exact_for(const Vec3& origin, std::span<const Vec3> positions) {
    for (const Vec3& p : positions)
        for (int axis = 0; axis < 3; ++axis) {
            const double local = p[axis] - origin[axis];
            if (lost_in_difference(p[axis], origin[axis]) != 0)
                return testing::AssertionFailure() << p[axis] << " - " << origin[axis] << " is rounded";
            if (std::bit_cast<u64>(origin[axis] + local) != std::bit_cast<u64>(p[axis]))
                return testing::AssertionFailure() << p[axis] << " does not come back from " << origin[axis];
        }
    return testing::AssertionSuccess();
}

TEST(DistantOrigin, RandomCloudsAtAnyDistanceAndScale_LoseNoBit) {
    Random random(2024);
    int shifted = 0;
    for (int run = 0; run < 3000; ++run) {
        const double distance = std::pow(10.0, random.uniform(3, 9));
        const double half = distance * std::pow(10.0, random.uniform(-16, 1));
        Vec3 centre;
        for (int axis = 0; axis < 3; ++axis) centre[axis] = distance * random.uniform(-1, 1);
        std::vector<Vec3> positions;
        for (int i = 0; i < 50; ++i) positions.push_back(random_point(random, centre, half));
        const Vec3 origin = distant_origin(bounding_box(positions));
        ASSERT_TRUE(is_exact_for(origin, positions)) << "run " << run;
        shifted += origin != Vec3::Zero();
    }
    EXPECT_GT(shifted, 2000) << "most of these clouds are far away against their size";
}

TEST(DistantOrigin, EveryPointOfTheBox_IsExactAtItsBordersToo) {
    Random random(7);
    for (int run = 0; run < 2000; ++run) {
        // Just beyond the distance from which on clouds are shifted, across powers of two.
        const double middle = std::ldexp(random.uniform(0.99, 1.01), static_cast<int>(random.index(60)) - 30);
        const double half = middle / 32.5 / std::sqrt(3.0);
        const std::vector<Vec3> corners{Vec3::Constant(middle - half), Vec3::Constant(middle + half),
                                        random_point(random, Vec3::Constant(middle), half)};
        const Vec3 origin = distant_origin(bounding_box(corners));
        ASSERT_NE(origin[0], 0);
        ASSERT_TRUE(is_exact_for(origin, corners)) << "run " << run;
    }
}

TEST(DistantOrigin, DistantCloud_ComesNearItsOrigin) {
    const std::vector<Vec3> positions{{4.5e6, -1e6, 200}, {4.5e6 + 3, -1e6 + 4, 200}};
    const BoundingBox box = bounding_box(positions);
    const Vec3 origin = distant_origin(box);
    for (const Vec3& p : positions)
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(p[axis] - origin[axis]), 2 * box.diagonal()) << axis;
}

TEST(DistantOrigin, MicrometresAtAMillionMetres_AreKept) {
    // The purpose of the origin: coordinates near zero are accurate in computations.
    const std::vector<Vec3> positions{{1e6, 0, 0}, {1e6 + 1e-6, 0, 0}};
    const Vec3 origin = distant_origin(bounding_box(positions));
    EXPECT_EQ((positions[1] - origin).x() - (positions[0] - origin).x(), (1e6 + 1e-6) - 1e6);
    EXPECT_NE(positions[0], positions[1]);
}

TEST(DistantOrigin, CloudNearZero_KeepsItsCoordinates) {
    for (const double distance : {0.0, 0.5, 5.0}) {
        const std::vector<Vec3> positions{Vec3::Constant(distance), Vec3::Constant(distance + 1)};
        EXPECT_EQ(distant_origin(bounding_box(positions)), Vec3::Zero()) << distance;
    }
}

TEST(DistantOrigin, OnlyDistantAxes_AreShifted) {
    const std::vector<Vec3> positions{{500000, 4900000, 0}, {500001, 4900002, 1}};
    const Vec3 origin = distant_origin(bounding_box(positions));
    EXPECT_NE(origin.x(), 0);
    EXPECT_NE(origin.y(), 0);
    EXPECT_EQ(origin.z(), 0);
}

TEST(DistantOrigin, HandComputedCloud_HasTheNearestMultipleOfThePowerOfTwoAboveItsDiagonal) {
    // Diagonal 5, so a step of 8; the middles are 1001.5, 2002 and -3000.
    const std::vector<Vec3> positions{{1000, 2000, -3000}, {1003, 2004, -3000}};
    EXPECT_EQ(distant_origin(bounding_box(positions)), Vec3(1000, 2000, -3000));
}

TEST(DistantOrigin, DiagonalThatIsAPowerOfTwo_IsTheStep) {
    // 1004 is 251 steps of 4, and no multiple of 8.
    const std::vector<Vec3> positions{{1002, 0, 0}, {1006, 0, 0}};
    EXPECT_EQ(distant_origin(bounding_box(positions)), Vec3(1004, 0, 0));
}

TEST(DistantOrigin, SinglePoint_IsExact) {
    Random random(3);
    for (int run = 0; run < 500; ++run) {
        const std::vector<Vec3> one{random_point(random, Vec3::Zero(), 1e9)};
        EXPECT_TRUE(is_exact_for(distant_origin(bounding_box(one)), one));
    }
}

TEST(DistantOrigin, BoxWithoutAMiddle_HasTheOriginZero) {
    EXPECT_EQ(distant_origin(BoundingBox{}), Vec3::Zero());
    const double largest = std::numeric_limits<double>::max();
    EXPECT_EQ(distant_origin({Vec3::Constant(-largest), Vec3::Constant(largest)}), Vec3::Zero());
    const double infinity = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 beyond(1e9, 1e9, 1e9);
        beyond[axis] = infinity;
        EXPECT_EQ(distant_origin({beyond, beyond}), Vec3::Zero()) << axis;
    }
}

TEST(DistantOrigin, SmallestNumbers_StayFiniteAndExact) {
    for (const double tiny : {std::numeric_limits<double>::denorm_min(), 1e-310, std::numeric_limits<double>::min()}) {
        const std::vector<Vec3> one{Vec3::Constant(tiny)};
        EXPECT_TRUE(is_exact_for(distant_origin(bounding_box(one)), one)) << tiny;
    }
}

}  // namespace
}  // namespace scanmill::test
