// SPDX-License-Identifier: GPL-3.0-or-later
/// Ties between equally good points, and the search among open points.
#include <gtest/gtest.h>

#include <algorithm>

#include "filters/region_grow/cases.hpp"
#include "region_grow/suitable_point.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

using namespace growing;
using namespace test;

constexpr Limits generous{0.1, 0, 0, 0.5, 0.5, 1, 0};

/// A triangle below the edge from (0, 0) to (4, 0), and two points above that see the edge under equal angles.
struct TwoAbove {
    DistinctPoints points = distinct_points_of(
        cloud_of({{0, 0, 0}, {4, 0, 0}, {2, -3, 0}, {1, 3, 0}, {3, 3, 0}, {0, 60, 0}, {60, 0, 0}}).positions.span());
    Neighbourhoods neighbourhoods{points, 1};
    Surface surface = made();

    Surface made() const {
        Surface flat(points, neighbourhoods, principal_normals(points, neighbourhoods, 1),
                     Array<double>(points.size(), 40), Array<double>(points.size(), 40), false);
        for (Vec3& normal : flat.normals) normal = Vec3::UnitZ();
        return flat;
    }
    u32 at(double x, double y) const {
        const Vec3 p = Vec3(x, y, 0);
        return static_cast<u32>(std::ranges::find(points.positions, p) - points.positions.begin());
    }
    u32 lower_of_the_two() const { return std::min(at(1, 3), at(3, 3)); }
};

TEST(RegionGrow_Ties, BoundaryEdge_ChoosesTheLowerOfTwo) {
    for (const Score score : {Score::circumradius, Score::midpoint})
        for (const bool wide : {false, true}) {
            TwoAbove two;
            two.surface.add({two.at(0, 0), two.at(2, -3), two.at(4, 0)}, 0);
            PointChooser chooser(two.surface, score);
            // The triangle's own edge from (4, 0) to (0, 0).
            EXPECT_EQ(chooser.choose(two.at(4, 0), two.at(0, 0), generous, wide, true).point, two.lower_of_the_two())
                << wide;
        }
}

TEST(RegionGrow_Ties, Seed_ChoosesTheLowerOfTwo) {
    TwoAbove two;
    two.surface.states[two.at(2, -3)] = PointState::interior;
    PointChooser chooser(two.surface, Score::circumradius);
    EXPECT_EQ(chooser.choose_third(two.at(0, 0), two.at(4, 0), generous), two.lower_of_the_two());
    EXPECT_EQ(chooser.choose_third(two.at(4, 0), two.at(0, 0), generous), two.lower_of_the_two());
}

TEST(RegionGrow_Ties, EquallyFlatPoints_StartAtTheLowest) {
    // All are equally flat. The seed is the lowest point with its nearest, of equally near ones the first by x and y.
    const PointCloud square = grid(2, 2);
    const DistinctPoints points = distinct_points_of(square.positions.span());
    const RegionGrowResult result = grown(square);
    const Triangle& first = result.mesh.triangles[0];
    const auto is_corner = [&](u32 point) { return std::ranges::find(first, points.rows[point]) != first.end(); };
    EXPECT_TRUE(is_corner(0) && is_corner(1) && is_corner(2) && !is_corner(3));
}

TEST(RegionGrow_OpenPoints, FoundByTheTree_AreThoseOfALoopOverAll) {
    for (const std::size_t count : {2u, 16u, 17u, 700u}) {
        const DistinctPoints points = distinct_points_of(random_cube(count, count).positions.span());
        const Neighbourhoods neighbourhoods(points, 1);
        Surface surface(points, neighbourhoods, principal_normals(points, neighbourhoods, 1),
                        Array<double>(points.size(), 1), Array<double>(points.size(), 1), false);
        OpenPoints open(surface);
        Random random(3);
        for (int turn = 0; turn < 400; ++turn) {
            const auto any = [&] { return static_cast<u32>(random.uniform() * static_cast<double>(points.size())); };
            // More and more points become interior; those on the boundary stay open.
            for (int i = 0; i < 3; ++i)
                if (PointState& state = surface.states[any()]; state == PointState::unused)
                    state = i == 0 ? PointState::front : PointState::interior;
            const u32 point = any();
            const double squared = random.uniform();
            std::vector<u32> found, expected;
            open.within(point, squared, found);
            for (u32 other = 0; other < points.size(); ++other)
                if (other != point && surface.states[other] <= PointState::front &&
                    (points.positions[other] - points.positions[point]).squaredNorm() < squared)
                    expected.push_back(other);
            ASSERT_EQ(found, expected) << count << ", turn " << turn;
        }
    }
}

}  // namespace
}  // namespace scanmill
