// SPDX-License-Identifier: GPL-3.0-or-later
/// Damaged and unusual clouds through delaunay and alpha-solid: a clear refusal, or a solid and a count.

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "filters/alpha_solid/cases.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

struct Outcome {
    std::string refused = "accepted";
    DelaunayResult delaunay;
    AlphaSolidResult solid;
    std::vector<std::string> warnings;
};

Outcome through_both(const PointCloud& cloud, const AlphaSolidParams& params = {}) {
    Outcome outcome;
    Context context;
    try {
        outcome.delaunay = delaunay(cloud, {}, context);
        outcome.solid = alpha_solid(outcome.delaunay.tets, params, context);
    } catch (const Error& error) {
        outcome.refused = error.what();
    }
    outcome.warnings = sentences_of(context);
    return outcome;
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();

TEST(AlphaSolidOfBadInput, CoplanarPoints_AreRefused) {
    EXPECT_THAT(through_both(flat_square(0)).refused, HasSubstr("500, all within"));
    EXPECT_THAT(through_both(rotated(flat_square(0), 0.4)).refused, HasSubstr("of one plane"));
}

TEST(AlphaSolidOfBadInput, CollinearPoints_AreRefused) {
    Array<Vec3> positions;
    for (int i = 0; i < 50; ++i) positions.push_back(Vec3(0.1, 0.2, -0.3) * i);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    EXPECT_THAT(through_both(cloud).refused, HasSubstr("of one line"));
}

TEST(AlphaSolidOfBadInput, NaNAndInfinitePositions_AreRefusedWithTheFirst) {
    for (double bad : {nan, infinite, -infinite}) {
        PointCloud cloud = fibonacci_sphere(100);
        Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
        positions[41].z() = bad;
        cloud.positions = std::move(positions);
        EXPECT_THAT(through_both(cloud).refused,
                    HasSubstr("1 of 100 points has a NaN or an infinity, the first is number 41"));
    }
}

TEST(AlphaSolidOfBadInput, NaNInAnotherColumn_IsCarriedAlong) {
    PointCloud cloud = fibonacci_sphere(300, 1e-4);
    Array<double> quality(300);
    for (u32 i = 0; i < 300; ++i) quality[i] = i % 3 == 0 ? nan : i % 3 == 1 ? -infinite : i;
    cloud.columns.add(Column("quality", 1, Buffer<double>(std::move(quality))));
    const Outcome outcome = through_both(cloud);
    ASSERT_EQ(outcome.refused, "accepted");
    expect_closed(outcome.solid, 300, 2);
    for (const ColumnTable* table : {&outcome.solid.mesh.vertex_columns, &outcome.solid.tets.vertex_columns}) {
        ASSERT_NE(table->find("quality"), nullptr);
        const auto values = table->find("quality")->values<double>();
        for (u32 i = 0; i < 300; ++i) {
            if (i % 3 == 0)
                EXPECT_TRUE(std::isnan(values[i]));
            else
                EXPECT_EQ(values[i], i % 3 == 1 ? -infinite : i);
        }
    }
}

TEST(AlphaSolidOfBadInput, NinetyPercentDuplicates_AreMergedCountedAndChangeNothing) {
    const PointCloud cloud = fibonacci_sphere(400, 1e-4);
    PointCloud repeated = cloud;
    for (int i = 0; i < 9; ++i) repeated = joined(repeated, shuffled(cloud, i));
    const Outcome clean = through_both(cloud), outcome = through_both(repeated);
    ASSERT_EQ(outcome.refused, "accepted");
    EXPECT_EQ(outcome.delaunay.duplicates, 3600u);
    EXPECT_EQ(outcome.solid.alpha, clean.solid.alpha);
    EXPECT_EQ(places(outcome.solid.mesh), places(clean.solid.mesh));
    expect_closed(outcome.solid, 400, 2);
}

TEST(AlphaSolidOfBadInput, TwoFarClusters_AreTwoSolidsOrBridgedWithAWarning) {
    const PointCloud cloud =
        joined(fibonacci_sphere(400, 1e-4), moved(fibonacci_sphere(400, 1e-4, 2), 1, Vec3(500, 0, 0)));
    const Outcome two = through_both(cloud, many());
    ASSERT_EQ(two.refused, "accepted");
    expect_closed(two.solid, 800, 4);
    EXPECT_LT(two.solid.alpha, 0.2);

    const Outcome one = through_both(cloud);
    ASSERT_EQ(one.refused, "accepted");
    EXPECT_EQ(one.solid.components, 1u);
    EXPECT_TRUE(topology(one.solid.mesh).closed);
    EXPECT_EQ(one.solid.uncovered_points.size(), 0u);
    EXPECT_FALSE(one.warnings.empty());
}

TEST(AlphaSolidOfBadInput, OneOutlierAThousandDiagonalsAway_IsCoveredWithAWarningOrLeftOutAndCounted) {
    const PointCloud cloud = joined(fibonacci_sphere(999, 1e-4), cloud_of({Vec3(2000, 1500, 2500)}));
    const Outcome all = through_both(cloud);
    ASSERT_EQ(all.refused, "accepted");
    EXPECT_TRUE(topology(all.solid.mesh).closed);
    EXPECT_GT(all.solid.alpha, 1000);
    EXPECT_EQ(all.solid.uncovered_points.size(), 0u);
    EXPECT_THAT(all.warnings,
                ElementsAre(HasSubstr("times the boundary's median edge"), HasSubstr("span gaps between the points")));

    const Outcome most = through_both(cloud, covering(99.9));
    expect_closed(most.solid, 999, 2);
    EXPECT_LT(most.solid.alpha, 0.12);
    EXPECT_THAT(most.solid.uncovered_points.span(), ElementsAre(999));
    EXPECT_THAT(most.warnings, ElementsAre(HasSubstr("1 of 1000 points is not in or on the solid")));
}

}  // namespace
}  // namespace scanmill
