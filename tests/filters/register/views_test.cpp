// SPDX-License-Identifier: GPL-3.0-or-later
/// Views of a lump, and views that must be refused.
#include <gmock/gmock.h>

#include <limits>
#include <ostream>

#include "filters/register/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

/// Views of a lump from all sides.
const std::vector<View>& sides() {
    static const std::vector<View> views = views_of(lump(), 8);
    return views;
}

TEST(RegisterViews, OfALump_AreAllPlacedWithinATenthOfASpacing) {
    const std::vector<View> views = in_random_frames(sides(), 1, 100);
    const RegisterViewsResult result = registered(views);
    EXPECT_EQ(result.placed, views.size());
    for (const double error : errors_of(result, views)) {
        EXPECT_LT(error, 0.1 * result.spacing);
        EXPECT_GE(error, 0);
    }
    EXPECT_EQ(result.views[0].pose->rotation, Eigen::Matrix3d::Identity());
    EXPECT_EQ(result.views[0].pose->translation, Vec3::Zero());
    EXPECT_GT(result.views[1].overlap, 0.3);
    EXPECT_GT(result.confidence, 0.3);
    EXPECT_LT(result.rms, 0.5 * result.spacing);
}

TEST(RegisterViews, AnyNumberOfThreads_GivesTheSameBits) {
    const std::vector<View> views = in_random_frames(sides(), 1, 100);
    const RegisterViewsResult one = registered(views, {}, 1);
    for (const unsigned threads : {2u, 8u}) {
        const RegisterViewsResult other = registered(views, {}, threads);
        for (std::size_t i = 0; i < views.size(); ++i) {
            EXPECT_EQ(one.views[i].pose->rotation, other.views[i].pose->rotation);
            EXPECT_EQ(one.views[i].pose->translation, other.views[i].pose->translation);
        }
    }
}

TEST(RegisterViews, AnotherOrder_GivesTheSameRelativePoses) {
    std::vector<View> views = in_random_frames(sides(), 1, 100);
    const RegisterViewsResult one = registered(views);
    std::ranges::reverse(views);
    const RegisterViewsResult other = registered(views);
    const std::size_t last = views.size() - 1;
    const RigidMotion before = one.views[0].pose->then(one.views[1].pose->inverse()),
                      after = other.views[last].pose->then(other.views[last - 1].pose->inverse());
    EXPECT_LT(displacement(before, after, Vec3::Zero(), 200), 1e-9);
}

TEST(RegisterViews, AnotherStart_GivesTheSamePoses) {
    for (const u64 seed : {2u, 3u}) {
        const std::vector<View> views = in_random_frames(sides(), seed, 100);
        const std::vector<double> errors = errors_of(registered(views), views),
                                  first = errors_of(registered(sides()), sides());
        for (std::size_t i = 0; i < views.size(); ++i) EXPECT_NEAR(errors[i], first[i], 0.02);
    }
}

TEST(RegisterViews, RightStarts_AreRefined_AndAWrongOneIsRefused) {
    std::vector<View> views = in_random_frames(sides(), 1, 100);
    const std::vector<double> searched = errors_of(registered(views), views);
    for (View& view : views) view.start = view.truth;
    const std::vector<double> started = errors_of(registered(views), views);
    for (std::size_t i = 0; i < views.size(); ++i) EXPECT_NEAR(started[i], searched[i], 0.05);
    views[2].start->translation += Vec3(-40, 25, 0);
    const RegisterViewsResult result = registered(views);
    EXPECT_EQ(result.placed, views.size() - 1);
    EXPECT_FALSE(result.views[2].pose);
}

TEST(RegisterViews, PosesAsTheyAre_AreKeptBitForBit_UnlessTheyAreWrong) {
    std::vector<View> views = sides();
    RegisterViewsParams params;
    params.as_is = true;
    const RegisterViewsResult kept = registered(views, params);
    EXPECT_TRUE(kept.kept_as_is);
    for (const RegisteredView& view : kept.views) EXPECT_EQ(view.pose->translation, Vec3::Zero());
    for (Vec3& p : views[1].points) p -= 20 * views[1].to_scanner;
    const RegisterViewsResult moved = registered(views, params);
    EXPECT_FALSE(moved.kept_as_is);
    EXPECT_EQ(moved.placed, views.size());
    // Views far apart do not contradict each other, but nothing confirms them either.
    EXPECT_FALSE(registered(in_random_frames(sides(), 1, 1e4), params).kept_as_is);
}

TEST(RegisterViews, ViewsAsTheyAreWithoutOverlap_AreKept_UnlessAPairFitsElsewhere) {
    std::vector<View> views = {sides()[0], views_of(lump(2), 8)[3]};
    for (Vec3& p : views[1].points) p += Vec3(1e3, 0, 0);
    RegisterViewsParams params;
    params.as_is = true;
    const RegisterViewsResult kept = registered(views, params);
    EXPECT_TRUE(kept.kept_as_is);
    EXPECT_TRUE(kept.is_unconnected);
    EXPECT_EQ(kept.placed, 2u);
    EXPECT_EQ(kept.views[1].pose->translation, Vec3::Zero());
    // The stranger is refused, since others show that the views are not in one frame.
    std::vector<View> more = in_random_frames(sides(), 1, 1e4);
    more.push_back(views[1]);
    const RegisterViewsResult found = registered(more, params);
    EXPECT_FALSE(found.kept_as_is);
    EXPECT_EQ(found.placed, sides().size());
    EXPECT_FALSE(found.views.back().pose);
}

TEST(RegisterViews, StripsOfALandscape_ArePlacedIfTheyAreNoWholeViews) {
    const auto height = [](double x, double y) {
        return 6 * std::sin(x / 9) * std::cos(y / 7 + x / 31) + 4 * std::sin(x / 23 + y / 11) +
               3 * std::sin(x * y / 700);
    };
    std::vector<View> strips;
    for (int i = 0; i < 4; ++i)
        strips.push_back(height_view("strip " + std::to_string(i + 1), 60 * i, 60 * i + 120, 0, 90, height, 0.2,
                                     static_cast<u64>(i) + 1));
    const std::vector<View> views = in_random_frames(strips, 1, 100);
    EXPECT_LT(registered(views).placed, 4u);
    RegisterViewsParams params;
    params.whole_views = false;
    const RegisterViewsResult found = registered(views, params);
    EXPECT_EQ(found.placed, 4u);
    for (const double error : errors_of(found, views)) EXPECT_LT(std::abs(error), 0.2);
}

TEST(RegisterViews, OneView_StaysWhereItIs) {
    const RegisterViewsResult result = registered({sides()[0]});
    EXPECT_EQ(result.placed, 1u);
    EXPECT_EQ(result.views[0].pose->translation, Vec3::Zero());
}

TEST(RegisterViews, AViewOfAnotherObject_IsRefusedAndChangesNothing) {
    std::vector<View> views = in_random_frames(sides(), 1, 100);
    const std::vector<double> before = errors_of(registered(views), views);
    views.push_back(views_of(lump(2), 8)[3]);
    const RegisterViewsResult result = registered(views);
    EXPECT_EQ(result.placed, sides().size());
    EXPECT_FALSE(result.views.back().pose);
    EXPECT_NE(result.views.back().refusal, ViewRefusal::none);
    const std::vector<double> after = errors_of(result, views);
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 0.02);
}

TEST(RegisterViews, WithoutOverlap_AreRefused) {
    // From opposite sides.
    const std::vector<View> all = views_of(lump(), 8);
    std::vector<View> views{all[0]};
    const auto opposite =
        std::ranges::min_element(all, {}, [&](const View& view) { return view.to_scanner.dot(all[0].to_scanner); });
    views.push_back(*opposite);
    const RegisterViewsResult result = registered(views);
    EXPECT_EQ(result.placed, 0u);
    for (const RegisteredView& view : result.views)
        EXPECT_THAT(view.refusal, testing::AnyOf(ViewRefusal::no_overlap, ViewRefusal::contradicts));
}

TEST(RegisterViews, ThatShareOnlyAPlane_Slide) {
    const auto flat = [](double, double) { return 0.0; };
    const RegisterViewsResult result = registered(
        {height_view("one", 0, 100, 0, 100, flat, 0.3, 1), height_view("two", 0, 100, 0, 101, flat, 0.3, 2)});
    EXPECT_EQ(result.placed, 0u);
    for (const RegisteredView& view : result.views) {
        EXPECT_EQ(view.refusal, ViewRefusal::slides);
        EXPECT_LT(view.best.slide, 0.002);
        EXPECT_GE(view.best.free_directions, 3u);
    }
}

TEST(RegisterViews, InAnotherUnit_AreNamed) {
    std::vector<View> views = in_random_frames(sides(), 1, 100);
    for (Vec3& p : views[2].points) p *= 25.4;
    const RegisterViewsResult result = registered(views);
    EXPECT_EQ(result.placed, views.size() - 1);
    EXPECT_NEAR(result.views[2].scale.value(), 25.4, 5);
    EXPECT_EQ(result.views[2].units, "millimetres and inches");
}

TEST(RegisterViews, AThousandTinyViews_AreRefused) {
    std::vector<View> views;
    for (int i = 0; i < 1000; ++i) views.push_back({"tiny", {{1, 0, 0.1 * i}, {0, 1, 0}, {0, 0, 1}}});
    const RegisterViewsResult result = registered(views);
    EXPECT_EQ(result.placed, 0u);
    for (const RegisteredView& view : result.views) EXPECT_EQ(view.refusal, ViewRefusal::small);
}

struct Refusal {
    const char* name;
    std::vector<Vec3> points;
    const char* words;
};

void PrintTo(const Refusal& refusal, std::ostream* stream) { *stream << refusal.name; }

class RegisterRefusals : public testing::TestWithParam<Refusal> {};

TEST_P(RegisterRefusals, NameTheView) {
    std::vector<View> views = sides();
    views.push_back({"bad view", GetParam().points});
    const Error error = error_of([&] { registered(views); });
    EXPECT_THAT(error.sentence(), testing::HasSubstr("'bad view'"));
    EXPECT_THAT(error.sentence(), testing::HasSubstr(GetParam().words));
    EXPECT_FALSE(error.hint().empty());
}

INSTANTIATE_TEST_SUITE_P(
    Views, RegisterRefusals,
    testing::Values(Refusal{"Empty", {}, "no points"}, Refusal{"TwoPoints", {{0, 0, 0}, {1, 0, 0}}, "2 points"},
                    Refusal{
                        "NotFinite", {{0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}}, "row 3"},
                    Refusal{"Equal", {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, "equal"},
                    Refusal{"OnALine", {{1, 2, 3}, {2, 4, 6}, {3, 6, 9}, {7, 14, 21}}, "on a line"}),
    [](const auto& refusal) { return refusal.param.name; });

TEST(RegisterViews, NoViewAndEqualViews_AreErrors) {
    EXPECT_THAT(sentence_of([] { registered({}); }), testing::HasSubstr("no view"));
    std::vector<View> views = sides();
    views.push_back(views[1]);
    views.back().name = "again";
    const std::string sentence = sentence_of([&] { registered(views); });
    EXPECT_THAT(sentence, testing::HasSubstr("'view 2'"));
    EXPECT_THAT(sentence, testing::HasSubstr("'again'"));
}

TEST(RegisterViews, ThatWouldBeTooManyPairs_AreAnErrorWithTheNumber) {
    std::vector<View> views;
    for (int i = 0; i < 102; ++i)
        views.push_back(height_view("view", 0, 8, 0, 8 + i, [](double x, double y) { return x * y; }));
    EXPECT_THAT(sentence_of([&] { registered(views); }), testing::HasSubstr("5151"));
}

TEST(RegisterViews, Cancelled_Stop) {
    const std::vector<View> views = sides();
    std::vector<ViewToRegister> input;
    for (const View& view : views) input.push_back({view.name, view.points, view.to_scanner, {}});
    ExecutionOptions options;
    options.is_cancelled = [] { return true; };
    Execution execution(options);
    EXPECT_THROW(register_views(input, {}, execution), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
