// SPDX-License-Identifier: GPL-3.0-or-later
/// When region-grow doubts its result. Unused points, thin parts and seams are tested with what they depend on.
#include <gmock/gmock.h>

#include "filters/known_models.hpp"
#include "filters/region_grow/cases.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> doubts_about(const PointCloud& cloud) {
    Context context;
    region_grow(cloud, {}, context);
    return doubts_of(context);
}

TEST(RegionGrowDoubts, RoughGrid_IsDoubtful_AndAFlatOneIsNot) {
    EXPECT_THAT(doubts_about(grid(60, 60)), IsEmpty());
    Random random(1);
    std::vector<Vec3> points;
    for (const Vec3& p : grid(60, 60).positions) points.push_back(p + Vec3(0, 0, random.uniform(-0.5, 0.5)));
    EXPECT_THAT(doubts_about(cloud_from(points)), ElementsAre(HasSubstr("the surface is rough at the distance of")));
}

TEST(RegionGrowDoubts, FoldedGrid_HasLongCreasesAndIsNotRough) {
    // Pleats of ten rows, at right angles.
    std::vector<Vec3> points;
    for (int x = 0; x < 60; ++x)
        for (int y = 0; y < 60; ++y) {
            const int pleat = x / 10, along = x % 10;
            const double height = std::sqrt(0.5) * (pleat % 2 == 0 ? along : 10 - along);
            points.push_back(Vec3(x * std::sqrt(0.5), y, height));
        }
    EXPECT_GT(grown(cloud_from(points)).creases, 3u);
    EXPECT_THAT(doubts_about(cloud_from(points)), IsEmpty());
}

TEST(RegionGrowDoubts, OutliersAlone_AreDoubtful) {
    EXPECT_THAT(doubts_about(random_cube(500, 5)), Contains(HasSubstr("boundary loops lie where two sides or layers")));
}

TEST(RegionGrowDoubts, TwoScales_AreTwoClosedSurfaces) {
    // A sphere of 1 and one of 1/50 beside it, both of 3,000 points.
    const PointCloud sphere = fibonacci_sphere(3000), cloud = joined(sphere, moved(sphere, 0.02, {1.3, 0, 0}));
    const RegionGrowResult result = grown(cloud);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(topology(result.mesh).components, 2u);
    EXPECT_EQ(result.unused_points, 0u);
    EXPECT_THAT(doubts_about(cloud), IsEmpty());
}

class RegionGrowDoubtsOfModel : public testing::TestWithParam<Model> {};
TEST_P(RegionGrowDoubtsOfModel, AreNone) {
    const auto path = found(GetParam());
    if (!path) GTEST_SKIP() << missing_data(GetParam().file);
    EXPECT_THAT(doubts_about(*read_points(*path)), IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Dense, RegionGrowDoubtsOfModel, testing::ValuesIn(dense_models));

}  // namespace
}  // namespace scanmill
