// SPDX-License-Identifier: GPL-3.0-or-later
/// Which of several points near each other is kept.
#include <gmock/gmock.h>

#include <cmath>
#include <numeric>
#include <set>

#include "filters/merge/cases.hpp"
#include "scanmill/base/random.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Prefer = MergeParams::Prefer;

/// The rule, implemented directly and slowly.
std::vector<u32> kept_by_definition(const Clouds& clouds, double distance, bool lower_uncertainty) {
    struct Point {
        double preference;
        u32 source, row;
        Vec3 position;
    };
    std::vector<Point> points;
    for (u32 source = 0; source < clouds.size(); ++source)
        for (u32 row = 0; row < clouds[source].size(); ++row)
            points.push_back({lower_uncertainty ? clouds[source].columns.find("uncertainty")->number(row) : 0, source,
                              static_cast<u32>(points.size()), clouds[source].positions[row]});
    std::ranges::sort(points, {}, [](const Point& p) { return std::tuple(p.preference, p.source, p.row); });
    std::vector<Point> kept;
    for (const Point& point : points)
        if (std::ranges::none_of(kept, [&](const Point& other) {
                return other.source != point.source &&
                       (other.position - point.position).squaredNorm() <= distance * distance;
            }))
            kept.push_back(point);
    std::vector<u32> rows;
    for (const Point& point : kept) rows.push_back(point.row);
    std::ranges::sort(rows);
    return rows;
}

PointCloud with_random_uncertainty(const PointCloud& cloud, u64 seed, u32 values) {
    Random random(seed);
    Array<float> numbers(cloud.size());
    for (float& number : numbers) number = static_cast<float>(random.index(values));
    return with_uncertainty(cloud, std::move(numbers));
}

std::multiset<std::array<double, 4>> places_and_sources(const PointCloud& cloud) {
    std::multiset<std::array<double, 4>> result;
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const Vec3& p = cloud.positions[row];
        result.insert({p.x(), p.y(), p.z(), cloud.columns.find("source")->number(row)});
    }
    return result;
}

TEST(MergeOverlap, ByHand_TheEarlierInputIsKept) {
    const Clouds clouds{cloud_of({{0, 0, 0}, {0.5, 0, 0}}), cloud_of({{1, 0, 0}, {1.75, 0, 0}, {0, 0.9, 0}})};
    // 1 is 0.5 from 0.5; 1.75 is 1.25 from it; the last is 0.9 from the first.
    EXPECT_THAT(merged(clouds, within(0.5)).kept, ElementsAre(0u, 1u, 3u, 4u));
    EXPECT_THAT(merged(clouds, within(0.9)).kept, ElementsAre(0u, 1u, 3u));
    EXPECT_THAT(merged(clouds, within(1.25)).kept, ElementsAre(0u, 1u));
    EXPECT_EQ(merged(clouds, within(1.25)).dropped, 3u);
    EXPECT_EQ(merged(clouds, within(1.25)).metrics.find("dropped")->value, 3);
}

TEST(MergeOverlap, ExactlyAsFar_IsWithin) {
    const Clouds clouds{cloud_of({{0, 0, 0}}), cloud_of({{1, 0, 0}})};
    EXPECT_THAT(merged(clouds, within(1)).kept, ElementsAre(0u));
    EXPECT_THAT(merged(clouds, within(std::nextafter(1.0, 0.0))).kept, ElementsAre(0u, 1u));
}

TEST(MergeOverlap, PointsOfOneInput_NeverDropEachOther) {
    const Clouds clouds{cloud_of({{0, 0, 0}, {0, 0, 0}, {0.1, 0, 0}}), cloud_of({{9, 0, 0}, {9, 0, 0}})};
    EXPECT_EQ(merged(clouds, within(1)).dropped, 0u);
}

TEST(MergeOverlap, DroppedPoints_DropNoOthers) {
    // The second is dropped for the first; the third is near the second only.
    const Clouds clouds{cloud_of({{0, 0, 0}}), cloud_of({{1, 0, 0}}), cloud_of({{2, 0, 0}})};
    EXPECT_THAT(merged(clouds, within(1)).kept, ElementsAre(0u, 2u));
}

TEST(MergeOverlap, LowerUncertainty_WinsInAnyOrder) {
    const Clouds clouds{with_uncertainty(cloud_of({{0, 0, 0}, {5, 0, 0}}), {3, 1}),
                        with_uncertainty(cloud_of({{0.5, 0, 0}, {5.5, 0, 0}}), {2, 2})};
    EXPECT_THAT(merged(clouds, within(1, Prefer::lower_uncertainty)).kept, ElementsAre(1u, 2u));
    EXPECT_THAT(merged(clouds, within(1)).kept, ElementsAre(0u, 1u));
}

TEST(MergeOverlap, EqualUncertainty_TheEarlierInputWinsThenTheEarlierRow) {
    const Clouds clouds{with_uncertainty(cloud_of({{1, 0, 0}}), {2}),
                        with_uncertainty(cloud_of({{0, 0, 0}, {2, 0, 0}}), {2, 2})};
    EXPECT_THAT(merged(clouds, within(1, Prefer::lower_uncertainty)).kept, ElementsAre(0u));
    // Rows 0 and 1 of input 1 both lie near the point of input 2.
    const Clouds rows{with_uncertainty(cloud_of({{9, 0, 0}}), {0}),
                      with_uncertainty(cloud_of({{0, 0, 0}, {2, 0, 0}}), {2, 2}),
                      with_uncertainty(cloud_of({{1, 0, 0}}), {2})};
    EXPECT_THAT(merged(rows, within(1, Prefer::lower_uncertainty)).kept, ElementsAre(0u, 1u, 2u));
}

TEST(MergeOverlap, InfiniteUncertainty_LosesToAnyOther) {
    const Clouds clouds{with_uncertainty(cloud_of({{0, 0, 0}}), {std::numeric_limits<float>::infinity()}),
                        with_uncertainty(cloud_of({{0, 0, 0}}), {1e30f})};
    EXPECT_THAT(merged(clouds, within(1, Prefer::lower_uncertainty)).kept, ElementsAre(1u));
}

TEST(MergeOverlap, RandomClouds_AgreeWithTheDefinition) {
    for (u64 seed = 0; seed < 10; ++seed) {
        Clouds clouds;
        for (u64 source = 0; source < 2 + seed % 3; ++source)
            clouds.push_back(with_random_uncertainty(
                seed % 2 ? random_sphere(400, 10 * seed + source) : random_cube(400, 10 * seed + source), seed + source,
                1 + 20 * (seed % 4)));
        for (const double distance : {1e-9, 0.01, 0.07, 0.2, 0.6, 5.0})
            for (const Prefer prefer : {Prefer::none, Prefer::lower_uncertainty})
                EXPECT_THAT(merged(clouds, within(distance, prefer)).kept,
                            ::testing::ElementsAreArray(
                                kept_by_definition(clouds, distance, prefer == Prefer::lower_uncertainty)))
                    << seed << " " << distance;
    }
}

/// All distances are multiples of that of the grid; half of the points lie on borders of cells.
TEST(MergeOverlap, Lattices_AgreeWithTheDefinition) {
    const Clouds clouds{lattice_cube(5), moved(lattice_cube(5), 1, Vec3(0.5, 0, 0)),
                        moved(lattice_cube(5), 1, Vec3(-1, 3, 0))};
    for (const double distance : {0.5, 1.0, std::sqrt(1.25), 2.0})
        EXPECT_THAT(merged(clouds, within(distance)).kept,
                    ::testing::ElementsAreArray(kept_by_definition(clouds, distance, false)))
            << distance;
}

TEST(MergeOverlap, DistanceFarBelowTheExtent_AgreesWithTheDefinition) {
    // The grid cannot number so many cells of this size, so it uses larger ones.
    const double fine = 0x1p-30;
    const Clouds clouds{cloud_of({{0, 0, 0}, {1000, 1000, 1000}}),
                        cloud_of({{fine, 0, 0}, {1000, 1000, 1000 - 2 * fine}, {500, 0, 0}})};
    EXPECT_THAT(merged(clouds, within(fine)).kept, ElementsAre(0u, 1u, 3u, 4u));
    EXPECT_THAT(merged(clouds, within(2 * fine)).kept, ElementsAre(0u, 1u, 4u));
}

TEST(MergeOverlap, RowsInAnotherOrder_KeepTheSamePoints) {
    const PointCloud a = random_sphere(3000, 1), b = random_sphere(3000, 2);
    EXPECT_EQ(places_and_sources(merged({a, b}, within(0.03)).points),
              places_and_sources(merged({shuffled(a, 7), shuffled(b, 8)}, within(0.03)).points));
    // Without equal uncertainties the same holds for them: these are the even and the odd numbers below 6000.
    Array<float> first(3000), second(3000);
    for (u32 i = 0; i < 3000; ++i) {
        first[i] = static_cast<float>(i * 2003 % 3000 * 2);
        second[i] = static_cast<float>(i * 1999 % 3000 * 2 + 1);
    }
    const PointCloud c = with_uncertainty(a, first), d = with_uncertainty(b, second);
    const MergeParams params = within(0.03, Prefer::lower_uncertainty);
    EXPECT_EQ(places_and_sources(merged({c, d}, params).points),
              places_and_sources(merged({shuffled(c, 7), shuffled(d, 8)}, params).points));
}

TEST(MergeOverlap, TwoThreads_GiveTheSameBytes) {
    const Clouds clouds{random_sphere(50'000, 1), random_sphere(50'000, 2)};
    const Merged one = merged(clouds, within(0.01), 1), two = merged(clouds, within(0.01), 2);
    EXPECT_GT(one.dropped, 1000u);
    EXPECT_EQ(one.kept, two.kept);
    EXPECT_TRUE(std::ranges::equal(one.points.positions, two.points.positions));
    EXPECT_EQ(one.points.columns, two.points.columns);
}

TEST(MergeOverlap, MergingTheResultWithAnInputAgain_AddsNothing) {
    const PointCloud a = random_sphere(5000, 1), b = random_sphere(5000, 2);
    const PointCloud once = merged({a, b}, within(0.05)).points;
    const Merged twice = merged({once, a}, within(0.05));
    EXPECT_EQ(twice.points.size(), once.size()) << "every point of a is in it";
}

TEST(MergeOverlap, PreferenceWithoutADistance_IsReported) {
    const Clouds clouds{with_uncertainty(cloud_of({{0, 0, 0}}), {1})};
    EXPECT_THAT(merged(clouds, within(0, Prefer::lower_uncertainty)).warnings,
                ElementsAre(HasSubstr("while `within` is 0")));
}

TEST(MergeOverlap, Cancelled_Stops) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    const auto cloud = std::make_shared<const PointCloud>(random_cube(100, 1));
    const std::vector<std::shared_ptr<const PointCloud>> inputs{cloud, cloud};
    EXPECT_THROW(merge(inputs, within(1), context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
