// SPDX-License-Identifier: GPL-3.0-or-later
/// Open, thin, damaged and unusual clouds: a clear refusal, or a closed surface and what is doubtful about it.

#include <gmock/gmock.h>

#include "filters/tight_cocone/cases.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double pi = std::numbers::pi;

TEST(TightCoconeOfBadInput, Weights_AreRefused) {
    DelaunayParams weighted;
    weighted.weights = "spacing";
    Context context;
    const TetMesh tets = delaunay(fibonacci_sphere(200, 1e-3), weighted, context).tets;
    const Error error = error_of([&] { closed_through(tets); });
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("without weights"), HasSubstr("200 points")));
    EXPECT_THAT(error.hint(), HasSubstr("without `weights`"));
}

TEST(TightCoconeOfBadInput, TetrahedraWithoutCellsOrNeighbours_AreRefused) {
    EXPECT_THAT(sentence_of([] { closed_through(TetMesh{}); }), HasSubstr("has none"));
    TetMesh tets = tets_of(fibonacci_sphere(50));
    tets.neighbours = Buffer<std::array<u32, 4>>();
    const Error error = error_of([&] { closed_through(tets); });
    EXPECT_THAT(error.sentence(), HasSubstr("there are 0"));
    EXPECT_THAT(error.hint(), HasSubstr("delaunay"));
}

TEST(TightCoconeOfBadInput, ParametersOutOfRange_AreRefused) {
    const TetMesh tets = tets_of(fibonacci_sphere(50));
    const auto refused = [&](const auto& set) {
        TightCoconeParams params;
        set(params);
        return sentence_of([&] { closed_through(tets, params); });
    };
    for (const double angle : {4.9, 40.1, std::nan("")})
        EXPECT_THAT(refused([&](auto& p) { p.cone_angle = Angle::degrees(angle); }), HasSubstr("cone-angle"));
    for (const double angle : {89.9, 170.1})
        EXPECT_THAT(refused([&](auto& p) { p.prune_angle = Angle::degrees(angle); }), HasSubstr("prune-angle"));
    for (const double angle : {9.9, 90.1})
        EXPECT_THAT(refused([&](auto& p) { p.normal_angle = Angle::degrees(angle); }), HasSubstr("normal-angle"));
    for (const double angle : {59.9, 180.1})
        EXPECT_THAT(refused([&](auto& p) { p.gap_angle = Angle::degrees(angle); }), HasSubstr("gap-angle"));
    for (const double ratio : {0.99, std::nan("")})
        EXPECT_THAT(refused([&](auto& p) { p.ratio = ratio; }), HasSubstr("ratio must be at least 1"));
    for (const double factor : {0.0, -1.0, std::nan("")})
        EXPECT_THAT(refused([&](auto& p) { p.lid_factor = factor; }), HasSubstr("lid-factor must be above 0"));
}

TEST(TightCoconeOfBadInput, WhenCancelled_StopsWithCancelled) {
    const TetMesh tets = tets_of(noisy(fibonacci_sphere(6000), 0.02));
    for (const auto noise : {TightCoconeParams::Noise::none, TightCoconeParams::Noise::big_balls})
        for (const int limit : {0, 5}) {
            int asked = 0;
            ContextOptions options;
            options.is_cancelled = [&] { return ++asked > limit; };
            Context context(options);
            TightCoconeParams params;
            params.noise = noise;
            EXPECT_THROW(tight_cocone(tets, params, context), Cancelled);
        }
}

TEST(TightCoconeOfBadInput, ColumnsOfTheSameName_AreRenamedWithAWarning) {
    PointCloud cloud = fibonacci_sphere(300, 1e-4);
    Array<u32> rows(300);
    for (u32 row = 0; row < 300; ++row) rows[row] = row;
    cloud.columns.add(Column("flat", 1, Buffer<u32>(std::move(rows))));
    const Outcome outcome = outcome_of(cloud);
    ASSERT_TRUE(outcome.result);
    EXPECT_THAT(outcome.warnings, Contains(AllOf(HasSubstr("'flat'"), HasSubstr("'flat-of-points'"))));
    for (const ColumnTable* table : {&outcome.result->mesh.vertex_columns, &outcome.result->tets.vertex_columns}) {
        ASSERT_NE(table->find("flat-of-points"), nullptr);
        const std::span<const u32> old = table->find("flat-of-points")->values<u32>();
        for (u32 row = 0; row < 300; ++row) EXPECT_EQ(old[row], row);
        EXPECT_EQ(table->find("flat")->type(), ScalarType::uint8);
        EXPECT_EQ(table->find("boundary")->type(), ScalarType::uint8);
        EXPECT_EQ(table->find("pole-normal")->components(), 3u);
    }
}

/// A closed surface with a doubt about the share that no point shows or about unused points, or a refusal with its
/// numbers and a way out.
void expect_doubtful_or_refused(const Outcome& outcome, std::size_t points) {
    if (outcome.refusal) {
        EXPECT_THAT(outcome.refusal->sentence(), HasSubstr(std::to_string(points) + " points"));
        EXPECT_THAT(outcome.refusal->hint(),
                    AllOf(HasSubstr("voxel-thin"), HasSubstr("big-balls"), HasSubstr("alpha-solid")));
        return;
    }
    expect_promised(*outcome.result, points);
    const bool is_invented = outcome.result->invented_area > 0.1 * outcome.result->area;
    const bool leaves_points = 50 * outcome.result->unused > points;
    EXPECT_TRUE(is_invented || leaves_points);
    if (is_invented) {
        EXPECT_THAT(outcome.doubts, Contains(HasSubstr("% of the area")));
    }
    if (leaves_points) {
        EXPECT_THAT(outcome.doubts, Contains(HasSubstr("points are not on the surface")));
    }
}

TEST(TightCoconeOfBadInput, PointsInABall_AreDoubtful) {
    for (const std::size_t count : {200, 1000, 4000}) {
        const PointCloud ball = points_where(moved(random_cube(2 * count, 5), 2, Vec3(-1, -1, -1)),
                                             [](const Vec3& p) { return p.norm() < 1; });
        expect_doubtful_or_refused(outcome_of(ball), ball.size());
    }
}

TEST(TightCoconeOfBadInput, PointsInABallWithBigBalls_AreRefused) {
    // All large balls are connected to the outside.
    const PointCloud ball =
        points_where(moved(random_cube(2000, 5), 2, Vec3(-1, -1, -1)), [](const Vec3& p) { return p.norm() < 1; });
    const Outcome outcome = outcome_of(ball, with_big_balls());
    ASSERT_TRUE(outcome.refusal);
    EXPECT_THAT(outcome.refusal->sentence(), AllOf(HasSubstr("noise-factor 1"), HasSubstr("large cells")));
    EXPECT_THAT(outcome.refusal->hint(), HasSubstr("noise-factor"));
}

TEST(TightCoconeOfBadInput, NoiseOfHalfASpacing_IsDoubtfulWithoutBigBalls) {
    const PointCloud cloud = noisy(fibonacci_sphere(2900), 0.5 * std::sqrt(4 * pi / 2900));
    expect_doubtful_or_refused(outcome_of(cloud), cloud.size());
}

/// Points on a curve have no good point, and the outside spreads everywhere.
TEST(TightCoconeOfBadInput, PointsOnAHelix_AreRefusedWithTheirCounts) {
    for (const std::size_t count : {30, 300}) {
        Array<Vec3> positions;
        for (std::size_t i = 0; i < count; ++i) {
            const double turn = 0.1 * static_cast<double>(i);
            positions.emplace_back(std::cos(turn), std::sin(turn), 0.2 * turn);
        }
        PointCloud helix;
        helix.positions = std::move(positions);
        const Outcome outcome = outcome_of(helix);
        ASSERT_TRUE(outcome.refusal);
        expect_doubtful_or_refused(outcome, count);
        const std::string counts = "0 points are good and " + std::to_string(count) + " poor";
        EXPECT_THAT(outcome.refusal->sentence(), AllOf(HasSubstr("candidates"), HasSubstr(counts)));
    }
}

TEST(TightCoconeOfBadInput, CoplanarPoints_AreRefused) {
    EXPECT_THAT(sentence_of([] { closed_through(flat_square(0)); }), HasSubstr("of one plane"));
}

TEST(TightCoconeOfBadInput, NearlyFlatPoints_AreClosedWithADoubt) {
    expect_doubtful_or_refused(outcome_of(flat_square(1e-3)), 500);
}

TEST(TightCoconeOfBadInput, Duplicates_ChangeNothing) {
    const PointCloud cloud = fibonacci_sphere(400, 1e-3);
    const TightCoconeResult clean = closed_through(cloud),
                            repeated = closed_through(joined(joined(cloud, shuffled(cloud, 3)), cloud));
    EXPECT_TRUE(std::ranges::equal(clean.mesh.triangles, repeated.mesh.triangles));
    EXPECT_TRUE(std::ranges::equal(clean.mesh.positions, repeated.mesh.positions));
    EXPECT_EQ(repeated.unused, 0u);
}

TEST(TightCoconeOfBadInput, TenPoints_AreTheirHull) {
    const TightCoconeResult result = closed_through(fibonacci_sphere(10));
    expect_promised(result, 10);
    EXPECT_EQ(result.mesh.triangles.size(), 16u);
    EXPECT_EQ(std::ranges::count(result.tets.inside, u8(1)), static_cast<long>(result.tets.cells.size()));
}

TEST(TightCoconeOfBadInput, Hemisphere_IsClosedWithADoubtAboutItsBase) {
    const PointCloud cloud = points_where(fibonacci_sphere(1000, 1e-6), [](const Vec3& p) { return p.z() >= 0; });
    const Outcome outcome = outcome_of(cloud);
    ASSERT_TRUE(outcome.result);
    expect_promised(*outcome.result, cloud.size());
    EXPECT_EQ(topology(outcome.result->mesh).euler, 2);
    EXPECT_EQ(outcome.result->holes_filled, 1u);
    EXPECT_NEAR(outcome.result->invented_area, pi, 0.02 * pi);
    EXPECT_NEAR(volume(outcome.result->mesh), 2 * pi / 3, 0.04 * 2 * pi / 3);
    EXPECT_THAT(outcome.doubts, Contains(AllOf(HasSubstr("% of the area"), HasSubstr("1 hole"))));
}

TEST(TightCoconeOfBadInput, Patch_IsClosedWithADoubtAboutItsLid) {
    const Outcome outcome = outcome_of(curved_patch());
    ASSERT_TRUE(outcome.result);
    expect_promised(*outcome.result, 441);
    EXPECT_EQ(topology(outcome.result->mesh).euler, 2);
    EXPECT_EQ(outcome.result->holes_filled, 1u);
    EXPECT_GT(outcome.result->invented_area, 0.4 * outcome.result->area);
    EXPECT_THAT(outcome.doubts, Contains(AllOf(HasSubstr("% of the area"), HasSubstr("1 hole"))));
}

TEST(TightCoconeOfBadInput, SmallHole_IsFilledWithAWarning) {
    const Outcome outcome =
        outcome_of(points_where(fibonacci_sphere(2000, 1e-6), [](const Vec3& p) { return p.z() < 0.95; }));
    ASSERT_TRUE(outcome.result);
    EXPECT_LT(outcome.result->invented_area, 0.1 * outcome.result->area);
    EXPECT_EQ(outcome.result->holes_filled, 1u);
    EXPECT_THAT(outcome.doubts, IsEmpty());
    EXPECT_THAT(outcome.warnings, Contains(AllOf(HasSubstr("% of the area"), HasSubstr("1 hole"))));
}

TEST(TightCoconeOfBadInput, SheetsCloserThanTheSpacing_AreClosed) {
    for (const double distance : {0.05, 0.3, 0.7}) {
        const PointCloud sheet = curved_patch();
        const PointCloud both = joined(sheet, moved(noisy(sheet, 0.02), 1, Vec3(0.3, 0.4, distance)));
        const Outcome outcome = outcome_of(both);
        ASSERT_TRUE(outcome.result) << distance;
        expect_promised(*outcome.result, both.size());
        EXPECT_EQ(intersections(outcome.result->mesh), 0u);
    }
}

TEST(TightCoconeOfBadInput, SphereJustInsideASphere_IsClosed) {
    // Less than a tenth to two spacings apart.
    for (const double distance : {0.005, 0.03, 0.06, 0.15}) {
        const PointCloud both =
            joined(fibonacci_sphere(1500, 1e-6), moved(fibonacci_sphere(1500, 1e-6, 2), 1 - distance));
        const Outcome outcome = outcome_of(both);
        ASSERT_TRUE(outcome.result) << distance;
        expect_promised(*outcome.result, both.size());
        EXPECT_NEAR(volume(outcome.result->mesh), 4 * pi / 3, 0.02 * 4 * pi / 3) << distance;
        if (topology(outcome.result->mesh).euler != 2) {
            EXPECT_THAT(outcome.doubts, testing::Not(IsEmpty())) << distance;
        }
    }
}

/// The sphere is found, and the outliers are left out with a doubt.
TEST(TightCoconeOfBadInput, OutliersAroundASphere_AreLeftOut) {
    for (const std::size_t points : {1000, 10000}) {
        const std::size_t outliers = points / 20;
        const PointCloud cloud =
            joined(fibonacci_sphere(points, 1e-6), moved(random_cube(outliers, 4), 4, Vec3(-2, -2, -2)));
        const Outcome outcome = outcome_of(cloud);
        expect_doubtful_or_refused(outcome, cloud.size());
        ASSERT_TRUE(outcome.result);
        EXPECT_EQ(topology(outcome.result->mesh).euler, 2);
        EXPECT_NEAR(volume(outcome.result->mesh), 4 * pi / 3, 0.05);
        EXPECT_GT(outcome.result->unused, outliers * 9 / 10);
    }
}

}  // namespace
}  // namespace scanmill
