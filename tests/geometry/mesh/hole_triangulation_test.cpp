// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/hole_triangulation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;
using Corners = std::array<u32, 3>;
constexpr double impossible = HoleTriangulation::impossible;

const auto free_edge = [](u32, u32) { return 0.0; };
const auto one = [](u32, u32, u32) { return 1.0; };
const auto any = [](u32, u32, u32) { return true; };

TEST(HoleTriangulation, OfATriangle_AsksForNoEdge) {
    HoleTriangulation hole;
    ASSERT_TRUE(hole.solve(
        3, [](u32, u32) { return impossible; }, one, any));
    EXPECT_THAT(hole.triangles(), ElementsAre(Corners{0, 1, 2}));
}

TEST(HoleTriangulation, InATie_TakesTheLowestCorners_AndListsTrianglesAfterThoseBeyondTheirEdges) {
    HoleTriangulation hole;
    ASSERT_TRUE(hole.solve(5, free_edge, one, any));
    EXPECT_THAT(hole.triangles(), ElementsAre(Corners{2, 3, 4}, Corners{1, 2, 4}, Corners{0, 1, 4}));
}

TEST(HoleTriangulation, TheCostOfAnEdge_CountsOnce) {
    // With 0 2, a square's triangles cost 2 and the edge 3; with 1 3 they cost 4 and the edge 0.5.
    const auto edge = [](u32 i, u32) { return i == 0 ? 3.0 : 0.5; };
    const auto triangle = [](u32 i, u32 k, u32 j) { return i == 0 && (k == 2 || j == 2) ? 1.0 : 2.0; };
    HoleTriangulation hole;
    ASSERT_TRUE(hole.solve(4, edge, triangle, any));
    EXPECT_THAT(hole.triangles(), ElementsAre(Corners{1, 2, 3}, Corners{0, 1, 3}));
}

TEST(HoleTriangulation, WithoutAPossibleOne_IsNotFound) {
    HoleTriangulation hole;
    EXPECT_FALSE(hole.solve(
        4, [](u32, u32) { return impossible; }, one, any));
    EXPECT_FALSE(hole.solve(
        4, free_edge, [](u32, u32, u32) { return impossible; }, any));
    EXPECT_FALSE(hole.solve(4, free_edge, one, [](u32, u32, u32) { return false; }));
}

TEST(HoleTriangulation, OfRandomCosts_IsTheLeastOfAllTriangulations) {
    Random random(3);
    for (u32 corners = 3; corners < 9; ++corners)
        for (int round = 0; round < 20; ++round) {
            std::vector<double> edges(corners * corners), triangles(corners * corners * corners);
            for (double& cost : edges) cost = random.index(5) == 0 ? impossible : random.uniform();
            for (double& cost : triangles) cost = random.index(8) == 0 ? impossible : random.uniform();
            const auto edge = [&](u32 i, u32 j) { return edges[i * corners + j]; };
            const auto triangle = [&](u32 i, u32 k, u32 j) { return triangles[(i * corners + k) * corners + j]; };
            const std::function<double(u32, u32)> least = [&](u32 i, u32 j) {
                if (j == i + 1) return 0.0;
                double best = impossible;
                for (u32 k = i + 1; k < j; ++k) best = std::min(best, least(i, k) + least(k, j) + triangle(i, k, j));
                return best + (j - i + 1 == corners ? 0.0 : edge(i, j));
            };
            HoleTriangulation hole;
            std::vector<std::pair<u32, u32>> asked;
            const auto asked_once = [&](u32 i, u32 j) {
                EXPECT_EQ(std::ranges::count(asked, std::pair(i, j)), 0);
                asked.emplace_back(i, j);
                return edge(i, j);
            };
            const double expected = least(0, corners - 1);
            ASSERT_EQ(hole.solve(corners, asked_once, triangle, any), expected < impossible);
            if (expected == impossible) continue;
            double sum = 0;
            for (const auto& [i, k, j] : hole.triangles()) {
                sum += triangle(i, k, j);
                if (j - i + 1 < corners) sum += edge(i, j);
            }
            EXPECT_EQ(hole.triangles().size(), corners - 2);
            EXPECT_NEAR(sum, expected, 1e-12);
        }
}

}  // namespace
}  // namespace scanmill
