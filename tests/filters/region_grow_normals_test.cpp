// SPDX-License-Identifier: GPL-3.0-or-later
/// region-grow and normals that came with the points but lie in the surface.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "filters/region_grow_given.hpp"
#include "support/point_sets.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(RegionGrow_NormalsInTheSurface, AreRefusedAsSuch) {
    const PointCloud flat = with_normals(grid(20, 20), [](const Vec3&) { return Vec3(1, 0, 0); });
    EXPECT_THAT(growth_refusal(flat), AllOf(HasSubstr("400 of 400 normals of the column 'normal' (100 %) are more than "
                                                      "60 deg from the normal of their neighbours"),
                                            HasSubstr("hint: "), HasSubstr("drop or rename it")));
    const PointCloud sphere =
        with_normals(fibonacci_sphere(2000), [](const Vec3& p) { return Vec3(-p.y(), p.x(), 0); });
    EXPECT_THAT(growth_refusal(sphere), HasSubstr("as if they lay in the surface"));
}

TEST(RegionGrow_NormalsInTheSurface, UpToSixtyDegreesAreNone) {
    for (const double degrees : {0.0, 45.0, 59.0, 61.0, 90.0}) {
        const double angle = degrees * std::numbers::pi / 180;
        const PointCloud tilted =
            with_normals(grid(20, 20), [&](const Vec3&) { return Vec3(std::sin(angle), 0, std::cos(angle)); });
        EXPECT_EQ(growth_refusal(tilted).find("60 deg") != std::string::npos, degrees > 60) << degrees;
    }
}

TEST(RegionGrow_NormalsInTheSurface, ThreeQuartersAreRefusedAQuarterIsWarnedOf) {
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
    EXPECT_THAT(context.warnings()[0], AllOf(HasSubstr("200 of 400 normals"), HasSubstr("taken from the neighbours")));
    EXPECT_THAT(warnings_of(lying_below(4.5)), testing::Not(testing::Contains(HasSubstr("60 deg"))));
}

TEST(RegionGrow_NormalsInTheSurface, OfScanLinesFarApartTheirOwnAreNone) {
    // Turned about the lines, along which alone neighbours lie: their principal normal may be any direction across.
    for (int degrees = 0; degrees < 180; degrees += 10) {
        const double angle = degrees * std::numbers::pi / 180;
        const Vec3 along(0, std::cos(angle), std::sin(angle)), normal(0, -std::sin(angle), std::cos(angle));
        std::vector<Vec3> lines;
        for (const Vec3& p : grid(40, 3).positions) lines.push_back(Vec3(p.x(), 0, 0) + 60 * p.y() * along);
        const PointCloud cloud = with_normals(cloud_from(lines), [&](const Vec3&) { return normal; });
        EXPECT_EQ(growth_refusal(cloud).find("60 deg"), std::string::npos) << degrees;
    }
}

TEST(RegionGrow_NormalsInTheSurface, TrueOnesOfACoarseSphereAreNone) {
    EXPECT_THAT(warnings_of(with_normals(fibonacci_sphere(60), [](const Vec3& p) { return p; })), IsEmpty());
}

}  // namespace
}  // namespace scanmill
