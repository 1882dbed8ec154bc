// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/hole_triangulation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;
using Corners = std::array<u32, 3>;
constexpr double impossible = HoleTriangulation::impossible;

TEST(HoleTriangulation, InATie_TakesTheLowestCorners_AndListsTrianglesAfterThoseBeyondTheirEdges) {
    HoleTriangulation hole;
    const auto any = [](u32, u32, u32) { return true; };
    ASSERT_TRUE(hole.solve(
        5, [](u32, u32) { return 0.0; }, [](u32, u32, u32) { return 1.0; }, any));
    EXPECT_THAT(hole.triangles(), ElementsAre(Corners{2, 3, 4}, Corners{1, 2, 4}, Corners{0, 1, 4}));
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
            const auto any = [](u32, u32, u32) { return true; };
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
