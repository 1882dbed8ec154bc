// SPDX-License-Identifier: GPL-3.0-or-later
/// When alpha-solid doubts its result.
#include <gmock/gmock.h>

#include "filters/alpha_solid/cases.hpp"
#include "filters/known_models.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<Doubt> doubts_of(const PointCloud& cloud, const AlphaSolidParams& params = {}) {
    Context context;
    alpha_solid(delaunay(cloud, {}, context).tets, params, context);
    return context.doubts();
}

PointCloud with_point(const PointCloud& cloud, const Vec3& p) {
    PointCloud point;
    point.positions = {p};
    return joined(cloud, point);
}

TEST(AlphaSolidDoubts, SampledSphere_HasNone) { EXPECT_THAT(doubts_of(fibonacci_sphere(2000)), IsEmpty()); }

TEST(AlphaSolidDoubts, PointFarFromTheSphere_MakesAlphaTooLarge) {
    const PointCloud far = with_point(fibonacci_sphere(2000), {3, 0.1, 0.2});
    const std::vector<Doubt> doubts = doubts_of(far);
    ASSERT_EQ(doubts.size(), 1u);
    EXPECT_THAT(doubts[0].text, HasSubstr("times the boundary's median edge, to span gaps or to reach distant points"));
    EXPECT_EQ(doubts[0].port, "");
    EXPECT_THAT(doubts_of(far, covering(99)), IsEmpty());
}

TEST(AlphaSolidDoubts, PointsThroughoutABall_AreADoubtAboutTheMesh) {
    Random random(1);
    Array<Vec3> positions;
    while (positions.size() < 3000) {
        const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        if (p.norm() < 1) positions.push_back(p);
    }
    PointCloud ball;
    ball.positions = std::move(positions);
    const std::vector<Doubt> doubts = doubts_of(ball);
    ASSERT_EQ(doubts.size(), 1u);
    EXPECT_THAT(doubts[0].text, HasSubstr("of 3000 points lie inside the solid"));
    EXPECT_EQ(doubts[0].port, "mesh");
}

/// Clean models are never doubtful, whether alpha fills their grooves or not.
class AlphaSolidDoubtsOfModel : public testing::TestWithParam<Model> {};
TEST_P(AlphaSolidDoubtsOfModel, AreNone) {
    const auto path = found(GetParam());
    if (!path) GTEST_SKIP() << missing_data(GetParam().file);
    for (const Doubt& doubt : doubts_of(*read_points(*path))) ADD_FAILURE() << doubt.text;
}
INSTANTIATE_TEST_SUITE_P(Dense, AlphaSolidDoubtsOfModel, testing::ValuesIn(dense_models));

}  // namespace
}  // namespace scanmill
