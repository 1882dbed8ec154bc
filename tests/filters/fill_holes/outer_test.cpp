// SPDX-License-Identifier: GPL-3.0-or-later
/// Outer boundaries, which stay open.

#include <gmock/gmock.h>

#include "filters/fill_holes/cases.hpp"

namespace scanmill::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using Outer = FillHolesParams::Outer;

FillHolesParams with(Outer outer) {
    FillHolesParams params;
    params.outer = outer;
    return params;
}

/// A sphere without its cap above this height: the loop's share is (1 - h²) / 2 (1 + h).
TriangleMesh cup(double height) { return below(geodesic_sphere(1, 24), height); }

TEST(FillHolesOuter, AHemisphere_StaysOpenByDefault_WithAWarning) {
    const Filled result = filled(cup(0));
    EXPECT_EQ(result.outer, 1u);
    EXPECT_EQ(result.filled, 0u);
    EXPECT_THAT(result.doubts, IsEmpty());
    EXPECT_THAT(result.warnings, Contains(HasSubstr("the surface stays open at 1 outer boundary: closed flat, it would "
                                                    "add 5")));
    EXPECT_EQ(result.metrics.find("outer")->value, 1);
    EXPECT_EQ(result.metrics.find("left")->value, 1);
    EXPECT_EQ(filled(cup(0), with(Outer::fill)).filled, 1u);
}

TEST(FillHolesOuter, TheLimitIsTwoFifths) {
    // (1 - h) / 2 is 0.42 and 0.38; the rim of the geodesic sphere is a little below h.
    EXPECT_EQ(filled(cup(0.16 + 0.06)).outer, 1u);
    EXPECT_EQ(filled(cup(0.24 + 0.06)).outer, 0u);
}

TEST(FillHolesOuter, AStandingFiguresBase_IsClosedByDefault_WithADoubtThatNamesTheWayOut) {
    const Filled result = filled(cup(0.6));  // a share of 0.2, as a cube without its base
    EXPECT_EQ(result.filled, 1u);
    EXPECT_EQ(result.outer, 0u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("`outer: keep`")));
    const Filled kept = filled(cup(0.6), with(Outer::keep));
    EXPECT_EQ(kept.outer, 1u);
    EXPECT_THAT(kept.doubts, IsEmpty());
    EXPECT_THAT(kept.warnings, IsEmpty()) << "it was asked for";
}

TEST(FillHolesOuter, SmallHolesInAnOpenSurface_AreFilled) {
    const TriangleMesh mesh = without_triangles(cup(0), {3, 400, 900});
    for (const Outer outer : {Outer::automatic, Outer::keep}) {
        const Filled result = filled(mesh, with(outer));
        EXPECT_EQ(result.outer, 1u);
        EXPECT_EQ(result.filled, 3u);
        EXPECT_EQ(topology(result.mesh).boundary_loops, 1u);
    }
}

/// A wavy sheet of 20 x 20 cells without those that `leaves_out` is true for.
template <class LeavesOut>
TriangleMesh sheet(LeavesOut&& leaves_out) {
    TriangleMesh mesh;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 y = 0; y <= 20; ++y)
        for (u32 x = 0; x <= 20; ++x) positions.emplace_back(x, y, 0.1 * ((x * y) % 3));
    for (u32 y = 0; y < 20; ++y)
        for (u32 x = 0; x < 20; ++x) {
            if (leaves_out(x, y)) continue;
            const u32 a = 21 * y + x;
            triangles.push_back({a, a + 1, a + 22});
            triangles.push_back({a, a + 22, a + 21});
        }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return without_unused_vertices(mesh);
}

TEST(FillHolesOuter, LargeHolesInAnOpenSurface_StayOpenToo) {
    const TriangleMesh mesh =  // the window has 4 % of the sheet
        sheet([](u32 x, u32 y) { return x >= 8 && x < 12 && y >= 8 && y < 12; });
    EXPECT_EQ(filled(mesh).outer, 2u);
    EXPECT_EQ(filled(mesh, with(Outer::fill)).outer, 0u);
}

TEST(FillHolesOuter, SeparateSheets_NeedToBeKept) {
    // Three strips, each with a third of the area; a box whose sides and lid are separate looks the same.
    const TriangleMesh strips = sheet([](u32 x, u32) { return x == 6 || x == 13; });
    const Filled kept = filled(strips, with(Outer::keep));
    EXPECT_EQ(kept.outer, 3u);
    EXPECT_EQ(kept.filled, 0u);
    EXPECT_NEAR(kept.metrics.find("largest-share")->value, 1.0 / 3, 0.01);
    EXPECT_EQ(filled(strips).outer, 0u);
}

TEST(FillHolesOuter, RequiredClosing_FillsThemAll) {
    FillHolesParams params;
    params.must_close = true;
    const Filled result = filled(cup(0), params);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(result.filled, 1u);
}

}  // namespace
}  // namespace scanmill::test
