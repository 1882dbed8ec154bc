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

TEST(FillHolesOuter, OfAnOpenSurface_SmallHolesAreFilled) {
    const TriangleMesh mesh = without_triangles(cup(0), {3, 400, 900});
    for (const Outer outer : {Outer::automatic, Outer::keep}) {
        const Filled result = filled(mesh, with(outer));
        EXPECT_EQ(result.outer, 1u);
        EXPECT_EQ(result.filled, 3u);
        EXPECT_EQ(topology(result.mesh).boundary_loops, 1u);
    }
}

TEST(FillHolesOuter, OfAnOpenSurface_LargeHolesStayOpenToo) {
    // A sheet of 20 x 20 cells with a window of 4 x 4: 4 % of the sheet.
    TriangleMesh sheet;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 y = 0; y <= 20; ++y)
        for (u32 x = 0; x <= 20; ++x) positions.emplace_back(x, y, 0.1 * ((x * y) % 3));
    for (u32 y = 0; y < 20; ++y)
        for (u32 x = 0; x < 20; ++x) {
            if (x >= 8 && x < 12 && y >= 8 && y < 12) continue;
            const u32 a = 21 * y + x;
            triangles.push_back({a, a + 1, a + 22});
            triangles.push_back({a, a + 22, a + 21});
        }
    sheet.positions = std::move(positions);
    sheet.triangles = std::move(triangles);
    const TriangleMesh mesh = without_unused_vertices(sheet);
    EXPECT_EQ(filled(mesh).outer, 2u);
    EXPECT_EQ(filled(mesh, with(Outer::fill)).outer, 0u);
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
