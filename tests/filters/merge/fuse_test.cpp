// SPDX-License-Identifier: GPL-3.0-or-later
/// Fusing: views of one surface that lie a little apart become one layer, and keep their own detail and noise.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <functional>
#include <numbers>

#include "filters/merge/cases.hpp"
#include "scanmill/base/random.hpp"
#include "support/same_bits.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

MergeParams fused_within(Length length) {
    MergeParams params;
    params.fuse = length;
    return params;
}

/// Points on a grid of spacing 1, (x + shift, y + shift, height(x, y)), with normals of +z or -z. Heights are computed
/// at the shifted points. Rows ascend by x, then y.
struct Grid {
    int low_x = 0, high_x = 30, size_y = 30;
    double shift = 0;
    std::function<double(double, double)> height = [](double, double) { return 0.0; };
    double side = 1;  ///< z of the normals; 0: no column

    PointCloud cloud() const {
        Array<Vec3> positions;
        Array<double> normals;
        for (int x = low_x; x <= high_x; ++x)
            for (int y = 0; y <= size_y; ++y) {
                positions.emplace_back(x + shift, y + shift, height(x + shift, y + shift));
                normals.insert(normals.end(), {0, 0, side});
            }
        PointCloud result{{}, std::move(positions), {}};
        if (side != 0) result.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
        return result;
    }
};

Grid flat(double z, double shift = 0) {
    Grid grid;
    grid.height = [z](double, double) { return z; };
    grid.shift = shift;
    return grid;
}

/// The z of the points of a source that are at least `margin` inside the square from 0 to 30.
std::vector<double> heights(const PointCloud& cloud, u32 source, double margin = 0) {
    const std::span<const u32> sources = cloud.columns.find("source")->values<u32>();
    std::vector<double> result;
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const Vec3& p = cloud.positions[row];
        const bool is_inside = std::min(p.x(), p.y()) >= margin && std::max(p.x(), p.y()) <= 30 - margin;
        if (sources[row] == source && is_inside) result.push_back(p.z());
    }
    return result;
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

double variance(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += (value - mean(values)) * (value - mean(values));
    return sum / static_cast<double>(values.size());
}

TEST(Fuse, TwoPlanesAtADistance_MeetInTheMiddle) {
    const Merged result = merged({flat(0).cloud(), flat(0.5).cloud()}, fused_within(1));
    EXPECT_THAT(heights(result.points, 0), Each(DoubleNear(0.25, 1e-12)));
    EXPECT_THAT(heights(result.points, 1), Each(DoubleNear(0.25, 1e-12)));
    EXPECT_EQ(result.fused, 2u * 31 * 31);
    EXPECT_EQ(result.metrics.find("fused")->value, 2.0 * 31 * 31);
    const Column* moved = result.points.columns.find("moved");
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->length_exponent(), 1);
    EXPECT_THAT(moved->values<float>(), Each(testing::FloatNear(0.25f, 1e-6f))) << "a distance has no sign";
    for (std::size_t row = 0; row < result.points.size(); ++row) {
        EXPECT_EQ(result.points.positions[row].x(), double((row % 961) / 31));
        EXPECT_EQ(result.points.positions[row].y(), double(row % 31));
    }
}

TEST(Fuse, ShiftedGrids_MeetInTheMiddleAwayFromTheBorder) {
    const Merged result = merged({flat(0).cloud(), flat(0.5, 0.4).cloud()}, fused_within(1));
    EXPECT_THAT(heights(result.points, 0, 15), Each(DoubleNear(0.25, 1e-9)));
    // Where one view is nearer to its border, it has less weight.
    EXPECT_THAT(heights(result.points, 0, 1), Each(AllOf(testing::Gt(0.1), testing::Lt(0.4))));
}

TEST(Fuse, DistanceOfExactlyTheLength_IsFused_AndOneAboveIsNot) {
    EXPECT_EQ(merged({flat(0).cloud(), flat(0.5).cloud()}, fused_within(0.5)).fused, 1922u);
    const Merged apart = merged({flat(0).cloud(), flat(0.5).cloud()}, fused_within(0.49));
    EXPECT_EQ(apart.fused, 0u);
    EXPECT_TRUE(same_bits(apart.points.positions, merged({flat(0).cloud(), flat(0.5).cloud()}).points.positions));
}

TEST(Fuse, LengthInSpacings_IsThatOfTheViews) {
    // The median of three views with spacings 1, 1 and 1/2 is 1.
    Grid dense = flat(0.3);
    PointCloud half = dense.cloud();
    Array<Vec3> positions;
    for (const Vec3& p : half.positions) positions.emplace_back(p.x() / 2, p.y() / 2, p.z());
    half.positions = std::move(positions);
    const Clouds views = {half, flat(0).cloud(), flat(1.9).cloud()};
    EXPECT_GT(merged(views, fused_within(Length::spacings(2))).fused, 961u * 2);
    // View 2 is 1.6 and 1.9 from the others.
    const Merged less = merged(views, fused_within(Length::spacings(1.5)));
    EXPECT_THAT(heights(less.points, 2), Each(1.9));
    EXPECT_GT(less.fused, 961u / 2);
}

TEST(Fuse, ThreeViews_MeetAtTheirMean_AndTheirOrderDoesNotMatter) {
    const Clouds views = {flat(0).cloud(), flat(0.3).cloud(), flat(0.9).cloud()};
    const Merged result = merged(views, fused_within(1)),
                 turned = merged({views[2], views[0], views[1]}, fused_within(1));
    for (const u32 source : {0, 1, 2}) {
        EXPECT_THAT(heights(result.points, source), Each(DoubleNear(0.4, 1e-12)));
        EXPECT_THAT(heights(turned.points, source), Each(DoubleNear(0.4, 1e-12)));
    }
}

TEST(Fuse, ChainOfLayers_DoesNotBecomeOne) {
    const Merged result = merged({flat(0).cloud(), flat(0.9).cloud(), flat(1.8).cloud()}, fused_within(1));
    EXPECT_THAT(heights(result.points, 0), Each(DoubleNear(0.45, 1e-12)));
    EXPECT_THAT(heights(result.points, 1), Each(DoubleNear(0.9, 1e-12)));
    EXPECT_THAT(heights(result.points, 2), Each(DoubleNear(1.35, 1e-12)));
}

TEST(Fuse, ViewsThatAreAskew_MeetHalfwayAwayFromTheBorder) {
    Grid tilted;
    tilted.height = [](double x, double) { return 0.02 * (x - 15); };
    const Merged result = merged({flat(0).cloud(), tilted.cloud()}, fused_within(1));
    double gap = 0;
    for (std::size_t row = 0; row < 961; ++row) {
        const Vec3 &p = result.points.positions[row], &q = result.points.positions[row + 961];
        gap = std::max(gap, std::abs(p.z() - q.z()));
        if (std::min(p.x(), p.y()) >= 12 && std::max(p.x(), p.y()) <= 18) {
            EXPECT_NEAR(p.z(), 0.01 * (p.x() - 15), 1e-6) << p.transpose();
        }
    }
    EXPECT_LT(gap, 1e-3) << "up to 0.3 before";
}

TEST(Fuse, DetailOfTheViews_Stays) {
    const auto wave = [](double x, double y) { return 0.5 * std::sin(x / 2) * std::cos(y / 3); };
    Grid low, high;
    low.height = [&](double x, double y) { return wave(x, y) - 0.25; };
    high.height = [&](double x, double y) { return wave(x, y) + 0.25; };
    low.side = high.side = 0;  // normals are estimated
    const Merged result = merged({low.cloud(), high.cloud()}, fused_within(1));
    double worst = 0;
    for (const Vec3& p : result.points.positions) worst = std::max(worst, std::abs(p.z() - wave(p.x(), p.y())));
    // Points move along their normals, which are up to 14 degrees from the offset of the views.
    EXPECT_LT(worst, 0.03);
}

/// The variance of the heights of view 0 about its mean after fusing, as a share of that before.
double kept_variance(int views) {
    Random random(1);
    Clouds clouds;
    for (int view = 0; view < views; ++view) {
        Grid grid = flat(0);
        grid.height = [&, view](double, double) { return 0.5 * view / (views - 1) + 0.05 * random.normal(); };
        clouds.push_back(grid.cloud());
    }
    const Merged before = merged(clouds), after = merged(clouds, fused_within(1));
    EXPECT_NEAR(mean(heights(after.points, 0)), mean(heights(after.points, 1)), 0.002);
    return variance(heights(after.points, 0)) / variance(heights(before.points, 0));
}

TEST(Fuse, NoiseOfEachView_IsKept) {
    const double of_two = kept_variance(2), of_ten = kept_variance(10);
    RecordProperty("kept-variance-of-2-views", std::to_string(of_two));
    RecordProperty("kept-variance-of-10-views", std::to_string(of_ten));
    EXPECT_GT(of_two, 0.9);
    EXPECT_GT(of_ten, 0.85);
    EXPECT_LT(std::max(of_two, of_ten), 1.05);
}

TEST(Fuse, ViewsThatLieOnEachOther_BarelyMove_AlsoAtACurvedBorder) {
    Grid whole, half;
    whole.low_x = -8;
    whole.high_x = half.high_x = 8;
    half.shift = 0.4;
    whole.height = half.height = [](double x, double) { return std::sqrt(144 - x * x); };
    whole.side = half.side = 0;
    const Merged result = merged({whole.cloud(), half.cloud()}, fused_within(1));
    const std::span<const float> moved = result.points.columns.find("moved")->values<float>();
    RecordProperty("largest-move", std::to_string(*std::ranges::max_element(moved)));
    EXPECT_LT(*std::ranges::max_element(moved), 0.04) << "spacings, at a radius of 12";
}

TEST(Fuse, BothSidesOfAThinWall_StayApart) {
    Grid front = flat(0.5), back = flat(0);
    back.side = -1;
    Grid front_again = flat(0.6), back_again = flat(-0.1);
    back_again.side = -1;
    const Merged result =
        merged({front.cloud(), back.cloud(), front_again.cloud(), back_again.cloud()}, fused_within(1));
    EXPECT_THAT(heights(result.points, 0), Each(DoubleNear(0.55, 1e-12)));
    EXPECT_THAT(heights(result.points, 2), Each(DoubleNear(0.55, 1e-12)));
    EXPECT_THAT(heights(result.points, 1), Each(DoubleNear(-0.05, 1e-12)));
    EXPECT_THAT(heights(result.points, 3), Each(DoubleNear(-0.05, 1e-12)));
}

PointCloud with_approach(PointCloud cloud, const Vec3& direction) {
    Array<float> values;
    for (std::size_t row = 0; row < cloud.size(); ++row)
        for (const double x : direction) values.push_back(static_cast<float>(x));
    cloud.columns.add(Column("approach", 3, Buffer<float>(std::move(values))));
    return cloud;
}

TEST(Fuse, EstimatedNormals_AreTurnedToTheScanner) {
    Grid front = flat(0.5), back = flat(0);
    front.side = back.side = 0;
    const Merged apart =
        merged({with_approach(front.cloud(), {0, 0, 2}), with_approach(back.cloud(), {0, 0, -3})}, fused_within(1));
    EXPECT_EQ(apart.fused, 0u) << "the two sides of a wall";
    EXPECT_THAT(apart.warnings, IsEmpty());
    const Merged one =
        merged({with_approach(front.cloud(), {0, 0, 1}), with_approach(back.cloud(), {0, 0, 1})}, fused_within(1));
    EXPECT_EQ(one.fused, 1922u);
}

TEST(Fuse, WithoutNormalsAndDirections_TheScannerIsOnPlusZOfTheOwnFrame_WithAWarning) {
    Grid front = flat(0.5), back = flat(0);
    front.side = back.side = 0;
    RigidTransform over;  // half a turn about x
    over.rotation = Eigen::Vector3d(1, -1, -1).asDiagonal();
    over.translation = Vec3(0, 30, 0);
    MergeParams params = fused_within(1);
    params.poses = {RigidTransform{}, over};
    const Merged apart = merged({front.cloud(), back.cloud()}, params);
    EXPECT_EQ(apart.fused, 0u);
    EXPECT_THAT(apart.warnings, ElementsAre(AllOf(HasSubstr("2 of 2 inputs"), HasSubstr("+z of their own frames"),
                                                  HasSubstr("0 and 1"))));
    const Merged one = merged({front.cloud(), back.cloud()}, fused_within(1));
    EXPECT_EQ(one.fused, 1922u);
    EXPECT_THAT(one.warnings, ElementsAre(HasSubstr("+z of the common frame")));
}

TEST(Fuse, AViewAtAFlatAngle_CountsLess) {
    const double flat_angle = std::sqrt(1 - 0.25 * 0.25);
    const Merged result =
        merged({with_approach(flat(0).cloud(), {0, 0, 1}), with_approach(flat(0.5).cloud(), {flat_angle, 0, 0.25})},
               fused_within(1));
    // Weights 1 and 1/4: the mean is at 1/5 of the distance.
    EXPECT_THAT(heights(result.points, 0), Each(DoubleNear(0.1, 1e-6)));
    EXPECT_THAT(heights(result.points, 1), Each(DoubleNear(0.1, 1e-6)));
}

TEST(Fuse, WhereAViewEnds_TheOtherHasNoStep) {
    Grid whole = flat(0), part = flat(0.5);
    whole.high_x = part.high_x = 60;
    part.low_x = 30;
    const Merged result = merged({whole.cloud(), part.cloud()}, fused_within(1));
    double step = 0, gap = 0;
    for (int x = 0; x < 60; ++x)
        step = std::max(step, std::abs(result.points.positions[static_cast<std::size_t>(31 * (x + 1) + 15)].z() -
                                       result.points.positions[static_cast<std::size_t>(31 * x + 15)].z()));
    for (int x = 30; x <= 60; ++x)
        gap = std::max(gap,
                       std::abs(result.points.positions[static_cast<std::size_t>(31 * x + 15)].z() -
                                result.points.positions[static_cast<std::size_t>(31 * 61 + 31 * (x - 30) + 15)].z()));
    RecordProperty("largest-step", std::to_string(step));
    EXPECT_LT(step, 0.035) << "between neighbours, of a distance of 0.5";
    EXPECT_LT(gap, 1e-3);
    EXPECT_EQ(result.points.positions[31 * 20 + 15].z(), 0) << "far from the other view";
    EXPECT_NEAR(result.points.positions[31 * 50 + 15].z(), 0.25, 0.01);
}

TEST(Fuse, OneInput_StaysWithAColumnOfZeros) {
    const Merged result = merged({flat(0).cloud()}, fused_within(Length::spacings(2)));
    EXPECT_EQ(result.fused, 0u);
    EXPECT_THAT(result.points.columns.find("moved")->values<float>(), Each(0.0f));
    EXPECT_TRUE(same_bits(result.points.positions, flat(0).cloud().positions));
}

TEST(Fuse, WithoutTheParameter_NeitherColumnNorMetricIsAdded) {
    const Merged result = merged({flat(0).cloud(), flat(0.5).cloud()});
    EXPECT_FALSE(result.points.columns.find("moved"));
    EXPECT_FALSE(result.metrics.find("fused"));
    EXPECT_EQ(result.fused, 0u);
}

TEST(Fuse, TinyViewsAndLengthsBeyondTheBox_AreAccepted) {
    const Clouds tiny = {cloud_of({{0, 0, 0}}), cloud_of({{0, 0, 0.1}, {0, 0, 0.1}}),
                         cloud_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}})};
    EXPECT_EQ(merged(tiny, fused_within(1)).fused, 0u) << "they have no normals";
    for (const double length : {1e6, 1e300})
        EXPECT_EQ(merged({flat(0).cloud(), flat(0.5).cloud()}, fused_within(length)).fused, 1922u);
    EXPECT_EQ(merged({flat(0).cloud(), flat(0.5).cloud()}, fused_within(0)).fused, 0u);
}

TEST(Fuse, PointsWithoutANormal_StayAndDoNotCount) {
    PointCloud cloud = flat(0).cloud();
    Array<double> normals;
    for (std::size_t row = 0; row < cloud.size(); ++row)
        normals.insert(normals.end(), {0, 0, row == 480 ? std::nan("") : row == 481 ? 0.0 : 7.0});
    cloud.columns = {};
    cloud.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
    const Merged result = merged({cloud, flat(0.5).cloud()}, fused_within(1));
    EXPECT_EQ(result.fused, 1920u);
    EXPECT_EQ(result.points.positions[480].z(), 0);
    EXPECT_EQ(result.points.positions[481].z(), 0);
    EXPECT_NEAR(result.points.positions[482].z(), 0.25, 1e-3);
}

TEST(Fuse, PointsAreDroppedAfterwards) {
    MergeParams params = fused_within(1);
    params.within = 0.1;
    const Merged result = merged({flat(0).cloud(), flat(0.5).cloud()}, params);
    EXPECT_EQ(result.dropped, 961u);
    EXPECT_EQ(result.fused, 1922u) << "dropped points moved, too";
    EXPECT_EQ(result.points.columns.find("moved")->rows(), 961u);
}

TEST(Fuse, AnOlderColumnMoved_IsReplacedWithAWarning) {
    PointCloud cloud = flat(0).cloud();
    cloud.columns.add(Column("moved", 1, Buffer<float>(Array<float>(cloud.size(), 3.0f))));
    const Merged result = merged({cloud}, fused_within(1));
    EXPECT_THAT(result.points.columns.find("moved")->values<float>(), Each(0.0f));
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("'moved'")));
}

/// Two noisy views of a sphere of radius 1, off by 0.02 and with estimated normals, turned by `rotation`.
Clouds views_of_a_sphere(const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity()) {
    Random random(5);
    Clouds views;
    for (const Vec3& side : {Vec3(0, 0, 1), Vec3(0.6, 0, 0.8)}) {
        Array<Vec3> positions;
        Array<double> approach;
        const PointCloud sphere = random_sphere(20'000, 3 + views.size());
        for (const Vec3& p : sphere.positions) {
            if (p.dot(side) < 0.3) continue;
            positions.push_back(rotation * (p * (1 + 0.003 * random.normal()) + 0.01 * side));
            const Vec3 direction = rotation * side;
            approach.insert(approach.end(), {direction.x(), direction.y(), direction.z()});
        }
        views.push_back({{}, std::move(positions), {}});
        views.back().columns.add(Column("approach", 3, Buffer<double>(std::move(approach))));
    }
    return views;
}

TEST(Fuse, RotatedViews_AreFusedAlike) {
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, -3).normalized()).toRotationMatrix();
    const Merged straight = merged(views_of_a_sphere(), fused_within(0.05));
    const Merged turned = merged(views_of_a_sphere(rotation), fused_within(0.05));
    EXPECT_GT(straight.fused, straight.points.size() / 2);
    EXPECT_EQ(straight.fused, turned.fused);
    double worst = 0;
    for (std::size_t row = 0; row < straight.points.size(); ++row)
        worst = std::max(worst, (rotation * straight.points.positions[row] - turned.points.positions[row]).norm());
    EXPECT_LT(worst, 1e-9);
}

TEST(Fuse, AnyNumberOfThreads_GivesTheSameBytes) {
    const Clouds views = views_of_a_sphere();
    const Merged one = merged(views, fused_within(Length::spacings(2)), 1);
    for (const unsigned threads : {2u, 5u}) {
        const Merged more = merged(views, fused_within(Length::spacings(2)), threads);
        EXPECT_TRUE(same_bits(one.points.positions, more.points.positions));
        EXPECT_TRUE(
            std::ranges::equal(one.points.columns.find("moved")->bytes(), more.points.columns.find("moved")->bytes()));
    }
}

TEST(Fuse, NegativeAndInfiniteLengths_AreRefusedWithAHint) {
    for (const Length& length :
         {Length(-1), Length(std::numeric_limits<double>::infinity()), Length::spacings(-2), Length(std::nan(""))}) {
        const Error error = error_of([&] { merged({flat(0).cloud()}, fused_within(length)); });
        EXPECT_THAT(error.sentence(), AllOf(HasSubstr("`fuse`"), HasSubstr("0 or more")));
        EXPECT_THAT(error.hint(), HasSubstr("2 spacing"));
    }
    EXPECT_THAT(sentence_of([&] { merged({flat(0).cloud()}, fused_within(Length::percent_of_diagonal(1))); }),
                HasSubstr("not resolved"));
}

TEST(Fuse, Cancelled_Stops) {
    const Clouds views = views_of_a_sphere();
    std::vector<std::shared_ptr<const PointCloud>> inputs;
    for (const PointCloud& view : views) inputs.push_back(std::make_shared<const PointCloud>(view));
    ContextOptions options;
    int calls = 0;
    options.is_cancelled = [&] { return ++calls > 20; };
    Context context(options);
    EXPECT_THROW(merge(inputs, fused_within(0.05), context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
