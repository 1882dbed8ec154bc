// SPDX-License-Identifier: GPL-3.0-or-later
/// The octree: compared with its definition, and on shapes with flat and curved parts.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <map>

#include "filters/voxel_thin/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"
#include "voxel_thin/octree.hpp"

namespace scanmill::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using voxel::OctreeChoice;

OctreeChoice chosen(const PointCloud& cloud, std::span<const double> sizes, double base, u32 min_points = 1) {
    std::vector<u32> rows(cloud.size());
    for (u32 row = 0; row < rows.size(); ++row) rows[row] = row;
    Context context;
    return voxel::choose_in_octree(cloud.positions.span(), rows, sizes, bounding_box(cloud.positions.span()).low, base,
                                   min_points, context);
}

/// The definition, evaluated cell by cell without codes.
struct ByDefinition {
    const PointCloud& cloud;
    std::span<const double> sizes;
    std::map<u32, double> edge_of_kept = {};

    void divide(const std::vector<u32>& rows, const Vec3& low, double edge) {
        double least = 1e300;
        for (const u32 row : rows) least = std::min(least, sizes[row]);
        if (rows.size() <= 1 || edge <= least) {
            const Vec3 centre = low + Vec3::Constant(edge / 2);
            const auto distance = [&](u32 row) { return (cloud.positions[row] - centre).squaredNorm(); };
            if (!rows.empty()) edge_of_kept[*std::ranges::min_element(rows, {}, distance)] = edge;
            return;
        }
        std::array<std::vector<u32>, 8> children;
        for (const u32 row : rows) {
            const Vec3 offset = cloud.positions[row] - low;
            children[(offset.x() >= edge / 2) * 4u + (offset.y() >= edge / 2) * 2u + (offset.z() >= edge / 2)]
                .push_back(row);
        }
        for (u32 child = 0; child < 8; ++child)
            divide(children[child], low + edge / 2 * Vec3(child >> 2 & 1, child >> 1 & 1, child & 1), edge / 2);
    }
};

TEST(VoxelThinAdaptive, FourPointsByHand_AreDividedAsEachAllows) {
    // Root of edge 4: the left half stays whole, the right half is divided to edges of 1.
    const PointCloud cloud = cloud_of({{0, 0, 0}, {1, 1, 1}, {2.25, 0, 0}, {3.25, 0, 0}});
    const std::vector<double> sizes{2, 2, 1, 1};
    const OctreeChoice choice = chosen(cloud, sizes, 1);
    EXPECT_THAT(choice.rows.kept, ElementsAre(1u, 2u, 3u));
    EXPECT_THAT(choice.rows.members, ElementsAre(2u, 1u, 1u));
    EXPECT_THAT(choice.rows.edges, ElementsAre(2, 1, 1));
    EXPECT_EQ(choice.largest, 2);
    EXPECT_EQ(choice.smallest, 2);
}

TEST(VoxelThinAdaptive, PointAloneInItsLeaf_IsNoiseOnlyIfAloneInItsBasicVoxel) {
    // Basic voxels of 2 hold two points, two points and one; the second is divided into leaves of one point each.
    const PointCloud cloud = cloud_of({{0, 0, 0}, {1, 1, 1}, {2.25, 0, 0}, {3.25, 0, 0}, {6.5, 0, 0}});
    const OctreeChoice choice = chosen(cloud, std::vector<double>{2, 2, 1, 1, 1}, 2, 2);
    EXPECT_THAT(choice.rows.kept, ElementsAre(1u, 2u, 3u));
    EXPECT_THAT(choice.rows.members, ElementsAre(2u, 1u, 1u));
    EXPECT_EQ(choice.rows.voxels, 3u);
    EXPECT_EQ(choice.rows.noise, 1u);
}

TEST(VoxelThinAdaptive, PointAloneInItsBasicVoxel_IsNoiseInALargeLeafToo) {
    // All three may share a leaf of 4, whose centre the last one is nearest to; it is alone in its basic voxel of 1.
    const PointCloud cloud = cloud_of({{0, 0, 0}, {0.5, 0, 0}, {2.25, 2.25, 2.25}});
    const OctreeChoice choice = chosen(cloud, std::vector<double>(3, 4), 1, 2);
    EXPECT_THAT(choice.rows.kept, ElementsAre(1u));
    EXPECT_THAT(choice.rows.members, ElementsAre(2u));
    EXPECT_EQ(choice.rows.noise, 1u);
    EXPECT_THAT(chosen(cloud, std::vector<double>(3, 4), 1, 1).rows.kept, ElementsAre(2u));
    const OctreeChoice nothing = chosen(cloud, std::vector<double>(3, 4), 1, 3);
    EXPECT_TRUE(nothing.rows.kept.empty());
    EXPECT_EQ(nothing.rows.noise, 3u);
}

/// A sphere of radius 10 decides the basic voxels. One of radius 1 forces their division down to single points.
TEST(VoxelThinAdaptive, MinPointsOnACurvedPart_RemovesIsolatedPointsOnly) {
    const PointCloud spheres = joined(moved(fibonacci_sphere(50'000), 10), moved(fibonacci_sphere(700), 1, {30, 0, 0}));
    const PointCloud isolated = cloud_of({{20, 9, 9}, {20, -9, 9}, {25, 9, -9}, {15, -9, -9}, {20, 0, 9}});
    const PointCloud cloud = joined(spheres, isolated);
    VoxelThinParams params = within(0.1, VoxelThinParams::Rule::adaptive);
    params.quantile = Ratio::percent(10);
    const VoxelThinResult all = thin(cloud, params);
    params.min_points = 2;
    const VoxelThinResult result = thin(cloud, params);
    const auto small_sphere = [&](const VoxelThinResult& thinned) {
        return static_cast<double>(
            std::ranges::count_if(thinned.kept, [](u32 row) { return row >= 50'000 && row < 50'700; }));
    };
    std::size_t alone = 0;
    for (std::size_t i = 0; i < all.kept.size(); ++i)
        alone += all.kept[i] >= 50'000 && all.kept[i] < 50'700 && column<u32>(all, "stands-for")[i] == 1;
    ASSERT_GT(static_cast<double>(alone), 0.5 * small_sphere(all)) << "most leaves there hold a single point";
    EXPECT_GT(small_sphere(result), 0.97 * small_sphere(all));
    EXPECT_EQ(std::ranges::count_if(all.kept, [](u32 row) { return row >= 50'700; }), 5);
    EXPECT_EQ(std::ranges::count_if(result.kept, [](u32 row) { return row >= 50'700; }), 0);
    EXPECT_GE(result.noise, 5u);
    EXPECT_EQ(result.kept.size() + result.removed, cloud.size());
    // Noise is what a grid of the basic voxels makes of it.
    VoxelThinParams grid = voxels_of(result.bin_size);
    grid.min_points = 2;
    EXPECT_EQ(result.noise, thin(cloud, grid).noise);
}

TEST(VoxelThinAdaptive, TwoEquallyNear_KeepsTheLowerRow) {
    const PointCloud cloud = cloud_of({{0, 0, 0}, {1.25, 1, 1}, {0.75, 1, 1}, {1, 1.25, 1}});
    EXPECT_THAT(chosen(cloud, std::vector<double>(4, 2), 2).rows.kept, ElementsAre(1u));
}

TEST(VoxelThinAdaptive, Duplicates_AreNeverDivided) {
    const PointCloud cloud = cloud_of({{1, 1, 1}, {0, 0, 0}, {1, 1, 1}});
    const OctreeChoice choice = chosen(cloud, std::vector<double>(3, 1e-300), 1);
    EXPECT_THAT(choice.rows.kept, ElementsAre(0u, 1u));
    EXPECT_THAT(choice.rows.members, ElementsAre(2u, 1u));
}

TEST(VoxelThinAdaptive, RandomSizes_AgreeWithTheDefinition) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const PointCloud cloud = random_cube(3000, seed);
        std::vector<double> sizes;
        for (const Vec3& p : cloud.positions) sizes.push_back(0.02 + 0.3 * p.x() * p.x());
        const OctreeChoice choice = chosen(cloud, sizes, 0.04);
        ByDefinition expected{cloud, sizes};
        std::vector<u32> rows(cloud.size());
        for (u32 row = 0; row < rows.size(); ++row) rows[row] = row;
        expected.divide(rows, bounding_box(cloud.positions.span()).low, 0.04 * 32);
        std::map<u32, double> edges;
        for (std::size_t i = 0; i < choice.rows.kept.size(); ++i) edges[choice.rows.kept[i]] = choice.rows.edges[i];
        EXPECT_EQ(edges, expected.edge_of_kept) << seed;
        EXPECT_TRUE(std::ranges::is_sorted(choice.rows.kept));
        EXPECT_GT(choice.largest, 2 * choice.smallest);
    }
}

TEST(VoxelThinAdaptive, DistantGridOrigin_LeavesAreAsSmall) {
    const PointCloud sphere = fibonacci_sphere(5000);
    VoxelThinParams params = within(0.01, VoxelThinParams::Rule::adaptive);
    const auto near = static_cast<double>(thin(sphere, params).kept.size());
    for (const double margin : {10.0, 1e3, 1e6}) {
        params.margin = Length(margin);
        EXPECT_NEAR(static_cast<double>(thin(sphere, params).kept.size()) / near, 1, 0.1) << margin;
    }
}

TEST(VoxelThinAdaptive, LeavesSmallerThan21Divisions_AreRefused) {
    // The close pair needs leaves of 1e-8; 21 divisions of a root above 10 give 5e-6.
    const PointCloud cloud = cloud_of({{0, 0, 0}, {1e-7, 0, 0}, {10, 10, 10}});
    const Array<double> sizes{1e-8, 1e-8, 1};
    EXPECT_THAT(sentence_of([&] { chosen(cloud, sizes, 1); }), HasSubstr("a point needs 1e-08 u"));
    const PointCloud twice = cloud_of({{0, 0, 0}, {0, 0, 0}, {10, 10, 10}});
    EXPECT_THAT(chosen(twice, sizes, 1).rows.kept, ElementsAre(0u, 2u));
}

TEST(VoxelThinAdaptive, Sphere_KeepsAboutAsManyPointsAsTheQuantile) {
    const PointCloud sphere = fibonacci_sphere(50'000);
    const auto adaptive = thin(sphere, within(0.01, VoxelThinParams::Rule::adaptive)).kept.size();
    const auto quantile = thin(sphere, within(0.01)).kept.size();
    EXPECT_NEAR(static_cast<double>(adaptive) / static_cast<double>(quantile), 1, 0.15);
}

TEST(VoxelThinAdaptive, FlatParts_KeepFarFewerPoints) {
    // A plate with a hemisphere of radius 1 on it: the plate allows the largest voxels, the hemisphere small ones.
    Array<Vec3> points;
    for (int i = -100; i <= 100; ++i)
        for (int j = -100; j <= 100; ++j)
            if (const Vec3 p(0.05 * i, 0.05 * j, 0); p.norm() > 1) points.push_back(p);
    for (const Vec3& p : fibonacci_sphere(8000).positions)
        if (p.z() > 0) points.push_back(p);
    const PointCloud cloud{{}, std::move(points), {}};
    const VoxelThinResult adaptive = thin(cloud, within(0.01, VoxelThinParams::Rule::adaptive));
    const VoxelThinResult quantile = thin(cloud, within(0.01));
    const auto counts = [](const VoxelThinResult& result) {
        std::array<double, 2> plate_and_ball{};
        for (const Vec3& p : result.points.positions) ++plate_and_ball[p.z() > 0.2];
        return plate_and_ball;
    };
    EXPECT_LT(counts(adaptive)[0], 0.3 * counts(quantile)[0]);
    // The size that the sphere allows, which no leaf there exceeds.
    EXPECT_GT(counts(adaptive)[1], 0.95 * counts(thin(cloud, voxels_of(std::sqrt(0.01 / 3))))[1]);
}

}  // namespace
}  // namespace scanmill::test
