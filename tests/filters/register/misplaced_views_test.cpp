// SPDX-License-Identifier: GPL-3.0-or-later
/// Given poses that single views contradict.
#include "register/misplaced_views.hpp"

#include <gmock/gmock.h>

#include "filters/register/cases.hpp"

namespace scanmill::test {
namespace {

using testing::IsEmpty;

struct Tested {
    std::vector<MisplacedView> views;
    double spacing = 0;
};

/// `wrong` moves the pose of the view in row 3.
Tested tested(const RigidMotion& wrong) {
    const std::vector<View> views = in_random_frames(views_of(lump(), 8), 2, 100);
    std::vector<ViewToRegister> input;
    for (const View& view : views) {
        const RigidMotion pose = input.size() == 3 ? view.truth.then(wrong) : view.truth;
        input.push_back({view.name, view.points, view.to_scanner, pose});
    }
    Tested result;
    Execution execution;
    result.views = misplaced_views(input, {}, result.spacing, execution);
    return result;
}

/// A small turn about z, to the first order.
RigidMotion turned(double angle) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
    return {turn, Vec3::Zero()};
}

TEST(MisplacedViews, RightPoses_HaveNone) { EXPECT_THAT(tested({}).views, IsEmpty()); }

TEST(MisplacedViews, AViewTurnedByADegree_IsNamedWithItsDistance) {
    const Tested found = tested(turned(0.0175));
    ASSERT_EQ(found.views.size(), 1u);
    EXPECT_EQ(found.views[0].view, 3u);
    ASSERT_TRUE(found.views[0].distance.has_value());
    EXPECT_NEAR(*found.views[0].distance, 0.0175 * 35, 0.3) << "the lump is about 80 wide";
    EXPECT_GT(found.spacing, 0);
}

TEST(MisplacedViews, AViewFarAway_IsNoMatter_IfItIsNotTheOnlyWay) {
    const Tested found = tested({Eigen::Matrix3d::Identity(), Vec3(300, 0, 0)});
    EXPECT_THAT(found.views, IsEmpty()) << "it overlaps with no other view, so it cannot be tested";
}

}  // namespace
}  // namespace scanmill::test
