// SPDX-License-Identifier: GPL-3.0-or-later
/// Given normals: those that lie in the surface, those with mixed signs, and missing ones.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "filters/region_grow/cases.hpp"
#include "region_grow/given_normals.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

template <class NormalAt>
PointCloud with_normals(PointCloud cloud, NormalAt&& normal_at) {
    Array<double> numbers;
    for (const Vec3& p : cloud.positions) {
        const Vec3 normal = normal_at(p);
        numbers.insert(numbers.end(), normal.begin(), normal.end());
    }
    cloud.columns.add(Column("normal", 3, Buffer<double>(std::move(numbers))));
    return cloud;
}

std::vector<std::string> warnings_of(const PointCloud& cloud) {
    Context context;
    region_grow(cloud, {}, context);
    return sentences_of(context);
}

TEST(RegionGrow_NormalsInTheSurface, AreRefusedAsSuch) {
    const PointCloud flat = with_normals(grid(20, 20), [](const Vec3&) { return Vec3(1, 0, 0); });
    EXPECT_THAT(growth_refusal(flat), AllOf(HasSubstr("400 of 400 normals of the column 'normal' (100 %) are more than "
                                                      "60 deg from the normal of their neighbours"),
                                            HasSubstr("hint: "), HasSubstr("drop or rename it")));
    const PointCloud sphere =
        with_normals(fibonacci_sphere(2000), [](const Vec3& p) { return Vec3(-p.y(), p.x(), 0); });
    EXPECT_THAT(growth_refusal(sphere), HasSubstr("as if they lay in the surface"));
}

TEST(RegionGrow_NormalsInTheSurface, UpToSixtyDegreesAreAccepted) {
    for (const double degrees : {0.0, 45.0, 59.0, 61.0, 90.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        const PointCloud tilted =
            with_normals(grid(20, 20), [&](const Vec3&) { return Vec3(std::sin(angle), 0, std::cos(angle)); });
        EXPECT_EQ(growth_refusal(tilted).find("60 deg") != std::string::npos, degrees > 60) << degrees;
    }
}

TEST(RegionGrow_NormalsInTheSurface, MoreThanThreeQuartersAreRefusedAboveAQuarterWarns) {
    const auto lying_below = [](double x) {
        return with_normals(grid(20, 20), [x](const Vec3& p) { return p.x() < x ? Vec3(0, 1, 0) : Vec3(0, 0, 1); });
    };
    EXPECT_THAT(growth_refusal(lying_below(15.5)), HasSubstr("320 of 400 normals of the column 'normal' (80 %)"));
    Context context;
    try {
        region_grow(lying_below(9.5), {}, context);
    } catch (const Error&) {
    }
    ASSERT_FALSE(context.warnings().empty());
    EXPECT_THAT(context.warnings()[0],
                AllOf(HasSubstr("200 of 400 normals"), HasSubstr("computed from the neighbours")));
    EXPECT_THAT(warnings_of(lying_below(4.5)), testing::Not(testing::Contains(HasSubstr("60 deg"))));
}

TEST(RegionGrow_NormalsInTheSurface, OfDistantScanLinesAreAccepted) {
    // All neighbours lie on one line, so the principal normal is an arbitrary direction across it.
    for (int degrees = 0; degrees < 180; degrees += 10) {
        const double angle = degrees * std::numbers::pi / 180;
        const Vec3 along(0, std::cos(angle), std::sin(angle)), normal(0, -std::sin(angle), std::cos(angle));
        std::vector<Vec3> lines;
        for (const Vec3& p : grid(40, 3).positions) lines.push_back(Vec3(p.x(), 0, 0) + 60 * p.y() * along);
        const PointCloud cloud = with_normals(cloud_from(lines), [&](const Vec3&) { return normal; });
        EXPECT_EQ(growth_refusal(cloud).find("60 deg"), std::string::npos) << degrees;
    }
}

TEST(RegionGrow_NormalsInTheSurface, OfACoarseSphereAreAccepted) {
    EXPECT_THAT(warnings_of(with_normals(fibonacci_sphere(60), [](const Vec3& p) { return p; })), IsEmpty());
}

/// A sphere with its normals, of which this share is reversed.
PointCloud sphere_with_flips(u32 points, double share, double outwards = 1) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> chance(0, 1);
    return with_normals(fibonacci_sphere(points),
                        [&](const Vec3& p) -> Vec3 { return outwards * (chance(random) < share ? -p : p); });
}

double share_facing_outwards(const TriangleMesh& mesh) {
    const auto outwards = std::ranges::count_if(
        mesh.triangles, [&](const Triangle& t) { return normal_of(mesh, t).dot(mesh.positions[t[0]]) > 0; });
    return static_cast<double>(outwards) / static_cast<double>(mesh.triangles.size());
}

TEST(RegionGrow_NormalsOfMixedSign, KeepTheirDirectionsOnly) {
    for (const double share : {0.5, 0.2, 0.02}) {
        Context context;
        const RegionGrowResult result = region_grow(sphere_with_flips(3000, share), {}, context);
        EXPECT_EQ(result.mesh.triangles.size(), 2 * 3000 - 4) << share;
        EXPECT_EQ(result.unused_points, 0u) << share;
        EXPECT_THAT(context.warnings(),
                    testing::ElementsAre(AllOf(HasSubstr("of 3000 normals of the column 'normal' are opposed"),
                                               HasSubstr("their signs only decide"))));
    }
}

TEST(RegionGrow_NormalsOfMixedSign, DecideTheOrientationOfAComponent) {
    // The wall of a cavity faces inwards; only its normals show that.
    EXPECT_EQ(share_facing_outwards(grown(sphere_with_flips(3000, 0.1, -1)).mesh), 0);
    EXPECT_EQ(share_facing_outwards(grown(sphere_with_flips(3000, 0.1, 1)).mesh), 1);
    EXPECT_EQ(share_facing_outwards(grown(sphere_with_flips(3000, 0.5, -1)).mesh), 1) << "as without normals";
}

TEST(RegionGrow_NormalsOfMixedSign, AreNotThoseOfTheTwoSidesOfASheet) {
    // Nearly every nearest neighbour is on the other side: behind in a sheet, in front in a slit.
    for (const double outwards : {1.0, -1.0}) {
        PointCloud sides = grid(20, 20);
        std::vector<Vec3> both(sides.positions.begin(), sides.positions.end());
        for (const Vec3& p : sides.positions) both.push_back(p + Vec3(0.3, 0.2, 0.1));
        const PointCloud sheet =
            with_normals(cloud_from(both), [&](const Vec3& p) { return Vec3(0, 0, p.z() > 0 ? outwards : -outwards); });
        EXPECT_THAT(warnings_of(sheet), IsEmpty());
        EXPECT_EQ(grown(sheet).components, 2u);
    }
}

TEST(RegionGrow_NormalsOfMixedSign, AreNotThoseOfRidgesAndGrooves) {
    // Saw teeth of 50 degrees: along ridges the nearest neighbours lie behind, along grooves in front.
    std::vector<Vec3> points;
    std::vector<double> slopes;
    const double half = 25 * std::numbers::pi / 180;
    for (int flank = 0; flank < 8; ++flank)
        for (int step = 0; step < 12; ++step)
            for (int along = 0; along < 30; ++along) {
                const double down = step + 0.4, across = flank % 2 == 0 ? down : 12 - down;
                points.push_back(Vec3((12 * flank + (flank % 2 == 0 ? across : 12 - across)) * std::sin(half), along,
                                      -across * std::cos(half)));
                slopes.push_back(flank % 2 == 0 ? 1 : -1);
            }
    std::size_t row = 0;
    const PointCloud teeth = with_normals(
        cloud_from(points), [&](const Vec3&) { return Vec3(slopes[row++] * std::cos(half), 0, std::sin(half)); });
    EXPECT_THAT(warnings_of(teeth), testing::Not(testing::Contains(HasSubstr("are opposed"))));
}

TEST(RegionGrowOpposedNormals, AreMixedAboveOneInAHundredAndNotOnOneSide) {
    const auto mixed = [](std::size_t beside, std::size_t count, std::size_t behind, std::size_t in_front) {
        return growing::OpposedNormals{count, behind, in_front, beside}.are_mixed(1000);
    };
    EXPECT_TRUE(mixed(11, 11, 6, 5));
    EXPECT_FALSE(mixed(10, 11, 6, 5)) << "one in a hundred beside";
    EXPECT_TRUE(mixed(20, 20, 15, 5));
    EXPECT_FALSE(mixed(20, 20, 16, 4)) << "more than three quarters behind";
    EXPECT_FALSE(mixed(20, 20, 4, 16)) << "more than three quarters in front";
    EXPECT_TRUE(mixed(20, 20, 0, 0)) << "all in the plane";
}

TEST(RegionGrowOpposedNormals, LieBehindInFrontAndBeside) {
    growing::OpposedNormals opposed;
    opposed.add(Vec3(0, 0, 1), Vec3(1, 0, 0.005));
    EXPECT_EQ(opposed.behind + opposed.in_front, 0u);
    EXPECT_EQ(opposed.beside, 1u);
    opposed.add(Vec3(0, 0, 1), Vec3(1, 0, -0.2));
    EXPECT_EQ(opposed.behind, 1u);
    EXPECT_EQ(opposed.beside, 2u);
    opposed.add(Vec3(0, 0, 1), Vec3(1, 0, 0.5));
    EXPECT_EQ(opposed.in_front, 1u);
    EXPECT_EQ(opposed.beside, 2u);
    EXPECT_EQ(opposed.count, 3u);
}

TEST(RegionGrow_MissingNormals, TakeTheSignOfTheNearestGivenOnesHoweverFar) {
    // A quarter of the sphere has none, and most of these points have no neighbour with one.
    const PointCloud cap = with_normals(fibonacci_sphere(5000),
                                        [](const Vec3& p) -> Vec3 { return p.z() > 0.5 ? Vec3(0, 0, 0) : Vec3(-p); });
    Context context;
    const RegionGrowResult result = region_grow(cap, {}, context);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * 5000 - 4);
    EXPECT_EQ(share_facing_outwards(result.mesh), 0);
    EXPECT_THAT(context.warnings(), testing::ElementsAre(HasSubstr("1250 of 5000 normals are zero or not finite")));
}

TEST(RegionGrow_MissingNormals, MoreThanHalfLeaveSignsThatOnlyDecideTheOrientation) {
    std::size_t row = 0;
    const PointCloud few = with_normals(
        fibonacci_sphere(5000), [&](const Vec3& p) -> Vec3 { return row++ % 250 == 0 ? Vec3(-p) : Vec3(0, 0, 0); });
    Context context;
    const RegionGrowResult result = region_grow(few, {}, context);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * 5000 - 4);
    EXPECT_EQ(share_facing_outwards(result.mesh), 0);
    EXPECT_THAT(context.warnings(), testing::ElementsAre(AllOf(HasSubstr("4980 of 5000 normals are zero"),
                                                               HasSubstr("only decide which way"))));
}

TEST(RegionGrow_NormalsOrientedTowardsACamera, EndTheSurfaceWithAWarning) {
    const PointCloud seam = with_normals(fibonacci_sphere(20000),
                                         [](const Vec3& p) -> Vec3 { return p.dot(Vec3(1, 2, 3)) > 0 ? p : Vec3(-p); });
    EXPECT_GT(grown(seam).components, 1u);
    EXPECT_THAT(warnings_of(seam), testing::Contains(AllOf(HasSubstr("the surface ends at"), HasSubstr("camera"))));
}

}  // namespace
}  // namespace scanmill
