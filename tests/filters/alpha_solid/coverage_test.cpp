// SPDX-License-Identifier: GPL-3.0-or-later
/// A share of the points: alpha never falls when the share rises, and points that a given alpha leaves out are
/// reported.

#include <gmock/gmock.h>

#include "filters/alpha_solid/cases.hpp"
#include "scanmill/base/random.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

AlphaSolidParams given(double alpha, double percent, AlphaComponents components = AlphaComponents::single) {
    AlphaSolidParams params = covering(percent, components);
    params.alpha = Length(alpha);
    return params;
}

/// An open plate: a lattice whose points are moved by up to `roughness` along each axis.
PointCloud open_plate(std::uint64_t seed, double roughness) {
    Random random(seed);
    Array<Vec3> positions;
    for (int x = 0; x < 12; ++x)
        for (int y = 0; y < 12; ++y) {
            Vec3 p(x, y, 0);
            for (double& coordinate : p) coordinate += random.uniform(-roughness, roughness);
            positions.push_back(p);
        }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

/// Returns how many of these shares need a larger alpha than the one before.
int expect_alpha_to_rise(const TetMesh& tets, AlphaComponents components) {
    int steps = 0;
    double before = 0;
    for (double share : {30.0, 50.0, 60.0, 70.0, 80.0, 90.0, 95.0, 99.0, 99.9, 100.0}) {
        const double alpha = solid_of(tets, covering(share, components)).alpha;
        EXPECT_GE(alpha, before) << share << " %";
        steps += alpha > before;
        before = alpha;
    }
    return steps;
}

TEST(AlphaSolidCoverage, OfRandomClouds_RaisesAlpha) {
    int steps = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed)
        for (AlphaComponents components : {AlphaComponents::single, AlphaComponents::many})
            steps += expect_alpha_to_rise(tets_of(random_cube(20 + 2 * seed, seed)), components);
    EXPECT_GT(steps, 150);
}

TEST(AlphaSolidCoverage, OfOpenPlates_RaisesAlpha) {
    for (std::uint64_t seed = 0; seed < 12; ++seed)
        for (double roughness : {0.01, 0.1, 0.3}) expect_alpha_to_rise(tets_of(open_plate(seed, roughness)), {});
}

TEST(AlphaSolidCoverage, OfTwoShapesThatTouch_RaisesAlpha) {
    for (u32 size : {1u, 2u, 3u, 4u}) {
        const double edge = size;
        // In a corner, along an edge, in part of a face.
        for (const Vec3& shift : {Vec3(edge, edge, edge), Vec3(edge, edge, 0), Vec3(edge, edge - 1, edge - 1)})
            expect_alpha_to_rise(tets_of(joined(lattice_cube(size), moved(lattice_cube(4), 1, shift))), {});
    }
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const PointCloud plate = open_plate(seed, 0.05);
        expect_alpha_to_rise(tets_of(joined(plate, moved(rotated(open_plate(seed + 50, 0.05), 1), 1, Vec3(11, 11, 0)))),
                             {});
        const PointCloud ball = fibonacci_sphere(60, 0.02, seed);
        for (double apart : {1.9, 2.0, 2.1, 2.4})
            expect_alpha_to_rise(tets_of(joined(ball, moved(ball, 0.7, Vec3(0.85 * apart, 0.1, 0)))), {});
    }
}

TEST(AlphaSolidCoverage, OfAGivenAlphaThatHoldsTheShare_IsNotReportedAsADefect) {
    // Two cubes that share one corner, and a third apart: 1 of 3 x 729 points may be left out, or all of the third.
    const PointCloud cubes = joined(cubes_sharing_a_corner(), moved(lattice_cube(3), 1, Vec3(40, 0, 0)));
    const TetMesh tets = tets_of(cubes);
    const std::size_t points = tets.positions.size();
    ASSERT_EQ(points, 2 * 729u - 1 + 64u);
    // With `many` the share is met, but the corner is pinched.
    const auto pinched = warnings_of(tets, given(0.71, 99, AlphaComponents::many));
    ASSERT_EQ(pinched.size(), 1u);
    EXPECT_THAT(pinched[0], AllOf(HasSubstr("not valid: its boundary has 1 non-manifold vertex"),
                                  Not(HasSubstr("are outside of it"))));
    // The one of the two cubes that is kept has 729 points: enough for 47 %, not for 48 %.
    const auto half = warnings_of(tets, given(0.71, 47));
    EXPECT_THAT(half, ElementsAre(AllOf(HasSubstr("792 of 1521 points are not in or on the solid; "),
                                        HasSubstr("cells of other solids were left out")),
                                  HasSubstr("points lie inside the solid")));
    const auto too_few = warnings_of(tets, given(0.71, 48));
    ASSERT_EQ(too_few.size(), 2u);
    EXPECT_THAT(too_few[0],
                HasSubstr("not valid: 792 of 1521 points are outside of it, more than the 790 that coverage "
                          "48 % allows; the nearest alpha that gives a valid one is "));
    EXPECT_THAT(too_few[1], HasSubstr("cells of other solids were left out"));
}

TEST(AlphaSolidCoverage, OfAGivenAlpha_ReportsPointsOutsideBesideAnotherDefect) {
    // The pinched cubes and five points far away.
    Array<Vec3> far;
    for (int i = 0; i < 5; ++i) far.push_back(Vec3(100 + 10 * i, 7 * i * i, -5 * i));
    PointCloud outliers;
    outliers.positions = std::move(far);
    const TetMesh tets = tets_of(joined(cubes_sharing_a_corner(), outliers));
    EXPECT_THAT(warnings_of(tets, given(0.71, 99, AlphaComponents::many)),
                ElementsAre(AllOf(HasSubstr("not valid: its boundary has 1 non-manifold vertex"),
                                  Not(HasSubstr("outside of it"))),
                            HasSubstr("5 of 1462 points are not in or on the solid")));
    EXPECT_THAT(warnings_of(tets, given(0.71, 100, AlphaComponents::many)),
                ElementsAre(HasSubstr("not valid: 5 of 1462 points are outside of it and its boundary has 1")));
}

TEST(AlphaSolidSeparate, SolidsThatAlphaJoined_AreReportedWithTheParameterThatKeepsThemSeparate) {
    const TetMesh tets = tets_of(two_spheres());
    const AlphaSolidResult apart = solid_of(tets, many()), one = solid_of(tets);
    ASSERT_TRUE(one.separate);
    EXPECT_EQ(one.separate->count, 2u);
    EXPECT_EQ(one.separate->alpha, apart.alpha);
    EXPECT_THAT(warnings_of(tets, {}), testing::Contains(AllOf(HasSubstr("joins 2 solids that are separate at "),
                                                               HasSubstr("'components: many' keeps them separate"))));
    EXPECT_FALSE(apart.separate);
    EXPECT_THAT(warnings_of(tets, many()), IsEmpty());
    EXPECT_FALSE(solid_of(tets, covering(66)).separate) << "there the smaller one is left out, with a warning";
    // Alpha grows here too, but there is only one solid.
    EXPECT_FALSE(solid_of(cubes_sharing_a_corner()).separate);
    EXPECT_FALSE(solid_of(fibonacci_sphere(200)).separate);
}

}  // namespace
}  // namespace scanmill
