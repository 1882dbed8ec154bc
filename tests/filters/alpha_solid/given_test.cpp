// SPDX-License-Identifier: GPL-3.0-or-later
/// A given alpha is used unchanged; when its solid is not valid, one sentence gives the reason and a valid alpha.

#include <gmock/gmock.h>

#include <charconv>
#include <cmath>
#include <numbers>

#include "alpha_solid/selection.hpp"
#include "filters/alpha_solid/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The number after "valid one is".
double named_alpha(const std::string& warning) {
    const std::string_view before = "gives a valid one is ";
    const std::size_t begin = warning.find(before) + before.size();
    double value = 0;
    std::from_chars(warning.data() + begin, warning.data() + warning.size(), value);
    return value;
}

TEST(AlphaSolidGiven, CubesThatTouchInACorner_AreReportedWithAValidAlpha) {
    // Across the corner the cubes' unit squares have half diagonal 0.7071; the next radius closes the corner's notch.
    const TetMesh tets = tets_of(cubes_sharing_a_corner());
    const auto warnings = warnings_of(tets, at_alpha(0.71));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_THAT(warnings[0], HasSubstr("at alpha 0.71 u the solid is not valid: its boundary has 1 non-manifold vertex "
                                       "and 0 edges with more than two triangles; the nearest alpha"));
    EXPECT_EQ(named_alpha(warnings[0]), 0.8661);  // √3/2 = 0.86602…, rounded up so that it is valid
    EXPECT_FALSE(solid_of(tets, at_alpha(named_alpha(warnings[0]))).nearest_valid);
    EXPECT_NEAR(solid_of(tets).alpha, std::sqrt(3.0) / 2, 1e-9);
}

TEST(AlphaSolidGiven, TwoSpheres_AreReportedAsComponentsAndPointsOutside) {
    const TetMesh tets = tets_of(two_spheres());
    const double both = solid_of(tets, many()).alpha;
    const auto components = warnings_of(tets, at_alpha(1.01 * both));
    ASSERT_EQ(components.size(), 1u);
    EXPECT_THAT(components[0], HasSubstr("the solid is not valid: it has 2 components; the nearest alpha"));
    EXPECT_FALSE(solid_of(tets, at_alpha(named_alpha(components[0]))).nearest_valid);
    EXPECT_THAT(warnings_of(tets,
                            [&] {
                                AlphaSolidParams params = many();
                                params.alpha = Length(1.01 * both);
                                return params;
                            }()),
                IsEmpty());

    // The spacing of the half-size sphere is smaller: it appears alone.
    const AlphaSolidResult small = solid_of(tets, at_alpha(0.75 * both));
    ASSERT_GT(small.uncovered_points.size(), 0u);
    const auto outside = warnings_of(tets, at_alpha(0.75 * both));
    ASSERT_EQ(outside.size(), 1u);
    EXPECT_THAT(outside[0], HasSubstr(std::to_string(small.uncovered_points.size()) + " of 900 points are outside"));
}

TEST(AlphaSolidGiven, AboveAValidSolidThatIsNearer_ThatOneIsNamed) {
    // Random clouds: valid at some radii, pinched at others just above.
    int named_below = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const TetMesh tets = tets_of(random_cube(80, seed));
        const AlphaSolidResult chosen = solid_of(tets);
        for (double factor : {1.02, 1.05, 1.1, 1.2}) {
            const AlphaSolidResult result = solid_of(tets, at_alpha(factor * chosen.alpha));
            if (!result.nearest_valid || result.nearest_valid->least > result.alpha) continue;
            ++named_below;
            EXPECT_LT(result.nearest_valid->largest, result.alpha);
            for (double alpha : {result.nearest_valid->least, result.nearest_valid->largest})
                EXPECT_FALSE(solid_of(tets, at_alpha(alpha)).nearest_valid);
            const auto warnings = warnings_of(tets, at_alpha(result.alpha));
            ASSERT_EQ(warnings.size(), 1u);
            EXPECT_LT(named_alpha(warnings[0]), result.alpha);
            EXPECT_FALSE(solid_of(tets, at_alpha(named_alpha(warnings[0]))).nearest_valid) << warnings[0];
        }
    }
    EXPECT_GT(named_below, 3);
}

TEST(AlphaSolidGiven, AValidAlpha_IsUsedWithoutAWarning) {
    const TetMesh tets = tets_of(fibonacci_sphere(500, 1e-4));
    const double least = solid_of(tets).alpha;
    for (double factor : {1.0, 1.3, 4.0}) {
        const AlphaSolidResult result = solid_of(tets, at_alpha(factor * least));
        EXPECT_FALSE(result.nearest_valid);
        EXPECT_THAT(warnings_of(tets, at_alpha(factor * least)), IsEmpty());
        EXPECT_EQ(result.alpha, factor * least);
    }
}

TEST(AlphaSolidGiven, WhereOnlyTheHullIsValid_TheSentenceNamesItsRadius) {
    // Two unit cubes ten apart are joined only when the ball spans from one to the other.
    PointCloud cubes = joined(lattice_cube(1), moved(lattice_cube(1), 1, Vec3(10, 0, 0)));
    const TetMesh tets = tets_of(cubes);
    Context context;
    const AlphaSolidResult result = alpha_solid(tets, at_alpha(1), context);
    ASSERT_TRUE(result.nearest_valid);
    // A facet of two corners on one edge and one across the gap of 9: its circumradius is half of its longest side.
    EXPECT_NEAR(result.nearest_valid->least, std::sqrt(82.0) / 2, 1e-12);
    EXPECT_TRUE(std::isinf(result.nearest_valid->largest));
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("the nearest alpha that gives a valid one is 4.528 ")));
}

TEST(AlphaSolidGiven, PointsOutsideThatTheShareAllows_AreOnlyCounted) {
    Array<Vec3> far;
    for (int i = 0; i < 5; ++i) far.push_back(Vec3(3 + i, 2 * i, 1 - i));
    PointCloud outliers;
    outliers.positions = std::move(far);
    const TetMesh tets = tets_of(joined(outliers, fibonacci_sphere(995, 1e-4)));
    AlphaSolidParams params = covering(99.5);
    params.alpha = Length(0.15);
    EXPECT_THAT(warnings_of(tets, params), ElementsAre(HasSubstr("5 of 1000 points are not in or on the solid")));
    params.coverage = Ratio::percent(100);
    EXPECT_THAT(warnings_of(tets, params), ElementsAre(HasSubstr("not valid: 5 of 1000 points are outside of it")));
}

TEST(AlphaSolidGiven, TextWithin_HasTheFewestDigitsInside) {
    using alpha::text_within;
    EXPECT_EQ(text_within({0.8660254037844386, 0.9}, 0.7), "0.8661");
    EXPECT_EQ(text_within({1.0, 2.0}, 0.5), "1");
    EXPECT_EQ(text_within({0.123456, 0.123458}, 0.1), "0.123456");
    EXPECT_EQ(text_within({0.1234561, 0.123459}, 0.1), "0.123457");
    EXPECT_EQ(text_within({0.5, 0.99999}, 1.1), "0.9999");
    EXPECT_EQ(text_within({98.76543, 98.765487}, 1000), "98.76548");
    EXPECT_EQ(text_within({1234567.5, 1234570}, 1), "1.23457e+06");
    const double next = std::nextafter(0.1, 1.0);
    EXPECT_EQ(text_within({next, next}, 0.01), "0.10000000000000002");
}

TEST(AlphaSolidAmbiguity, FilledLatticeCube_IsReportedToHavePointsInside) {
    EXPECT_THAT(
        warnings_of(tets_of(lattice_cube(6)), {}),
        ElementsAre(HasSubstr(
            "125 of 343 points lie inside the solid instead of on its boundary: gaps and hollows narrower than")));
}

TEST(AlphaSolidAmbiguity, AlphaFarAboveTheCover_IsReportedWithBothNumbers) {
    // Valid first at √3/2, covered at √2/2: 1.22 times.
    const auto warnings = warnings_of(tets_of(cubes_sharing_a_corner()), {});
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_THAT(warnings[0], HasSubstr("alpha 0.866 u is 1.22 times the 0.7071 u that would cover the points"));
    EXPECT_THAT(warnings[0], HasSubstr("points lie inside the solid"));
    EXPECT_THAT(warnings[0], HasSubstr("sculpt reopens some of them"));
}

TEST(AlphaSolidAmbiguity, CleanScans_GiveNoWarning) {
    for (const PointCloud& cloud : {fibonacci_sphere(700, 1e-4), poisson_torus(0.06, 0.4, 20000), lattice_cube(1),
                                    l_block_surface(10, 2, 10), lattice_cube(6, 1, true)})
        EXPECT_THAT(warnings_of(tets_of(cloud), {}), IsEmpty());
}

/// Lattice points of a bent bar whose two ends meet in one corner, (4, 4, 4), like jaw and skull.
PointCloud bar_biting_its_corner() {
    const std::vector<std::array<Vec3, 2>> blocks{{Vec3(0, 0, 0), Vec3(4, 4, 4)},   {Vec3(0, 0, -4), Vec3(4, 4, 0)},
                                                  {Vec3(4, 0, -4), Vec3(12, 4, 0)}, {Vec3(8, 0, 0), Vec3(12, 4, 8)},
                                                  {Vec3(8, 4, 4), Vec3(12, 8, 8)},  {Vec3(4, 4, 4), Vec3(8, 8, 8)}};
    std::set<Point> places;
    for (const auto& [low, high] : blocks)
        for (double x = low.x(); x <= high.x(); ++x)
            for (double y = low.y(); y <= high.y(); ++y)
                for (double z = low.z(); z <= high.z(); ++z) places.insert({x, y, z});
    Array<Vec3> positions;
    for (const auto& [x, y, z] : places) positions.push_back(Vec3(x, y, z));
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

TEST(AlphaSolidSkull, EdgeManifoldButPinchedInOneVertex_IsNotReportedAsManifold) {
    const TetMesh tets = tets_of(bar_biting_its_corner());
    // Four blocks of 4³ unit cubes and two of twice as many; the squares of the lattice are walls from half their
    // diagonal on.
    const AlphaSolidResult pinched = solid_of(tets, at_alpha(0.7072));
    EXPECT_EQ(pinched.nonmanifold_edges, 0u);
    EXPECT_EQ(pinched.nonmanifold_vertices, 1u);
    EXPECT_EQ(pinched.components, 1u);
    EXPECT_EQ(pinched.uncovered_points.size(), 0u);
    EXPECT_NEAR(cell_volumes(pinched), 8 * 64, 1e-9);
    // A sphere with two points made one: V − E + F = 1.
    const MeshTopology properties = topology(pinched.mesh);
    EXPECT_EQ(properties.euler, 1);
    EXPECT_FALSE(properties.closed);
    EXPECT_EQ(properties.nonmanifold_vertices, 1u);

    const AlphaSolidResult result = solid_of(tets);
    EXPECT_EQ(result.choice, AlphaChoice::scan);
    EXPECT_GT(result.alpha, 0.7072);
    EXPECT_NEAR(result.alpha_cover, 1 / std::numbers::sqrt2, 1e-9);
    EXPECT_TRUE(topology(result.mesh).closed);
}

}  // namespace
}  // namespace scanmill
