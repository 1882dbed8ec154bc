// SPDX-License-Identifier: GPL-3.0-or-later
// The search among open places, beside a loop over all of them.
#include <gtest/gtest.h>

#include <algorithm>

#include "filters/region_grow_cases.hpp"
#include "region_grow/live_places.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill {
namespace {

using namespace test;
using namespace growing;

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
