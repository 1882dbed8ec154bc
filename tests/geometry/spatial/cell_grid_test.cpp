// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/cell_grid.hpp"

#include <gmock/gmock.h>

#include "scanmill/base/random.hpp"

namespace scanmill::test {
namespace {

TEST(CellGrid, NumbersCells_InTheOrderInWhichTheyAreEntered) {
    CellGrid grid(Vec3(1, 0, 0), 2);
    EXPECT_EQ(grid.enter({1, 0, 0}), 0u);
    EXPECT_EQ(grid.enter({0.9, 0, 0}), 1u) << "below the origin is another cell";
    EXPECT_EQ(grid.enter({2.9, 1.9, 1.9}), 0u);
    EXPECT_EQ(grid.enter({3, 0, 0}), 2u) << "a cell contains its low border, not its high one";
}

TEST(CellGrid, AnyNear_VisitsThePointsOwnCellFirst_AndThoseThatTouchIt) {
    CellGrid grid(Vec3::Zero(), 1);
    for (const double x : {5.5, 6.5, 7.5, 8.5}) grid.enter({x, 0.5, 0.5});
    std::vector<u32> visited;
    const auto visit = [&](u32 cell) {
        visited.push_back(cell);
        return false;
    };
    EXPECT_FALSE(grid.any_near({6.1, 1.5, -0.5}, visit));
    EXPECT_THAT(visited, testing::UnorderedElementsAre(0, 1, 2));
    visited.clear();
    EXPECT_FALSE(grid.any_near({7.1, 0.9, 0.1}, visit));
    EXPECT_EQ(visited.front(), 2u);
    EXPECT_FALSE(grid.any_near({20, 0, 0}, visit));
}

TEST(CellGrid, PointsWithinTheDistance_AreFoundAsByBruteForce) {
    Random random(4);
    const double radius = 0.1;
    const auto point = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
    CellGrid grid(BoundingBox{Vec3::Constant(-1), Vec3::Constant(1)}, radius);
    std::vector<std::vector<Vec3>> by_cell;
    std::vector<Vec3> points;
    int hits = 0;
    for (int i = 0; i < 6000; ++i) {
        const Vec3 p = point();
        const auto is_near = [&](const Vec3& q) { return (p - q).norm() < radius; };
        const bool expected = std::ranges::any_of(points, is_near);
        ASSERT_EQ(grid.any_near(p, [&](u32 cell) { return std::ranges::any_of(by_cell[cell], is_near); }), expected);
        hits += expected;
        const u32 cell = grid.enter(p);
        if (cell == by_cell.size()) by_cell.emplace_back();
        by_cell[cell].push_back(p);
        points.push_back(p);
    }
    EXPECT_GT(hits, 1000);
}

TEST(CellGrid, OfADistanceThatTheBoxIsManyTimesAsLongAs_StillFindsIt) {
    const double distance = 1e-9;
    CellGrid grid(BoundingBox{Vec3::Zero(), Vec3::Constant(1e3)}, distance);
    const u32 cell = grid.enter({1e3 - distance, 500, 0});
    EXPECT_TRUE(grid.any_near({1e3, 500, 0}, [&](u32 found) { return found == cell; }));
}

}  // namespace
}  // namespace scanmill::test
