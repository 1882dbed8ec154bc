// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>

#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "smooth/smooth.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/same_points.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Method = SmoothParams::Method;

struct Smoothed : SmoothResult {
    std::vector<std::string> doubts, warnings;
    Metrics metrics;
};
Smoothed smoothed(const PointCloud& cloud, const SmoothParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return {smooth(cloud, params, context), doubts_of(context), context.warnings(), context.metrics()};
}
SmoothParams with(Method method, u32 neighbours = 24, std::optional<double> radius = {}) {
    SmoothParams params;
    params.method = method;
    params.neighbours = neighbours;
    if (radius) params.radius = Length(*radius);
    return params;
}
/// The points (x, y, height(x, y)) of a square grid around 0.
template <class Height>
PointCloud graph(int half, Height&& height) {
    Array<Vec3> positions;
    for (int y = -half; y <= half; ++y)
        for (int x = -half; x <= half; ++x) positions.emplace_back(x, y, height(x, y));
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}
/// Root of the mean square distance from the unit sphere.
double roughness(const PointCloud& cloud) {
    double sum = 0;
    for (const Vec3& p : cloud.positions) sum += (p.norm() - 1) * (p.norm() - 1);
    return std::sqrt(sum / static_cast<double>(cloud.size()));
}

TEST(Smooth, OnePointAboveAPlane_FallsByTheWeightOfItsFit) {
    // Nine points on a grid, the middle one raised by h. The best quadric at the middle is 5/9 h (the first entry of
    // the inverse normal matrix of 1, x², y² on the grid); the plane of least variance stays horizontal.
    const double h = 0.09;
    const PointCloud cloud = graph(1, [&](int x, int y) { return x == 0 && y == 0 ? h : 0.0; });
    const Smoothed result = smoothed(cloud, with(Method::jet, 8));
    EXPECT_NEAR(result.points.positions[4].z(), 5 * h / 9, 1e-15);
    EXPECT_NEAR(result.points.columns.find("moved")->number(4), 4 * h / 9, 1e-8);
    EXPECT_EQ(result.points.columns.find("moved")->length_exponent(), 1);
    EXPECT_EQ(result.points.positions[4].head<2>(), Eigen::Vector2d(0, 0));
}

TEST(Smooth, Mls_WeighsNearNeighboursMore) {
    // The same points. By symmetry the polynomial is a + d (x² + y²); its weighted normal equations give a.
    const double h = 0.09, reach = 2 + h * h;
    const double beside = std::pow(1 + (1 + h * h) / (reach / 4), -2), corner = 1 / 25.0;
    const double r = (beside + 2 * corner) / (beside + 4 * corner);
    const double a = h / (1 + 4 * beside * (1 - r) + 4 * corner * (1 - 2 * r));
    const PointCloud cloud = graph(1, [&](int x, int y) { return x == 0 && y == 0 ? h : 0.0; });
    EXPECT_NEAR(smoothed(cloud, with(Method::mls, 8)).points.positions[4].z(), a, 1e-15);
    EXPECT_NEAR(smoothed(cloud, with(Method::mls, 24, std::sqrt(reach) + 1e-12)).points.positions[4].z(), a, 1e-12);
    EXPECT_GT(a, 5 * h / 9) << "it moves less than with equal weights";
}

TEST(Smooth, Quadrics_Stay) {
    const PointCloud cloud = graph(8, [](int x, int y) { return 0.002 * x * x - 0.001 * x * y; });
    for (const Method method : {Method::jet, Method::mls}) {
        const Smoothed result = smoothed(cloud, with(method));
        EXPECT_LT(result.moved_max, 1e-3);
        EXPECT_LT(result.moved_rms, result.moved_max);
        EXPECT_THAT(result.doubts, IsEmpty());
    }
    const Smoothed plane = smoothed(graph(6, [](int, int) { return 3.0; }));
    EXPECT_LT(plane.moved_max, 1e-14);
}

TEST(Smooth, Noise_Falls) {
    const PointCloud noisy = fibonacci_sphere(5000, 0.01, 3);
    const double before = roughness(noisy);
    const Smoothed jet = smoothed(noisy), mls = smoothed(noisy, with(Method::mls));
    EXPECT_LT(roughness(jet.points), 0.6 * before);
    EXPECT_LT(roughness(mls.points), 0.75 * before);
    EXPECT_LT(roughness(jet.points), roughness(mls.points)) << "equal weights average more";
    const Smoothed more = smoothed(noisy, with(Method::jet, 60));
    EXPECT_LT(roughness(more.points), roughness(jet.points));
    EXPECT_EQ(jet.metrics.find("moved-rms")->value, jet.moved_rms);
    EXPECT_EQ(jet.metrics.find("moved-max")->unit, Unit::length);
    EXPECT_EQ(jet.flat, 0u);
}

TEST(Smooth, NeighboursAtTheRadius_DoNotCount) {
    // The middle point is exactly 2.5 from (2, 0): within that distance it has eight neighbours, else twelve.
    const PointCloud cloud = graph(4, [](int x, int y) { return x == 0 && y == 0 ? 1.5 : 0.0; });
    const double without = smoothed(cloud, with(Method::jet, 24, 2.5)).points.positions[40].z();
    const double beyond = smoothed(cloud, with(Method::jet, 24, 2.5 + 1e-9)).points.positions[40].z();
    EXPECT_NEAR(without, smoothed(cloud, with(Method::jet, 8)).points.positions[40].z(), 1e-15);
    EXPECT_NEAR(beyond, smoothed(cloud, with(Method::jet, 12)).points.positions[40].z(), 1e-15);
    EXPECT_NE(without, beyond);
}

TEST(Smooth, LonelyPoints_Stay) {
    const PointCloud cloud = joined(graph(5, [](int, int) { return 0.0; }), cloud_of({{100, 0, 0}, {100, 1, 3}}));
    const Smoothed result = smoothed(cloud, with(Method::mls, 24, 2.5));
    EXPECT_EQ(result.flat, 2u);
    EXPECT_EQ(result.points.positions[121], Vec3(100, 0, 0));
    EXPECT_EQ(result.points.columns.find("moved")->number(122), 0);
}

TEST(Smooth, Duplicates_MoveTogetherAndDoNotCount) {
    PointCloud cloud = graph(1, [](int x, int y) { return x == 0 && y == 0 ? 0.09 : 0.0; });
    PointCloud repeated = joined(cloud, cloud_of({{0, 0, 0.09}, {0, 0, 0.09}}));
    const Smoothed result = smoothed(repeated, with(Method::jet, 8));
    EXPECT_EQ(result.points.positions[9], result.points.positions[4]);
    EXPECT_EQ(result.points.positions[4], smoothed(cloud, with(Method::jet, 8)).points.positions[4]);
}

TEST(Smooth, Columns_AreCarried) {
    PointCloud cloud = fibonacci_sphere(200);
    cloud.columns.add(Column("moved", 1, Buffer<float>(Array<float>(200, 7.f))));
    cloud.columns.add(Column("normal", 3, Buffer<float>(Array<float>(600, 1.f))));
    const Smoothed result = smoothed(cloud);
    EXPECT_THAT(result.warnings,
                ElementsAre(HasSubstr("the column 'moved' of the input is replaced"),
                            HasSubstr("the column 'normal' holds the normals from before the points moved")));
    EXPECT_LT(result.points.columns.find("moved")->number(0), 1);
    EXPECT_EQ(*result.points.columns.find("normal"), *cloud.columns.find("normal"));
    EXPECT_EQ(result.points.frame, cloud.frame);
}

TEST(Smooth, NeighbourhoodsAsLargeAsTheObject_AreDoubtful) {
    Random random(3);
    Array<Vec3> positions;
    for (int i = 0; i < 500; ++i) positions.emplace_back(random.uniform(), random.uniform(), random.uniform());
    PointCloud cloud;
    cloud.positions = std::move(positions);
    EXPECT_THAT(smoothed(cloud, with(Method::jet, 100)).doubts,
                ElementsAre(HasSubstr("they form no surface at that size")));
}

TEST(Smooth, OutliersAlone_AreDoubtful) {
    EXPECT_THAT(smoothed(random_cube(5000, 3)).doubts, ElementsAre(HasSubstr("they form no surface at that size")));
}

TEST(Smooth, TwoScales_MoveByTheirOwnNoise) {
    // Two spheres, one a hundredth of the other; both move as one alone does.
    const PointCloud noisy = fibonacci_sphere(3000, 0.01, 3);
    const Smoothed alone = smoothed(noisy), both = smoothed(joined(noisy, moved(noisy, 0x1p-7, {4, 0, 0})));
    const Column &one = *alone.points.columns.find("moved"), &two = *both.points.columns.find("moved");
    for (std::size_t row = 0; row < 3000; ++row) {
        EXPECT_EQ(two.number(row), one.number(row));
        EXPECT_NEAR(two.number(row + 3000), one.number(row) * 0x1p-7, 1e-9);
    }
}

TEST(Smooth, DoesNotDependOnThreadsOrOrder) {
    const PointCloud cloud = fibonacci_sphere(3000, 0.01);
    for (const SmoothParams& params : {with(Method::jet), with(Method::mls), with(Method::mls, 24, 0.1)}) {
        const Smoothed one = smoothed(cloud, params);
        EXPECT_TRUE(same_points(one.points, smoothed(cloud, params, 4).points));
        EXPECT_TRUE(same_points(smoothed(shuffled(cloud, 5), params).points, shuffled(one.points, 5)));
    }
}

TEST(SmoothRefuses, CloudsWithoutASurface) {
    EXPECT_THAT(sentence_of([] { smoothed({}); }), HasSubstr("the cloud has 0 points"));
    Array<Vec3> line;
    for (int i = 0; i < 40; ++i) line.emplace_back(i, i, i);
    PointCloud cloud;
    cloud.positions = std::move(line);
    const Error error = error_of([&] { smoothed(cloud); });
    EXPECT_EQ(error.sentence(),
              "none of the 40 positions has neighbours that determine a surface: they are too few, or on a line");
    EXPECT_FALSE(error.hint().empty());
    EXPECT_THAT(error_of([] { smoothed(fibonacci_sphere(100), with(Method::jet, 24, 1e-6)); }).hint(),
                HasSubstr("raise radius"));
    EXPECT_FALSE(error_of([] { smoothed(cloud_of({{1, 2, 3}})); }).hint().empty());
}

TEST(SmoothRefuses, NaN) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>(5, Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0));
    EXPECT_THAT(sentence_of([&] { smoothed(cloud); }), HasSubstr("5 of 5 points"));
}

TEST(SmoothRefuses, ParametersOutOfRange) {
    for (const u32 neighbours : {0u, 4u, 1001u})
        EXPECT_THAT(sentence_of([&] { smoothed(fibonacci_sphere(50), with(Method::jet, neighbours)); }),
                    HasSubstr("neighbours must be from 5 to 1000"));
    for (const double radius :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_THAT(error_of([&] { smoothed(fibonacci_sphere(50), with(Method::jet, 24, radius)); }).sentence(),
                    HasSubstr("radius must be above 0"));
}

TEST(Smooth, Cancelled_Ends) {
    for (const int after : {0, 1, 3}) {
        ContextOptions options;
        options.is_cancelled = [left = after]() mutable { return left-- <= 0; };
        Context context(options);
        EXPECT_THROW(smooth(fibonacci_sphere(20000), with(Method::jet, 24, 0.05), context), Cancelled) << after;
    }
}

TEST(SmoothReal, ARawView_MovesLessThanItsNoise) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/raw/bun000.ply");
    const std::shared_ptr<const PointCloud> cloud = read_points(path);
    const Smoothed result = smoothed(*cloud, {}, 2);
    // Spacing 0.00052; the residuals of local fits are 0.09 of it.
    EXPECT_LT(result.moved_rms, 0.3 * 0.00052);
    EXPECT_GT(result.moved_rms, 0.02 * 0.00052);
    EXPECT_THAT(result.doubts, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
