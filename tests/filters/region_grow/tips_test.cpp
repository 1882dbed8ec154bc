// SPDX-License-Identifier: GPL-3.0-or-later
/// Where a surface is not flat: tips, edges and folds narrower than the voxels that their points were thinned with.
#include <gmock/gmock.h>

#include <functional>

#include "filters/region_grow/cases.hpp"
#include "measure/measure.hpp"
#include "scanmill/base/random.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill {
namespace {

using namespace test;

constexpr double voxel = 0.2;

PointCloud thinned_cloud(std::vector<Vec3> points) {
    VoxelThinParams params;
    params.bin_size = Length(voxel);
    Context context;
    return voxel_thin(cloud_from(std::move(points)), params, context).points;
}

std::vector<Vec3> sampled(std::size_t count, std::uint64_t seed, const std::function<Vec3(Random&)>& point) {
    Random random(seed);
    std::vector<Vec3> points;
    while (points.size() < count) points.push_back(point(random));
    return points;
}

std::size_t intersections_of(const TriangleMesh& mesh) {
    MeasureParams params;
    params.samples = 100;
    Context context;
    return measure(mesh, mesh, params, context).self_intersections.value();
}

/// One component with one boundary, as a disc has, without self-intersections.
void expect_disc(const RegionGrowResult& result) {
    expect_consistent(result);
    EXPECT_EQ(result.components, 1u);
    EXPECT_EQ(result.loops, 1u);
    EXPECT_EQ(topology(result.mesh).euler, 1);
    EXPECT_EQ(intersections_of(result.mesh), 0u);
}

double degrees(double angle) { return angle / 180 * std::numbers::pi; }

/// 10 high, its tip at the origin.
PointCloud cone(double half_angle, std::uint64_t seed) {
    return thinned_cloud(sampled(40000, seed, [&](Random& random) {
        const double down = 10 * std::sqrt(random.uniform(0, 1)), turn = random.uniform(0, 2 * std::numbers::pi);
        const double radius = down * std::tan(degrees(half_angle));
        return Vec3(radius * std::cos(turn), radius * std::sin(turn), -down);
    }));
}

TEST(RegionGrowTips_Cones, AreClosedAtTheTipAndOpenAtTheBase) {
    for (const double half_angle : {12, 18, 25, 35})
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            SCOPED_TRACE(testing::Message() << half_angle << " degrees, seed " << seed);
            expect_disc(grown(cone(half_angle, seed)));
        }
}

/// Two planes at an angle of `opening`, 6 wide and 10 long, rounded where they meet.
PointCloud edge(double opening, double radius, std::uint64_t seed) {
    const double half = degrees(opening / 2), arc = std::numbers::pi - 2 * half, side = 6;
    return thinned_cloud(sampled(50000, seed, [&](Random& random) {
        const double along = random.uniform(-side - radius * arc / 2, side + radius * arc / 2);
        const double beyond = std::max(0.0, std::abs(along) - radius * arc / 2);
        const double angle = radius > 0 ? std::clamp(along / radius, -arc / 2, arc / 2) : std::copysign(arc / 2, along);
        return Vec3(radius * std::cos(angle) - beyond * std::cos(half), random.uniform(0, 10),
                    radius * std::sin(angle) + std::copysign(beyond * std::sin(half), along));
    }));
}

TEST(RegionGrowTips_EdgesOf60Degrees, AreClosedSharpOrRounded) {
    for (const double radius : {0.0, 0.1, 0.15})
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            SCOPED_TRACE(testing::Message() << "radius " << radius << ", seed " << seed);
            expect_disc(grown(edge(60, radius, seed)));
        }
    // A quarter of a voxel is the hardest: points of either plane lie inside the rounding.
    std::size_t holes = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) holes += grown(edge(60, 0.05, seed)).loops - 1;
    EXPECT_LE(holes, 1u);
}

TEST(RegionGrowTips_SpikesOnAPlate, AreClosed) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE(seed);
        const double slope = std::tan(degrees(20)), height = 4, foot = height * slope;
        const double cone = std::numbers::pi * foot * std::hypot(foot, height), plate = 36;
        expect_disc(grown(thinned_cloud(sampled(40000, seed, [&](Random& random) {
            if (random.uniform(0, cone + plate) < cone) {
                const double down = height * std::sqrt(random.uniform(0, 1));
                const double turn = random.uniform(0, 2 * std::numbers::pi);
                return Vec3(down * slope * std::cos(turn), down * slope * std::sin(turn), height - down);
            }
            for (;;) {
                const Vec3 p(random.uniform(-3, 3), random.uniform(-3, 3), 0);
                if (p.norm() >= foot) return p;
            }
        }))));
    }
}

TEST(RegionGrowTips_RidgesThatSag, AreClosed) {
    // z = 2 cos y exp(-(x / 0.4)²): steep to both sides, and a saddle along its top.
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE(seed);
        expect_disc(grown(thinned_cloud(sampled(50000, seed, [](Random& random) {
            for (;;) {
                const double x = random.uniform(-2, 2), y = random.uniform(-3, 3), w = x / 0.4;
                const double z = 2 * std::cos(y) * std::exp(-w * w);
                const double steep = std::hypot(1, z * 2 * w / 0.4, 2 * std::sin(y) * std::exp(-w * w));
                if (random.uniform(0, 6) < steep) return Vec3(x, y, z);
            }
        }))));
    }
}

TEST(RegionGrowTips_TooNarrowForTheVoxels, DoesNotIntersectItself) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE(seed);
        for (const PointCloud& cloud :
             {cone(8, seed), cone(10, seed), edge(50, 0, seed), edge(40, 0.05, seed), edge(20, 0, seed)}) {
            const RegionGrowResult result = grown(cloud);
            expect_consistent(result);
            EXPECT_EQ(intersections_of(result.mesh), 0u);
        }
    }
}

TEST(RegionGrowTips_SheetsThatCross, DoNotIntersect) {
    // z = ± 0.3 x; no rule in a tangent plane can decide how either continues where they meet.
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const RegionGrowResult result = grown(cloud_from(sampled(6000, seed, [](Random& random) {
            const double x = random.uniform(-3, 3), y = random.uniform(-3, 3);
            return Vec3(x, y, random.uniform(-1, 1) < 0 ? 0.3 * x : -0.3 * x);
        })));
        expect_consistent(result);
        EXPECT_EQ(intersections_of(result.mesh), 0u) << seed;
    }
}

TEST(RegionGrowTips_PointsOfNoSurface, GiveNoSelfIntersection) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed)
        EXPECT_EQ(intersections_of(grown(random_cube(2000, seed)).mesh), 0u) << seed;
}

/// An open box: grids of step 1 at y = 0 and y = width, joined by a floor and, if asked for, by ends.
PointCloud box(u32 length, u32 width, u32 height, bool ends) {
    std::vector<Vec3> points;
    for (u32 x = 0; x <= length; ++x)
        for (u32 y = 0; y <= width; ++y)
            for (u32 z = 0; z <= height; ++z)
                if (y == 0 || y == width || z == 0 || (ends && (x == 0 || x == length)))
                    points.push_back(Vec3(x, y, z));
    return cloud_from(std::move(points));
}

TEST(RegionGrowTips_ThinWallsAndChannels, StayOpen) {
    // A grid of step 1 is as dense as voxels of 1.25 leave points: 4 apart is a little more than 3 voxels.
    for (const u32 width : {3u, 4u, 6u})
        for (const bool ends : {true, false}) {
            const RegionGrowResult result = grown(box(30, width, 8, ends));
            expect_consistent(result);
            EXPECT_EQ(result.components, 1u);
            EXPECT_EQ(result.loops, 1u);
            EXPECT_EQ(topology(result.mesh).euler, 1);
        }
}

TEST(RegionGrowTips_NarrowStrips, AreNotClosedIntoASolid) {
    // Two rows on either side of an edge: the gap behind is narrow, but not a hole.
    for (const double angle : {20.0, 60.0, 90.0}) {
        std::vector<Vec3> points;
        for (u32 y = 0; y < 12; ++y)
            for (int across = -2; across <= 2; ++across)
                points.push_back(
                    Vec3(across * std::cos(degrees(angle / 2)), y, -std::abs(across) * std::sin(degrees(angle / 2))));
        const RegionGrowResult result = grown(cloud_from(std::move(points)));
        expect_consistent(result);
        EXPECT_EQ(result.loops, 1u) << angle;
        EXPECT_EQ(topology(result.mesh).euler, 1) << angle;
    }
}

TEST(RegionGrowTips_CloseHolesOf0, LeavesEveryLoopOpen) {
    RegionGrowParams params;
    params.close_holes = 0;
    std::size_t loops = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const RegionGrowResult result = grown(cone(12, seed), params);
        expect_consistent(result);
        EXPECT_EQ(result.closed_holes, 0u);
        EXPECT_THAT(result.passes, testing::Each(testing::Lt(4)));
        loops += result.loops;
    }
    EXPECT_GT(loops, 4u);
}

}  // namespace
}  // namespace scanmill
