// SPDX-License-Identifier: GPL-3.0-or-later
/// Points close to each other: anisotropic sampling uses them all; overlaid scans are merged and thinned first.
#include <gmock/gmock.h>

#include "filters/region_grow/cases.hpp"
#include "merge/merge.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::IsEmpty;

PointCloud merged(const PointCloud& one, const PointCloud& other) {
    const std::vector<std::shared_ptr<const PointCloud>> scans{std::make_shared<const PointCloud>(one),
                                                               std::make_shared<const PointCloud>(other)};
    Context context;
    return merge(scans, {}, context).points;
}

/// Two equal grids, one over the other.
PointCloud two_sheets(double height) { return joined(grid(20, 20), moved(grid(20, 20), 1, Vec3(0, 0, height))); }

TEST(RegionGrow_AnisotropicGrid, UsesEveryPoint) {
    // Pairs of columns 0.4 apart, 2 from pair to pair; rows 1 apart.
    std::vector<Vec3> points;
    for (u32 pair = 0; pair < 20; ++pair)
        for (const double x : {2.0 * pair, 2.0 * pair + 0.4})
            for (u32 y = 0; y < 30; ++y) points.push_back(Vec3(x, y, 0));
    const PointCloud plane = cloud_from(std::move(points));
    for (const PointCloud& cloud : {plane, rotated(plane, 0.7)}) {
        const RegionGrowResult result = grown(cloud);
        expect_consistent(result);
        EXPECT_EQ(result.unused_points, 0u);
        EXPECT_EQ(result.mesh.triangles.size(), 2 * 39u * 29);
        EXPECT_EQ(result.components, 1u);
        EXPECT_EQ(result.loops, 1u);
        EXPECT_NEAR(area(result.mesh), 38.4 * 29, 1e-9);
    }
}

constexpr double voxels_in_spacings = 1.5;

TEST(RegionGrow_SphereAndItsShiftedCopy, MergedAndThinnedAreOneSheet) {
    const PointCloud sphere = fibonacci_sphere(5000);
    const double spacing = std::sqrt(4 * std::numbers::pi / 5000);
    for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0.6, 0.8, 0), Vec3(0.48, 0.6, 0.64), Vec3(0, 0, 1)}) {
        const PointCloud both = merged(sphere, moved(sphere, 1, 0.2 * spacing * way));
        Context context;
        const RegionGrowResult result = region_grow(thinned(both, voxels_in_spacings * spacing), {}, context);
        expect_consistent(result);
        EXPECT_TRUE(topology(result.mesh).closed) << way.transpose();
        EXPECT_EQ(result.components, 1u);
        EXPECT_LE(1000 * result.unused_points, result.rows.size());
        EXPECT_THAT(context.warnings(), IsEmpty());
        // A second sheet would double the area.
        EXPECT_EQ(topology(result.mesh).genus, 0);
        EXPECT_NEAR(area(result.mesh) / (4 * std::numbers::pi), 1, 0.03);
    }
}

TEST(RegionGrow_PlaneAndItsRaisedCopy, MergedAndThinnedAreOneSheet) {
    for (const double angle : {0.0, 0.3, 0.7, 1.2}) {
        const PointCloud both =
            merged(rotated(grid(30, 30), angle), rotated(moved(grid(30, 30), 1, {0, 0, 0.2}), angle));
        const RegionGrowResult result = grown(thinned(both, voxels_in_spacings));
        expect_consistent(result);
        EXPECT_EQ(result.components, 1u) << angle;
        EXPECT_EQ(result.loops, 1u) << angle;
        EXPECT_LE(20 * result.unused_points, result.rows.size()) << angle;
        EXPECT_NEAR(area(result.mesh) / (29 * 29), 1, 0.1) << angle;
    }
}

TEST(RegionGrow_SphereHalfOfWhichIsThereTwice, MergedAndThinnedIsClosed) {
    const PointCloud sphere = fibonacci_sphere(5000);
    const double spacing = std::sqrt(4 * std::numbers::pi / 5000);
    std::vector<Vec3> half;
    for (const Vec3& p : sphere.positions)
        if (p.x() > 0) half.push_back(p + 0.2 * spacing * Vec3(0.48, 0.6, 0.64));
    const RegionGrowResult result = grown(thinned(merged(sphere, cloud_from(half)), voxels_in_spacings * spacing));
    expect_consistent(result);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.components, 1u);
}

TEST(RegionGrow_SheetsLessThanHalfASpacingApart, AreRefusedWithVoxelsThatMakeOneOfThem) {
    // Each point has its copy next to it: no triangle is flat enough.
    for (const double height : {0.001, 0.2, 0.4, 0.5}) {
        const PointCloud sheets = two_sheets(height);
        const std::string text = growth_refusal(sheets);
        ASSERT_THAT(text, HasSubstr("thin with voxels of ")) << height;
        const double bin_size = std::stod(text.substr(text.find("voxels of ") + 10));
        const RegionGrowResult result = grown(thinned(sheets, bin_size));
        expect_consistent(result);
        EXPECT_EQ(result.components, 1u) << height;
        EXPECT_EQ(result.holes, 0u) << height;
        EXPECT_EQ(result.unused_points, 0u) << height;
    }
}

TEST(RegionGrow_BothSidesOfSheetMetal, AreDistinguishedByTheirNormals) {
    for (const double thickness : {0.1, 0.3}) {
        PointCloud metal = two_sheets(thickness);
        Array<double> numbers;
        for (const Vec3& p : metal.positions) numbers.insert(numbers.end(), {0, 0, p.z() > 0 ? 1.0 : -1.0});
        metal.columns.add(Column("normal", 3, Buffer<double>(std::move(numbers))));
        RegionGrowParams params;
        params.search_radius = Length(4);
        Context context;
        const RegionGrowResult result = region_grow(metal, params, context);
        expect_consistent(result);
        EXPECT_EQ(result.unused_points, 0u);
        EXPECT_THAT(context.warnings(), IsEmpty());
        // Each side is whole and faces outwards.
        std::size_t above = 0, below = 0;
        for (const Triangle& t : result.mesh.triangles) {
            const double z = normal_of(result.mesh, t).normalized().z();
            above += z > 0.99;
            below += z < -0.99;
        }
        EXPECT_EQ(above, 2 * 19u * 19);
        EXPECT_EQ(below, 2 * 19u * 19);
    }
}

TEST(RegionGrow_VerticesOfMarchingCubes, CloseIntoOneComponent) {
    // Where the edges of a grid of step 1 cross a sphere: many of them are near corners, and so near each other.
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
    expect_consistent(result);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.components, 1u);
    EXPECT_LE(100 * result.unused_points, 3 * result.rows.size());
}

}  // namespace
}  // namespace scanmill
