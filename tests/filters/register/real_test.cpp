// SPDX-License-Identifier: GPL-3.0-or-later
/// Raw views with their poses thrown away.
#include "filters/register/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/formats/poses/poses.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

std::vector<View> views_of(const std::filesystem::path& conf) {
    std::vector<View> views;
    for (const ScanPose& pose : read_poses(conf, [](const std::string&) {})) {
        const std::filesystem::path file = conf.parent_path() / pose.scan;
        if (!std::filesystem::is_regular_file(file)) continue;
        const auto cloud = read_points(file);
        View view{pose.scan, {}, Vec3::UnitZ(), {pose.transform.rotation, pose.transform.translation}};
        for (const Vec3& p : cloud->positions)
            if (p.allFinite()) view.points.push_back(cloud->frame.origin + p);
        views.push_back(std::move(view));
    }
    return views;
}

TEST(RegisterReal, TheBunnysTenViews_AreWithinSixTenthsOfASpacingFromAnyStart) {
    SCANMILL_REAL_SCAN(conf, shared_data, "1-bunny/raw/bun.conf");
    const std::vector<View> known = views_of(conf);
    ASSERT_EQ(known.size(), 10u);
    std::vector<double> first;
    for (const u64 seed : {1u, 2u}) {
        const std::vector<View> views = in_random_frames(known, seed, 0.1);
        const RegisterViewsResult result = registered(views);
        EXPECT_EQ(result.placed, 10u);
        const std::vector<double> errors = errors_of(result, views);
        for (std::size_t i = 0; i < views.size(); ++i) {
            EXPECT_LT(errors[i], 0.6 * result.spacing) << views[i].name;
            EXPECT_GE(errors[i], 0) << views[i].name;
            EXPECT_NEAR(errors[i], first.empty() ? errors[i] : first[i], 0.1 * result.spacing);
        }
        first = errors;
    }
}

TEST(RegisterReal, TheBuddhasFifteenViewsAndAStranger_ArePlacedWithoutTheStranger) {
    SCANMILL_REAL_SCAN(conf, shared_data, "5-raw/happy_stand/happyStandRight.conf");
    SCANMILL_REAL_SCAN(bunny, shared_data, "1-bunny/raw/bun.conf");
    std::vector<View> known = views_of(conf);
    ASSERT_EQ(known.size(), 15u);
    known.push_back(views_of(bunny)[0]);
    const std::vector<View> views = in_random_frames(known, 1, 0.1);
    const RegisterViewsResult result = registered(views);
    EXPECT_EQ(result.placed, 15u);
    EXPECT_FALSE(result.views[15].pose);
    // The published poses are not exact to one spacing.
    const std::vector<double> errors = errors_of(result, views);
    for (std::size_t i = 0; i < 15; ++i) EXPECT_LT(errors[i], 2 * result.spacing) << views[i].name;
    EXPECT_LT(result.rms, 0.3 * result.spacing);
}

}  // namespace
}  // namespace scanmill::test
