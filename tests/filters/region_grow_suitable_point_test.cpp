// SPDX-License-Identifier: GPL-3.0-or-later
/// Which point an edge takes of equally good ones, and the search for points that a triangle may still take.
#include <gtest/gtest.h>

#include <algorithm>

#include "filters/region_grow_cases.hpp"
#include "region_grow/suitable_point.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

using namespace growing;
using namespace test;

constexpr Limits generous{0.1, 0, 0, 0.5, 0.5, 1, 0};

/// A triangle below the x axis from (0, 0) to (4, 0), and two places above that see that edge under one angle.
struct TwoAbove {
    Samples samples = distinct_samples(
        cloud_of({{0, 0, 0}, {4, 0, 0}, {2, -3, 0}, {1, 3, 0}, {3, 3, 0}, {0, 60, 0}, {60, 0, 0}}).positions.span());
    Neighbourhoods neighbourhoods{samples, 1};
    Surface surface = made();

    Surface made() const {
        Surface on(samples, neighbourhoods, principal_normals(samples, neighbourhoods, 1),
                   Array<double>(samples.size(), 40), Array<double>(samples.size(), 40), false);
        for (Vec3& normal : on.normals) normal = Vec3::UnitZ();
        return on;
    }
    u32 at(double x, double y) const {
        const Vec3 p = Vec3(x, y, 0);
        return static_cast<u32>(std::ranges::find(samples.positions, p) - samples.positions.begin());
    }
    u32 lower_of_the_two() const { return std::min(at(1, 3), at(3, 3)); }
};

TEST(RegionGrow_Ties, AnEdgeOfTheFrontTakesTheLowerOfTwo) {
    for (const Score score : {Score::circumradius, Score::midpoint})
        for (const bool far : {false, true}) {
            TwoAbove two;
            two.surface.add({two.at(0, 0), two.at(2, -3), two.at(4, 0)}, 0);
            PointChooser chooser(two.surface, score);
            // The triangle's own edge from (4, 0) to (0, 0).
            EXPECT_EQ(chooser.choose(two.at(4, 0), two.at(0, 0), generous, far, true).point, two.lower_of_the_two())
                << far;
        }
}

TEST(RegionGrow_Ties, ASeedTakesTheLowerOfTwo) {
    TwoAbove two;
    two.surface.states[two.at(2, -3)] = PlaceState::interior;
    PointChooser chooser(two.surface, Score::circumradius);
    EXPECT_EQ(chooser.choose_third(two.at(0, 0), two.at(4, 0), generous), two.lower_of_the_two());
    EXPECT_EQ(chooser.choose_third(two.at(4, 0), two.at(0, 0), generous), two.lower_of_the_two());
}

TEST(RegionGrow_Ties, TheFlattestPlacesBeginWithTheLowest) {
    // All are equally flat. The seed is the lowest place with its nearest, of equally near ones the first by x and y.
    const PointCloud square = grid(2, 2);
    const Samples samples = distinct_samples(square.positions.span());
    const RegionGrowResult result = grown(square);
    const Triangle& first = result.mesh.triangles[0];
    const auto is_corner = [&](u32 place) { return std::ranges::find(first, samples.rows[place]) != first.end(); };
    EXPECT_TRUE(is_corner(0) && is_corner(1) && is_corner(2) && !is_corner(3));
}

TEST(LivePlaces, WhileTheSurfaceClosesOverThem_AreThoseOfALoop) {
    for (const std::size_t count : {2u, 16u, 17u, 700u}) {
        const Samples samples = distinct_samples(random_cube(count, count).positions.span());
        const Neighbourhoods neighbourhoods(samples, 1);
        Surface surface(samples, neighbourhoods, principal_normals(samples, neighbourhoods, 1),
                        Array<double>(samples.size(), 1), Array<double>(samples.size(), 1), false);
        LivePlaces live(surface);
        Random random(3);
        for (int turn = 0; turn < 400; ++turn) {
            const auto any = [&] { return static_cast<u32>(random.uniform() * static_cast<double>(samples.size())); };
            // More and more are closed; some are of the front, and stay open.
            for (int i = 0; i < 3; ++i)
                if (PlaceState& state = surface.states[any()]; state == PlaceState::unused)
                    state = i == 0 ? PlaceState::front : PlaceState::interior;
            const u32 place = any();
            const double squared = random.uniform();
            std::vector<u32> found, expected;
            live.within(place, squared, found);
            for (u32 other = 0; other < samples.size(); ++other)
                if (other != place && surface.states[other] <= PlaceState::front &&
                    (samples.positions[other] - samples.positions[place]).squaredNorm() < squared)
                    expected.push_back(other);
            ASSERT_EQ(found, expected) << count << ", turn " << turn;
        }
    }
}

}  // namespace
}  // namespace scanmill
