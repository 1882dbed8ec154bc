// SPDX-License-Identifier: GPL-3.0-or-later
/// alpha-solid on scans of several objects, and with a share of the points.

#include <gmock/gmock.h>

#include "filters/alpha_solid/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(AlphaSolid, TwoObjects_StayTwoWhenManyAreAllowed) {
    const AlphaSolidResult result = solid_of(two_spheres(), many());
    EXPECT_EQ(result.components, 2u);
    expect_closed(result, 900, 4);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
}

TEST(AlphaSolid, TwoObjects_AreBridgedWhenOneIsRequestedWithAllPoints) {
    const AlphaSolidResult result = solid_of(two_spheres());
    EXPECT_EQ(result.components, 1u);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    EXPECT_GT(result.alpha, solid_of(two_spheres(), many()).alpha);
    expect_closed(result, result.mesh.positions.size(), 2);
}

TEST(AlphaSolid, TheLargerObject_IsKeptWhenItsShareSuffices) {
    const TetMesh tets = tets_of(two_spheres());
    std::vector<std::string> warnings;
    ContextOptions options;
    options.on_warning = [&](std::string_view text) { warnings.emplace_back(text); };
    Context context(options);
    const AlphaSolidResult result = alpha_solid(tets, covering(66), context);
    EXPECT_EQ(result.components, 1u);
    expect_closed(result, 600, 2);
    EXPECT_EQ(result.uncovered_points.size(), 300u);
    EXPECT_EQ(result.uncovered_points[0], 600u);
    EXPECT_GT(result.cells_left_out, 0u);
    EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("300 of 900 points are not in or on the solid")));
    // A larger share than one object has needs both.
    const AlphaSolidResult both = solid_of(tets, covering(67));
    EXPECT_EQ(both.components, 1u);
    EXPECT_GE(900 - both.uncovered_points.size(), 603u);
    expect_closed(both, both.mesh.positions.size(), 2);
}

PointCloud sphere_with_outliers() {
    Array<Vec3> far;
    for (int i = 0; i < 5; ++i) far.push_back(Vec3(3 + i, 2 * i, 1 - i));
    PointCloud outliers;
    outliers.positions = std::move(far);
    return joined(outliers, fibonacci_sphere(995, 1e-4));
}

TEST(AlphaSolid, Outliers_AreLeftOutAndReportedWhenTheShareAllowsIt) {
    const TetMesh tets = tets_of(sphere_with_outliers());
    EXPECT_GT(solid_of(tets).alpha, 1);
    for (AlphaComponents components : {AlphaComponents::single, AlphaComponents::many}) {
        const AlphaSolidResult result = solid_of(tets, covering(99.5, components));
        EXPECT_LT(result.alpha, 0.2);
        EXPECT_THAT(result.uncovered_points.span(), testing::ElementsAre(0, 1, 2, 3, 4));
        expect_closed(result, 995, 2);
        EXPECT_GT(solid_of(tets, covering(99.6, components)).alpha, 0.5);
    }
}

TEST(AlphaSolid, AnyShareOfRandomPoints_IsCoveredByAClosedManifold) {
    // Random clumps: solids of many sizes that touch and merge.
    int kept_apart = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        PointCloud cloud = random_cube(40, seed);
        for (int clump = 0; clump < 4; ++clump)
            cloud = joined(cloud, moved(random_cube(40, 100 + seed), 0.2, random_cube(4, 200 + seed).positions[clump]));
        const TetMesh tets = tets_of(cloud);
        for (double share : {50.0, 75.0, 90.0, 99.0})
            for (AlphaComponents components : {AlphaComponents::single, AlphaComponents::many}) {
                const AlphaSolidResult result = solid_of(tets, covering(share, components));
                expect_closed(result, result.mesh.positions.size(), topology(result.mesh).euler);
                EXPECT_GE(200 - result.uncovered_points.size(), 2 * share);
                EXPECT_EQ(200 - result.uncovered_points.size(),
                          result.interior_points.size() + result.mesh.positions.size());
                if (components == AlphaComponents::single) {
                    EXPECT_EQ(result.components, 1u);
                    kept_apart += result.cells_left_out > 0;
                }
            }
    }
    EXPECT_GT(kept_apart, 10);
}

}  // namespace
}  // namespace scanmill
