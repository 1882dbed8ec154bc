// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/doubtful_surface.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "support/shapes.hpp"

namespace scanmill {
namespace {

/// `cells` unit squares in a row, two triangles each, and a rectangle of the given length behind them.
TriangleMesh strip(u32 cells, double length) {
    TriangleMesh mesh;
    std::vector<Vec3> positions;
    for (u32 x = 0; x <= cells + 1; ++x)
        for (const double y : {0.0, 1.0}) positions.push_back(Vec3(x <= cells ? x : cells + length, y, 0));
    mesh.positions = Array<Vec3>(positions.begin(), positions.end());
    Array<Triangle> triangles;
    for (u32 x = 0; x <= cells; ++x) {
        triangles.push_back({2 * x, 2 * x + 2, 2 * x + 1});
        triangles.push_back({2 * x + 2, 2 * x + 3, 2 * x + 1});
    }
    mesh.triangles = std::move(triangles);
    return mesh;
}

TEST(SpannedShare, CountsTheAreaOfTrianglesLongerThanSoManyMedianEdges) {
    // Most of the 3 x 82 edges, counted with repeats, are 1 long.
    EXPECT_DOUBLE_EQ(spanned_share(strip(40, 10), 7), 10.0 / 50);
    EXPECT_DOUBLE_EQ(spanned_share(strip(40, 6.9), 7), 0) << "its diagonal is 6.97";
    EXPECT_DOUBLE_EQ(spanned_share(strip(40, 7), 7), 7.0 / 47) << "its diagonal is 7.07";
    EXPECT_DOUBLE_EQ(spanned_share(strip(40, 4), 4), 4.0 / 44) << "its diagonal is 4.12";
}

TEST(SpannedShare, NothingOrFlatTriangles_HaveNone) {
    EXPECT_EQ(spanned_share({}, 7), 0);
    TriangleMesh flat;
    flat.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
    flat.triangles = {Triangle{0, 1, 2}};
    EXPECT_EQ(spanned_share(flat, 7), 0);
}

TEST(RoughShare, CountsEdgesAboveSixtyDegrees) {
    EXPECT_EQ(rough_share(strip(10, 1)), 0);
    TriangleMesh folded = strip(2, 1);  // three squares, the last one folded up by 90 degrees
    Array<Vec3> positions(folded.positions.begin(), folded.positions.end());
    for (std::size_t i = positions.size() - 2; i < positions.size(); ++i) positions[i] = Vec3(2, positions[i].y(), 1);
    folded.positions = std::move(positions);
    // Three squares: three diagonals and two shared edges, one of them folded.
    EXPECT_DOUBLE_EQ(rough_share(folded), 1.0 / 5);
    EXPECT_EQ(rough_share({}), 0);
}

TEST(DoubtsAboutSurface, GapsBeginAboveATenthOfTheArea) {
    EXPECT_THAT(doubts_about_surface(strip(91, 10)), testing::IsEmpty());
    EXPECT_THAT(doubts_about_surface(strip(89, 10)),
                testing::ElementsAre(testing::StartsWith(
                    "10 % of the surface's area is in triangles with an edge longer than 7 median")));
}

TEST(DoubtsAboutSurface, AHandleBesideAGapIsDoubtful_AndOnlyThere) {
    EXPECT_THAT(doubts_about_surface(test::torus(1, 0.4, 60, 30)), testing::IsEmpty());
    // One of 40 sections is five times as long as the others.
    const auto with_gap = [](TriangleMesh mesh) {
        Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
        for (Vec3& p : positions) {
            const double turn = std::atan2(p.y(), p.x()), radius = std::hypot(p.x(), p.y());
            const double squeezed = turn * 40 / 44;
            p.x() = radius * std::cos(squeezed), p.y() = radius * std::sin(squeezed);
        }
        mesh.positions = std::move(positions);
        return mesh;
    };
    const TriangleMesh ring = with_gap(test::torus(10, 1, 40, 6));
    ASSERT_GT(spanned_share(ring, 4), 0.001);
    ASSERT_LT(spanned_share(ring, 7), 0.1);
    EXPECT_THAT(doubts_about_surface(ring), testing::ElementsAre(testing::StartsWith("the surface has genus 1 and")));
    EXPECT_THAT(doubts_about_surface(with_gap(test::geodesic_sphere(1, 8))), testing::IsEmpty());
}

TEST(DoubtsAboutSurface, NoiseBeginsAtFiveDegrees) {
    // sin 45 degrees times the edge, 1, times 5 degrees
    const double limit = std::sqrt(0.5) * 5 * std::numbers::pi / 180;
    EXPECT_THAT(doubts_about_surface(strip(40, 1), 0.99 * limit), testing::IsEmpty());
    EXPECT_THAT(doubts_about_surface(strip(40, 1), 1.01 * limit),
                testing::ElementsAre(testing::HasSubstr("turns triangles with edges of 1 u by 5 degrees")));
}

TEST(DoubtsAboutSurface, PleatsAreRough_OnManyEdgesOnly) {
    const auto pleated = [](u32 cells) {
        TriangleMesh mesh = strip(cells, 1);
        Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
        for (Vec3& p : positions) p.z() = static_cast<int>(p.x()) % 2;  // 90 degrees between squares
        mesh.positions = std::move(positions);
        return mesh;
    };
    EXPECT_THAT(doubts_about_surface(pleated(5000)), testing::ElementsAre(testing::HasSubstr("crumple")));
    EXPECT_THAT(doubts_about_surface(pleated(1000)), testing::IsEmpty());
}

}  // namespace
}  // namespace scanmill
