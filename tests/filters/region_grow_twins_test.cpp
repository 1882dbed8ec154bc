// SPDX-License-Identifier: GPL-3.0-or-later
// Scans laid over each other: every place has a near twin, and the surface takes one of the two.
#include <gmock/gmock.h>

#include "filters/region_grow_cases.hpp"
#include "region_grow/near_twins.hpp"
#include "scanmill/base/random.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

PointCloud thinned(const PointCloud& cloud, double bin) {
    VoxelThinParams params;
    params.bin_size = Length(bin);
    Context context;
    PointCloud kept = voxel_thin(cloud, params, context).points;
    kept.columns = {};
    return kept;
}

/// Every point and it again, each copy moved on its own by up to `offset`.
PointCloud twice(const PointCloud& cloud, double offset) {
    Random random(7);
    std::vector<Vec3> points(cloud.positions.begin(), cloud.positions.end());
    for (const Vec3& p : cloud.positions)
        points.push_back(p + offset / std::sqrt(3) *
                                 Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
    return cloud_from(std::move(points));
}

/// Two equal grids, one over the other.
PointCloud two_sheets(double height) { return joined(grid(20, 20), moved(grid(20, 20), 1, Vec3(0, 0, height))); }

Array<u8> twins_of(const PointCloud& cloud, std::span<const Vec3> facing = {}) {
    const growing::Samples samples = growing::distinct_samples(cloud.positions.span());
    return growing::count_near_twins(samples, growing::Neighbourhoods(samples, 1), facing, 1);
}

TEST(RegionGrow_TwoSheetsUpTo04StepsApart, AreGrownAsOne) {
    for (const double height : {0.001, 0.1, 0.3, 0.4}) {
        Context context;
        const RegionGrowResult result = region_grow(two_sheets(height), {}, context);
        expect_consistent(result);
        EXPECT_EQ(result.mesh.triangles.size(), 2 * 19u * 19) << height;
        EXPECT_EQ(result.components, 1u);
        EXPECT_EQ(result.loops, 1u);
        EXPECT_EQ(result.near_twins, 400u);
        EXPECT_EQ(result.unused_points, 400u);
        // One of the sheets, whole: no triangle stands or leans.
        for (const Vec3& p : result.mesh.positions) EXPECT_EQ(p.z(), result.mesh.positions[0].z());
        EXPECT_THAT(context.warnings(), ElementsAre(AllOf(HasSubstr("400 of 800 distinct points were left out as near"),
                                                          HasSubstr("bins of 1.25 u"))));
    }
}

/// Normals along z, up where `up`.
template <class Up>
PointCloud with_normals(PointCloud cloud, const Up& up) {
    Array<double> numbers;
    for (const Vec3& p : cloud.positions) numbers.insert(numbers.end(), {0, 0, up(p) ? 1.0 : -1.0});
    cloud.columns.add(Column("normal", 3, Buffer<double>(std::move(numbers))));
    return cloud;
}

TEST(RegionGrow_BothSidesOfSheetMetal, AreNoTwinsByTheirNormals) {
    for (const double thickness : {0.1, 0.3}) {
        Context context;
        const PointCloud metal = with_normals(two_sheets(thickness), [](const Vec3& p) { return p.z() > 0; });
        RegionGrowParams params;
        params.search_radius = Length(4);
        const RegionGrowResult result = region_grow(metal, params, context);
        expect_consistent(result);
        EXPECT_EQ(result.near_twins, 0u);
        EXPECT_EQ(result.unused_points, 0u);
        EXPECT_THAT(context.warnings(), IsEmpty());
        // Each side whole, and seen from there.
        std::size_t above = 0, below = 0;
        for (const Triangle& t : result.mesh.triangles) {
            const double z = normal_of(result.mesh, t).normalized().z();
            above += z > 0.99;
            below += z < -0.99;
        }
        EXPECT_EQ(above, 2 * 19u * 19);
        EXPECT_EQ(below, 2 * 19u * 19);
    }
    // One way up they are twins as before, and two layers on either side leave one on each.
    const PointCloud sheets = with_normals(two_sheets(0.3), [](const Vec3&) { return true; });
    EXPECT_EQ(grown(sheets).near_twins, 400u);
    PointCloud layers = joined(two_sheets(0.05), moved(two_sheets(0.05), 1, Vec3(0, 0, 0.3)));
    layers = with_normals(std::move(layers), [](const Vec3& p) { return p.z() > 0.2; });
    const RegionGrowResult result = grown(layers);
    EXPECT_EQ(result.near_twins, 800u);
    EXPECT_EQ(result.unused_points, 800u);
}

TEST(RegionGrow_ScanWithASlightlyMovedCopy, HasAsManyTrianglesAsOneOfThem) {
    const PointCloud scan = thinned(fibonacci_sphere(60'000), 0.06);
    const RegionGrowResult alone = grown(scan);
    for (const double offset : {0.001, 0.003, 0.006}) {
        const RegionGrowResult both = grown(twice(scan, offset));
        expect_consistent(both);
        EXPECT_TRUE(topology(both.mesh).closed) << offset;
        EXPECT_EQ(both.components, 1u);
        EXPECT_NEAR(static_cast<double>(both.mesh.triangles.size()), static_cast<double>(alone.mesh.triangles.size()),
                    0.01 * static_cast<double>(alone.mesh.triangles.size()));
        for (const Triangle& t : both.mesh.triangles) {
            const Vec3 normal = normal_of(both.mesh, t).normalized();
            EXPECT_GT(normal.dot(both.mesh.positions[t[0]]), 0.5) << "a triangle stands";
        }
        EXPECT_EQ(both.unused_points, both.near_twins);
    }
}

TEST(RegionGrow_ScanHalfOfWhichIsThereTwice, IsClosed) {
    const PointCloud scan = thinned(fibonacci_sphere(60'000), 0.06);
    std::vector<Vec3> points(scan.positions.begin(), scan.positions.end());
    for (const Vec3& p : scan.positions)
        if (p.x() > 0) points.push_back(p + Vec3(0.002, 0.003, -0.002));
    const RegionGrowResult result = grown(cloud_from(std::move(points)));
    expect_consistent(result);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_NEAR(static_cast<double>(result.rows.size()), static_cast<double>(scan.size()),
                0.01 * static_cast<double>(scan.size()));
}

TEST(RegionGrow_VerticesOfMarchingCubes, HaveHardlyAnyTwins) {
    // Where the edges of a grid of step 1 cross a sphere: what marching cubes makes of it, many of them near corners.
    const Vec3 centre(0.31, 0.57, 0.83);
    const double radius = 30.2;
    std::vector<Vec3> points;
    for (int axis = 0; axis < 3; ++axis)
        for (int i = -32; i <= 32; ++i)
            for (int j = -32; j <= 32; ++j) {
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                const double beside = std::pow(i - centre[u], 2) + std::pow(j - centre[v], 2);
                if (beside >= radius * radius) continue;
                for (const double side : {-1., 1.}) {
                    Vec3 p;
                    p[axis] = centre[axis] + side * std::sqrt(radius * radius - beside);
                    p[u] = i;
                    p[v] = j;
                    points.push_back(p);
                }
            }
    ASSERT_GT(points.size(), 16000u);
    const RegionGrowResult result = grown(cloud_from(std::move(points)));
    EXPECT_LE(100 * result.near_twins, result.rows.size());
}

TEST(RegionGrow_TheBinsThatTheWarningNames, LeaveNoTwins) {
    const PointCloud scan = twice(thinned(fibonacci_sphere(60'000), 0.06), 0.006);
    Context context;
    region_grow(scan, {}, context);
    ASSERT_THAT(context.warnings(), SizeIs(1));
    const std::string& text = context.warnings()[0];
    const double bin = std::stod(text.substr(text.find("bins of ") + 8));
    EXPECT_NEAR(bin, 0.06, 0.01);
    Context again;
    const RegionGrowResult result = region_grow(thinned(scan, bin), {}, again);
    EXPECT_THAT(again.warnings(), IsEmpty());
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.near_twins, 0u);
}

TEST(RegionGrow_SheetsTooFarApartForTwins, AreRefusedWithBinsThatHelp) {
    // Half a step apart, each standing on the other: no triangle is flat enough.
    const PointCloud sheets = two_sheets(0.5);
    std::string text;
    try {
        grown(sheets);
    } catch (const Error& error) {
        text = error.what();
    }
    ASSERT_THAT(text, HasSubstr("points in layers, thin with bins of "));
    const double bin = std::stod(text.substr(text.find("bins of ") + 8));
    const RegionGrowResult result = grown(thinned(sheets, bin));
    expect_consistent(result);
    EXPECT_EQ(result.components, 1u);
    EXPECT_EQ(result.holes, 0u);
    EXPECT_EQ(result.unused_points, 0u);
}

TEST(NearTwins, ByHand_AreCountedWhereMostHaveSome) {
    // Pairs 0.4 of the step apart; a third point between makes threes.
    EXPECT_THAT(twins_of(two_sheets(0.4)), AllOf(SizeIs(800), Each(1)));
    EXPECT_THAT(twins_of(joined(two_sheets(0.3), moved(grid(20, 20), 1, Vec3(0, 0, 0.15)))),
                AllOf(SizeIs(1200), Each(2)));
    EXPECT_THAT(twins_of(two_sheets(0.46)), IsEmpty());
    EXPECT_THAT(twins_of(grid(20, 20)), IsEmpty());
    // One pair among others that have none.
    EXPECT_THAT(twins_of(joined(grid(20, 20), cloud_of({{5, 5, 0.1}}))), IsEmpty());
}

TEST(NearTwins, ThinnedScans_HaveNone) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        EXPECT_THAT(twins_of(thinned(random_sphere(60'000, seed), 0.06)), IsEmpty());
        EXPECT_THAT(twins_of(thinned(random_cube(60'000, seed), 0.06)), IsEmpty());
    }
}

TEST(RegionGrow_NearTwins, DependNeitherOnOrderNorThreads) {
    const PointCloud scan = twice(thinned(fibonacci_sphere(20'000), 0.1), 0.01);
    const RegionGrowResult one = grown(scan), two = grown(scan, {}, 2);
    EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles));
    EXPECT_GT(one.near_twins, 0u);
    EXPECT_EQ(by_place(grown(shuffled(scan, 5)).mesh), by_place(one.mesh));
}

}  // namespace
}  // namespace scanmill
