// SPDX-License-Identifier: GPL-3.0-or-later
/// Loops at parts that are too thin for the spacing of the points.
#include <gmock/gmock.h>

#include <numbers>

#include "filters/region_grow/cases.hpp"
#include "geometry/growing/patch.hpp"
#include "region_grow/boundaries.hpp"
#include "support/doubts.hpp"

namespace scanmill::growing {
namespace {

using namespace test;

/// Two square sheets of four points, side 1, one `gap` above the other. The upper one faces up, the lower one down if
/// `apart`. If `joined`, a fifth point beside them connects them.
Patch sheets(double gap, bool apart, bool joined = false) {
    std::vector<Vec3> positions{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    for (int i = 0; i < 4; ++i) positions.push_back(positions[static_cast<std::size_t>(i)] + Vec3(0, 0, gap));
    positions.push_back(Vec3(-0.3, 0.5, gap / 2));
    for (int i = 0; i < 20; ++i) positions.push_back(Vec3(0, 100 + i % 5, 100 + i / 5));  // 16 neighbours for all
    Patch patch(positions);
    Surface& surface = patch.surface();
    for (u32 i = 0; i < 9; ++i) surface.normals[patch.point(i)] = Vec3(0, 0, i < 4 && apart ? -1 : 1);
    patch.add(4, 5, 6), patch.add(4, 6, 7);
    if (apart)
        patch.add(0, 2, 1), patch.add(0, 3, 2);
    else
        patch.add(0, 1, 2), patch.add(0, 2, 3);
    if (joined) patch.add(0, 4, 8), patch.add(4, 7, 8), patch.add(7, 3, 8), patch.add(3, 0, 8);
    for (u32 i = 0; i < 9; ++i) patch.set_search_radius(i, 2 * std::numbers::sqrt3);  // voxels of 1
    return patch;
}

ThinParts thin_parts(const Patch& patch) {
    return find_thin_parts(patch.surface(), find_components(patch.surface()), Context());
}

TEST(RegionGrowThinParts_TwoSheets, AreThinBelowThreeVoxels) {
    const ThinParts thin = thin_parts(sheets(2.5, true));
    EXPECT_EQ(thin.loops, 2u);
    EXPECT_DOUBLE_EQ(thin.least, 2.5);
    EXPECT_DOUBLE_EQ(thin.voxel, 1);
    EXPECT_EQ(thin_parts(sheets(2.999, true)).loops, 2u);
    EXPECT_EQ(thin_parts(sheets(3.001, true)).loops, 0u);
}

TEST(RegionGrowThinParts_TwoComponents, CountWhicheverWayTheyFace) {
    // The relative orientation of two components is not known.
    EXPECT_EQ(thin_parts(sheets(2, false)).loops, 2u);
}

TEST(RegionGrowThinParts_GivenNormals, DistinguishTheSidesHoweverNear) {
    Patch patch = sheets(2, true);
    patch.surface().oriented = true;
    EXPECT_EQ(thin_parts(patch).loops, 0u);
}

TEST(RegionGrowThinParts_OneComponent, HasOneLoop) {
    Patch patch = sheets(2, true, true);
    EXPECT_EQ(thin_parts(patch).loops, 1u);
    for (u32 i = 0; i < 9; ++i) patch.surface().normals[patch.point(i)] = Vec3(0, 0, 1);
    EXPECT_EQ(thin_parts(patch).loops, 0u) << "the two layers of a fold have equal normals";
}

TEST(RegionGrowThinParts_ComponentsSideBySide, AreNotOpposite) {
    // Two squares in one plane, 1 apart: beside each other, not across.
    std::vector<Vec3> positions;
    for (const double x : {0.0, 2.0})
        positions.insert(positions.end(), {Vec3(x, 0, 0), Vec3(x + 1, 0, 0), Vec3(x + 1, 1, 0), Vec3(x, 1, 0)});
    Patch patch(positions);
    for (u32 i = 0; i < 8; ++i) {
        patch.surface().normals[patch.point(i)] = Vec3(0, 0, i < 4 ? 1 : -1);
        patch.set_search_radius(i, 2 * std::numbers::sqrt3);
    }
    patch.add(0, 1, 2), patch.add(0, 2, 3), patch.add(4, 6, 5), patch.add(4, 7, 6);
    EXPECT_EQ(thin_parts(patch).loops, 0u);
}

TEST(RegionGrow_ThinLoops, AreReportedAndOthersAreNot) {
    // The two sides of a plate, without points at its edges.
    const auto plate = [](double gap) {
        std::vector<Vec3> points;
        for (u32 x = 0; x < 15; ++x)
            for (u32 y = 0; y < 15; ++y) points.insert(points.end(), {Vec3(x, y, 0), Vec3(x, y, gap)});
        PointCloud cloud = cloud_from(std::move(points));
        cloud.columns.add(Column("bin-size", 1, Buffer<double>(Array<double>(cloud.size(), 1.0))));
        return cloud;
    };
    const auto warnings = [](const PointCloud& cloud, const RegionGrowParams& params = {}) {
        Context context;
        EXPECT_GE(region_grow(cloud, params, context).loops, 2u);
        return doubts_of(context);
    };
    EXPECT_THAT(warnings(plate(2.9)), testing::Contains(testing::HasSubstr(
                                          "boundary loops lie where two sides or layers are less than 3 voxels "
                                          "apart; the nearest are 2.9 u apart, with voxels of 1 u")));
    EXPECT_THAT(warnings(plate(5)), testing::Not(testing::Contains(testing::HasSubstr("two sides"))));
    RegionGrowParams given;
    given.search_radius = Length(2 * std::numbers::sqrt3);
    EXPECT_THAT(warnings(plate(2.9), given), testing::IsEmpty()) << "a given radius has no voxel size";
}

}  // namespace
}  // namespace scanmill::growing
