// SPDX-License-Identifier: GPL-3.0-or-later
/// Which triangles are found near others.
#include <gmock/gmock.h>

#include <random>

#include "geometry/growing/patch.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "scanmill/geometry/growing/intersections.hpp"

namespace scanmill::growing {
namespace {

/// Separate triangles in a cube of edge 4, and three points in no triangle near each.
class Scattered {
public:
    Scattered(u32 small, u32 large) : patch_(positions(small, large)) {
        for (u32 i = 0; i < small + large; ++i) {
            const u32 first = 6 * ((i * 7) % (small + large));  // 7 divides none of the numbers of triangles used here
            patch_.add(first, first + 1, first + 2);
            added_.push_back({patch_.point(first), patch_.point(first + 1), patch_.point(first + 2)});
        }
    }

    std::vector<u32> unused(u32 i) const {
        return {patch_.point(6 * i + 3), patch_.point(6 * i + 4), patch_.point(6 * i + 5)};
    }
    void join(u32 i, u32 j, u32 k) {
        patch_.add(6 * i + 3, 6 * j + 4, 6 * k + 5);
        added_.push_back({patch_.point(6 * i + 3), patch_.point(6 * j + 4), patch_.point(6 * k + 5)});
    }
    /// Tests all triangles.
    bool intersects_any(const Triangle& triangle) const {
        return std::ranges::any_of(added_, [&](const Triangle& other) {
            return triangles_intersect(patch_.surface().positions, triangle, other);
        });
    }
    const Surface& surface() const { return patch_.surface(); }

private:
    static std::vector<Vec3> positions(u32 small, u32 large) {
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> coordinate(0, 4);
        const auto anywhere = [&] { return Vec3(coordinate(random), coordinate(random), coordinate(random)); };
        std::vector<Vec3> found;
        for (u32 i = 0; i < small + large; ++i) {
            const Vec3 middle = anywhere();
            for (int corner = 0; corner < 6; ++corner) {
                const bool spread = i >= small && corner < 3;
                found.push_back(spread ? anywhere() : middle + 0.1 * (anywhere() - Vec3(2, 2, 2)));
            }
        }
        return found;
    }

    Patch patch_;
    std::vector<Triangle> added_;
};

TEST(NearTriangles_OfManySizes, AreFoundAsByTestingAll) {
    constexpr u32 small = 300, large = 5;
    Scattered scattered(small, large);
    NearTriangles near;
    u32 intersecting = 0;
    const auto compare = [&](u32 i) {
        const std::vector<u32> corners = scattered.unused(i);
        const Triangle triangle{corners[0], corners[1], corners[2]};
        near.gather_around(scattered.surface(), corners);
        const bool expected = scattered.intersects_any(triangle);
        intersecting += expected;
        EXPECT_EQ(near.intersect(scattered.surface(), triangle), expected) << i;
    };
    for (u32 i = 0; i < small; ++i) compare(i);
    EXPECT_GT(intersecting, 20u);
    EXPECT_LT(intersecting, 280u);
    // Large triangles that are added later count as well.
    const u32 before = intersecting;
    for (u32 i = 0; i < 6; ++i) scattered.join(i, 100 + i, 200 + i);
    for (u32 i = 6; i < 100; ++i) compare(i);
    EXPECT_GT(intersecting, before);
}

}  // namespace
}  // namespace scanmill::growing
