// SPDX-License-Identifier: GPL-3.0-or-later
/// Normals of fans, and sectors that are free or taken.
#include <gtest/gtest.h>

#include "geometry/growing/patch.hpp"
#include "scanmill/geometry/growing/overlaps.hpp"

namespace scanmill::growing {
namespace {

TEST(FanNormal, IsTheDirectionOfTheSummedUnitNormals) {
    // One triangle in the plane z = 0, and a four times larger one in the plane x = 0.
    Patch patch({Vec3(0, 0, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 2, 0), Vec3(0, 0, 2)});
    const u32 vertex = patch.point(0);
    EXPECT_EQ(fan_normal(patch.surface(), vertex, Vec3::UnitY()), Vec3::UnitY()) << "no triangle";
    patch.add(0, 1, 2);
    patch.add(0, 3, 4);
    EXPECT_LT((fan_normal(patch.surface(), vertex, Vec3::Zero()) - Vec3(1, 0, 1).normalized()).norm(), 1e-15);
    EXPECT_LT((fan_normal(patch.surface(), vertex, Vec3(0, 1, 0)) - Vec3(1, 1, 1).normalized()).norm(), 1e-15);
}

TEST(SectorsAreFree, BesideATriangleButNotOverIt) {
    Patch patch({Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 2, 0), Vec3(1, -2, 0), Vec3(1, 1, 0)});
    patch.add(0, 1, 2);
    for (Vec3& normal : patch.surface().normals) normal = Vec3::UnitZ();
    const auto are_free = [&](u32 a, u32 b, u32 c, bool along_fans) {
        return sectors_are_free(patch.surface(), {patch.point(a), patch.point(b), patch.point(c)}, Vec3::UnitZ(),
                                along_fans);
    };
    for (const bool along_fans : {false, true}) {
        EXPECT_TRUE(are_free(0, 3, 1, along_fans));
        EXPECT_FALSE(are_free(1, 0, 4, along_fans)) << "faces the other way";
        EXPECT_FALSE(are_free(0, 1, 4, along_fans)) << "over the triangle";
    }
}

TEST(SectorsAreFree, AlongFansWhereThePointsNormalDoesNotFit) {
    Patch patch({Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 2, 0), Vec3(1, -2, 0)});
    patch.add(0, 1, 2);
    patch.surface().normals[patch.point(0)] = Vec3(-1, 0, -0.1).normalized();
    patch.surface().normals[patch.point(1)] = Vec3::UnitZ();
    const Triangle below{patch.point(0), patch.point(3), patch.point(1)};
    EXPECT_FALSE(sectors_are_free(patch.surface(), below, Vec3::UnitZ(), false));
    EXPECT_TRUE(sectors_are_free(patch.surface(), below, Vec3::UnitZ(), true));
}

}  // namespace
}  // namespace scanmill::growing
