// SPDX-License-Identifier: GPL-3.0-or-later
// The robust box against its definition, computed by sorting.
#include "scanmill/data/robust_box.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "scanmill/formats/files.hpp"
#include "support/numbers.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::ElementsAre, ::testing::IsEmpty;

std::vector<Vec3> positions_of(const PointCloud& cloud) { return {cloud.positions.begin(), cloud.positions.end()}; }

/// Word by word.
RobustBox defined(const std::vector<Vec3>& positions) {
    std::vector<u32> finite;
    for (u32 row = 0; row < positions.size(); ++row)
        if (positions[row].allFinite()) finite.push_back(row);
    if (finite.empty()) return {};
    const std::size_t k = finite.size() / 500;
    BoundingBox inner;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> sorted;
        for (const u32 row : finite) sorted.push_back(positions[row][axis]);
        std::ranges::sort(sorted);
        inner.low[axis] = sorted[k];
        inner.high[axis] = sorted[sorted.size() - 1 - k];
    }
    const double margin = 0.25 * inner.diagonal();
    RobustBox box;
    for (const u32 row : finite) {
        const Vec3& p = positions[row];
        box.all.add(p);
        const bool is_inside =
            (p.array() >= inner.low.array() - margin).all() && (p.array() <= inner.high.array() + margin).all();
        if (is_inside)
            box.robust.add(p);
        else
            box.stray.push_back({row, p});
    }
    if (box.stray.size() > k) {
        box.stray.clear();
        box.robust = box.all;
    }
    return box;
}

void expect_as_defined(const std::vector<Vec3>& positions) {
    const RobustBox found = robust_box(positions), expected = defined(positions);
    EXPECT_EQ(found.all.low, expected.all.low);
    EXPECT_EQ(found.all.high, expected.all.high);
    EXPECT_EQ(found.robust.low, expected.robust.low);
    EXPECT_EQ(found.robust.high, expected.robust.high);
    EXPECT_EQ(found.stray, expected.stray);
}

std::vector<u32> stray_rows(const std::vector<Vec3>& positions) {
    std::vector<u32> rows;
    for (const StrayPoint& point : robust_box(positions).stray) rows.push_back(point.row);
    return rows;
}

/// `count` points of the unit cube, of which the first `far` are at distances of 100 and more along +x.
std::vector<Vec3> cube_with_far(std::size_t count, std::size_t far) {
    std::vector<Vec3> positions = positions_of(random_cube(count, 5));
    for (std::size_t i = 0; i < far; ++i) positions[i] = Vec3(100.0 + static_cast<double>(i), 0.5, 0.5);
    return positions;
}

TEST(RobustBox, FewerThan500Points_HaveNoStrayOne) {
    EXPECT_THAT(stray_rows(cube_with_far(499, 1)), IsEmpty());
    EXPECT_THAT(stray_rows(cube_with_far(500, 1)), ElementsAre(0u));
    expect_as_defined(cube_with_far(499, 1));
    expect_as_defined(cube_with_far(500, 1));
}

TEST(RobustBox, MoreThanOneIn500Outside_AreNotStray) {
    EXPECT_THAT(stray_rows(cube_with_far(999, 2)), IsEmpty());
    EXPECT_THAT(stray_rows(cube_with_far(1000, 2)), ElementsAre(0u, 1u));
    EXPECT_THAT(stray_rows(cube_with_far(1000, 3)), IsEmpty());
    EXPECT_THAT(stray_rows(cube_with_far(1499, 3)), IsEmpty());
    EXPECT_THAT(stray_rows(cube_with_far(1500, 3)), ElementsAre(0u, 1u, 2u));
    for (const std::size_t count : {500u, 999u, 1000u, 1499u, 1500u, 5000u})
        for (const std::size_t far : {0u, 1u, 2u, 3u, 4u, 10u, 11u}) expect_as_defined(cube_with_far(count, far));
}

TEST(RobustBox, OneFarPointTooManyOnDifferentSides_LeavesNoneStray) {
    std::vector<Vec3> positions = positions_of(random_cube(1000, 5));
    positions[1] = Vec3(100, 0, 0);
    positions[2] = Vec3(0, 100, 0);
    EXPECT_THAT(stray_rows(positions), ElementsAre(1u, 2u));
    positions[3] = Vec3(0, 0, -100);
    EXPECT_THAT(stray_rows(positions), IsEmpty()) << "3 of 1000 are more than 2";
    EXPECT_GT(robust_box(positions).diagonal(), 100);
    expect_as_defined(positions);
}

TEST(RobustBox, PointOnTheBoundaryOfQ_IsNotStray) {
    // 500 points, k = 1: second lowest and highest are 0 and 3 and 0 and 4: Q goes to 3 + 5/4 in x.
    std::vector<Vec3> positions(500, Vec3::Zero());
    for (std::size_t i = 0; i < 100; ++i) positions[i] = Vec3(3, 4, 0);
    positions[499] = Vec3(4.25, 4, 0);
    EXPECT_THAT(stray_rows(positions), IsEmpty());
    positions[499] = Vec3(std::nextafter(4.25, 5.0), 4, 0);
    EXPECT_THAT(stray_rows(positions), ElementsAre(499u));
    EXPECT_EQ(robust_box(positions).diagonal(), 5);
    EXPECT_EQ(robust_box(positions).all.high, positions[499]);
}

TEST(RobustBox, PointOutsideAlongSeveralAxes_CountsOnce) {
    std::vector<Vec3> positions = positions_of(random_cube(1000, 6));
    positions[7] = Vec3(-50, 50, 50);
    positions[900] = Vec3(-60, -60, -60);
    EXPECT_THAT(stray_rows(positions), ElementsAre(7u, 900u));
    expect_as_defined(positions);
}

TEST(RobustBox, StrayPointsOnEverySide_LeaveTheBoxOfTheOthers) {
    std::vector<Vec3> positions = positions_of(random_cube(3000, 7));
    const BoundingBox others = bounding_box(std::span(positions).subspan(6));
    for (int side = 0; side < 6; ++side)
        positions[static_cast<std::size_t>(side)][side / 2] += side % 2 == 0 ? 1000 : -1000;
    const RobustBox box = robust_box(positions);
    EXPECT_EQ(box.stray.size(), 6u);
    EXPECT_EQ(box.robust.low, others.low);
    EXPECT_EQ(box.robust.high, others.high);
    expect_as_defined(positions);
}

TEST(RobustBox, EqualCoordinates_AreTies) {
    std::mt19937 source(3);
    for (int round = 0; round < 200; ++round) {
        std::vector<Vec3> positions(500 + source() % 1600);
        for (Vec3& p : positions) p = Vec3(source() % 3, source() % 2, round % 2);
        for (unsigned i = 0; i < source() % 6; ++i)
            positions[source() % positions.size()] += Vec3(source() % 12, source() % 12, -double(source() % 9));
        expect_as_defined(positions);
    }
}

TEST(RobustBox, RandomClouds_AgreeWithTheDefinition) {
    std::mt19937 source(11);
    std::normal_distribution<double> normal;
    std::cauchy_distribution<double> heavy;
    for (int round = 0; round < 300; ++round) {
        std::vector<Vec3> positions(1 + source() % 4000);
        const Vec3 scale(1, round % 3 == 0 ? 0 : 0.1, round % 5 == 0 ? 0 : 3);
        for (Vec3& p : positions)
            p = scale.cwiseProduct(round % 2 == 0 ? Vec3(normal(source), normal(source), normal(source))
                                                  : Vec3(heavy(source), heavy(source), heavy(source)));
        if (round % 4 == 0) std::ranges::sort(positions, {}, [](const Vec3& p) { return p.x(); });
        expect_as_defined(positions);
    }
}

TEST(RobustBox, ManyPieces_AreOneCloud) {
    std::vector<Vec3> positions = positions_of(random_sphere(300'000, 4));
    expect_as_defined(positions);
    positions[299'999] = Vec3(0, 0, 9);
    positions[70'000] = Vec3(0, -9, 9);
    expect_as_defined(positions);
    std::ranges::sort(positions, {}, [](const Vec3& p) { return p.y() + p.z(); });
    expect_as_defined(positions);
}

TEST(RobustBox, NotFinitePositions_AreIgnored) {
    std::vector<Vec3> positions = cube_with_far(600, 1);
    for (std::size_t i = 0; i < 100; ++i) positions.push_back(Vec3(nan, 1e6, infinity));
    EXPECT_THAT(stray_rows(positions), ElementsAre(0u));
    expect_as_defined(positions);
    for (std::size_t i = 100; i < 201; ++i) positions[i] = Vec3(-infinity, 0, nan);
    EXPECT_THAT(stray_rows(positions), IsEmpty()) << "499 are finite";
    expect_as_defined(positions);
    const std::vector<Vec3> none(3, Vec3::Constant(nan));
    EXPECT_TRUE(robust_box(none).all.empty());
    EXPECT_EQ(robust_box(none).diagonal(), 0);
    EXPECT_TRUE(robust_box({}).all.empty());
}

TEST(RobustBox, AllAtOnePosition_ExceptOne) {
    std::vector<Vec3> positions(1000, Vec3(1, 2, 3));
    EXPECT_THAT(stray_rows(positions), IsEmpty());
    positions[3] = Vec3(1, 2, 4);
    EXPECT_THAT(stray_rows(positions), ElementsAre(3u));
    EXPECT_EQ(robust_box(positions).diagonal(), 0);
}

TEST(RobustBox, HugeCoordinates_AreStray) {
    std::vector<Vec3> positions = positions_of(random_cube(1000, 8));
    positions[1] = Vec3(1e308, 0, 0);
    positions[2] = Vec3(-1.5e308, 0, 0);
    EXPECT_THAT(stray_rows(positions), ElementsAre(1u, 2u));
    EXPECT_LT(robust_box(positions).diagonal(), 2);
}

/// The box of a cloud without stray points is the ordinary one, bit for bit.
void expect_ordinary(const PointCloud& cloud) {
    const RobustBox box = robust_box(cloud.positions.span());
    const BoundingBox ordinary = bounding_box(cloud.positions.span());
    EXPECT_THAT(box.stray, IsEmpty());
    EXPECT_EQ(box.robust.low, ordinary.low);
    EXPECT_EQ(box.robust.high, ordinary.high);
    EXPECT_EQ(box.diagonal(), ordinary.diagonal());
    EXPECT_EQ(distant_origin(box), distant_origin(ordinary));
}

TEST(RobustBox, Shapes_HaveNoStrayPoint) {
    expect_ordinary(random_cube(20'000, 1));
    expect_ordinary(random_sphere(20'000, 1, 5));
    expect_ordinary(fibonacci_sphere(20'000));
    expect_ordinary(poisson_torus(0.05));
    expect_ordinary(moved(random_cube(20'000, 2), 30, Vec3(500'000, 4'500'000, 300)));
}

TEST(RobustBox, BunnyAndKitten_HaveNoStrayPoint) {
    SCANMILL_REAL_SCAN(bunny, shared_data, "1-bunny/bun_zipper.ply");
    expect_ordinary(*read_points(bunny));
    SCANMILL_REAL_SCAN(kitten, fetched_data, "points_3/kitten.xyz");
    expect_ordinary(*read_points(kitten));
}

/// A scan of 30 m at survey coordinates, on a grid of 2^-10 m.
std::vector<Vec3> survey_scan() {
    std::vector<Vec3> positions = positions_of(random_cube(2000, 9, 30));
    for (Vec3& p : positions) p = Vec3(500'000, 4'500'000, 300) + (p * 1024).array().round().matrix() / 1024;
    return positions;
}

TEST(DistantOriginOfPoints, RowOfZerosInASurveyedScan_DoesNotMoveIt) {
    std::vector<Vec3> positions = survey_scan();
    const Vec3 clean = distant_origin(robust_box(positions));
    EXPECT_NEAR(clean.x(), 500'000, 100);
    EXPECT_NEAR(clean.y(), 4'500'000, 100);
    positions[1234] = Vec3::Zero();
    EXPECT_EQ(distant_origin(robust_box(positions)), clean);
    for (const Vec3& p : positions) EXPECT_EQ((clean + (p - clean)).eval(), p);
}

TEST(DistantOriginOfPoints, StrayPointThatWouldLoseBits_KeepsTheOriginOfTheWholeBox) {
    std::vector<Vec3> positions = survey_scan();
    positions[77] = Vec3(0.1, 0.1, 0.1);
    const RobustBox box = robust_box(positions);
    ASSERT_EQ(box.stray.size(), 1u);
    const Vec3 origin = distant_origin(box);
    EXPECT_EQ(origin, distant_origin(box.all));
    for (const Vec3& p : positions) EXPECT_EQ((origin + (p - origin)).eval(), p);
}

}  // namespace
}  // namespace scanmill::test
