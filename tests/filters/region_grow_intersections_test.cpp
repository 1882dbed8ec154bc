// SPDX-License-Identifier: GPL-3.0-or-later
/// Whether triangles intersect, and which triangles are found near others.
#include <gmock/gmock.h>

#include <random>

#include "filters/region_grow_patch.hpp"
#include "region_grow/intersections.hpp"

namespace scanmill::growing {
namespace {

/// Separate triangles in the cube of edge 4, and three places beside each that are on none.
class Scattered {
public:
    Scattered(u32 small, u32 large) : patch_(positions(small, large)) {
        for (u32 i = 0; i < small + large; ++i) {
            const u32 first = 6 * ((i * 7) % (small + large));  // 7 divides no number of them that is used here
            patch_.add(first, first + 1, first + 2);
            added_.push_back({patch_.place(first), patch_.place(first + 1), patch_.place(first + 2)});
        }
    }

    std::vector<u32> loose(u32 i) const {
        return {patch_.place(6 * i + 3), patch_.place(6 * i + 4), patch_.place(6 * i + 5)};
    }
    void join(u32 i, u32 j, u32 k) {
        patch_.add(6 * i + 3, 6 * j + 4, 6 * k + 5);
        added_.push_back({patch_.place(6 * i + 3), patch_.place(6 * j + 4), patch_.place(6 * k + 5)});
    }
    /// Of all triangles.
    bool meets_any(const Triangle& triangle) const {
        return std::ranges::any_of(
            added_, [&](const Triangle& other) { return meet(patch_.surface().positions, triangle, other); });
    }
    const Surface& surface() const { return patch_.surface(); }

private:
    static std::vector<Vec3> positions(u32 small, u32 large) {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> anywhere(0, 4);
        const auto place = [&] { return Vec3(anywhere(random), anywhere(random), anywhere(random)); };
        std::vector<Vec3> found;
        for (u32 i = 0; i < small + large; ++i) {
            const Vec3 middle = place();
            for (int corner = 0; corner < 6; ++corner) {
                const bool spread = i >= small && corner < 3;
                found.push_back(spread ? place() : middle + 0.1 * (place() - Vec3(2, 2, 2)));
            }
        }
        return found;
    }

    Patch patch_;
    std::vector<Triangle> added_;
};

TEST(RegionGrowNearTriangles_OfManySizes, AreMetAsByAskingAll) {
    constexpr u32 small = 300, large = 5;
    Scattered scattered(small, large);
    NearTriangles near;
    u32 met = 0;
    const auto compare = [&](u32 i) {
        const std::vector<u32> corners = scattered.loose(i);
        const Triangle triangle{corners[0], corners[1], corners[2]};
        near.gather_round(scattered.surface(), corners);
        const bool expected = scattered.meets_any(triangle);
        met += expected;
        EXPECT_EQ(near.meet(scattered.surface(), triangle), expected) << i;
    };
    for (u32 i = 0; i < small; ++i) compare(i);
    EXPECT_GT(met, 20u);
    EXPECT_LT(met, 280u);
    // Large ones that came later count as well.
    const u32 before = met;
    for (u32 i = 0; i < 6; ++i) scattered.join(i, 100 + i, 200 + i);
    for (u32 i = 6; i < 100; ++i) compare(i);
    EXPECT_GT(met, before);
}

const std::vector<Vec3> places{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0), Vec3(1, 1, -1), Vec3(1, 1, 1),
                               Vec3(5, 5, 0), Vec3(1, 1, 0), Vec3(9, 9, 5), Vec3(9, 8, 5),  Vec3(8, 9, 5)};

TEST(RegionGrowMeet_Triangles, MeetBeyondTheirCommonCornersAndEdges) {
    const auto met = [](const Triangle& one, const Triangle& other) {
        EXPECT_EQ(meet(places, one, other), meet(places, other, one));
        return meet(places, one, other);
    };
    const Triangle floor{0, 1, 2};
    EXPECT_TRUE(met(floor, {3, 4, 5})) << "stabs it";
    EXPECT_FALSE(met(floor, {7, 8, 9})) << "far away";
    EXPECT_TRUE(met(floor, {6, 7, 8})) << "a corner of the other lies in it";
    EXPECT_FALSE(met(floor, {0, 7, 8})) << "one common corner";
    EXPECT_TRUE(met(floor, {0, 3, 4})) << "one common corner, and the edge opposite stabs it";
    EXPECT_TRUE(met(floor, {0, 6, 7})) << "one common corner, and a corner in it";
    EXPECT_FALSE(met(floor, {2, 1, 5})) << "the next triangle in its plane";
    EXPECT_FALSE(met(floor, {2, 1, 4})) << "bent up at a common edge";
    EXPECT_TRUE(met(floor, {2, 1, 6})) << "folded flat onto it";
    EXPECT_TRUE(met(floor, {1, 2, 0})) << "itself";
}

}  // namespace
}  // namespace scanmill::growing
