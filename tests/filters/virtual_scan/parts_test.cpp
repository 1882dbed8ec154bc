// SPDX-License-Identifier: GPL-3.0-or-later
/// The block with holes and the hyperboloid: every point satisfies the formula, and the number of points the visible
/// area.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "filters/virtual_scan/cases.hpp"
#include "scanmill/base/error.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

VirtualScanParams block_of(std::vector<Length> size, double resolution) {
    VirtualScanParams params;
    params.shape = Shape::holed_block;
    params.size = std::move(size);
    params.resolution = resolution;
    params.max_angle = Angle::degrees(90);
    params.views = {0, 0, 1};
    return params;
}

VirtualScanParams saddle_of(double radius, double height, double resolution) {
    VirtualScanParams params = block_of({radius, height}, resolution);
    params.shape = Shape::hyperboloid;
    return params;
}

std::string refusal(const VirtualScanParams& params) {
    try {
        scan(params);
    } catch (const Error& error) {
        return error.sentence();
    }
    return "not refused";
}

struct Hole {
    double x, y, radius;
};
/// As documented: the large one in the middle, four at 35 % of the sides.
std::vector<Hole> holes_of(double x, double y, double large, double small) {
    std::vector<Hole> holes{{0, 0, large}};
    for (const double to_x : {-0.35 * x, 0.35 * x})
        for (const double to_y : {-0.35 * y, 0.35 * y}) holes.push_back({to_x, to_y, small});
    return holes;
}

/// The area that two discs of one radius share.
double lens(double radius, double distance) {
    if (distance >= 2 * radius) return 0;
    return 2 * radius * radius * std::acos(distance / (2 * radius)) -
           distance / 2 * std::sqrt(4 * radius * radius - distance * distance);
}

TEST(VirtualScanBlock, FromAbove_ShowsItsTopWithoutTheHoles) {
    const VirtualScanResult result = scan(block_of({88.0, 95.0, 41.0, 21.0, 5.0}, 0.1));
    EXPECT_NEAR(static_cast<double>(result.points.size()) * 0.01, 88 * 95 - pi * (21 * 21 + 4 * 25), 1);
    for (const Vec3& p : result.points.positions) {
        ASSERT_EQ(p.z(), 20.5);
        for (const Hole& hole : holes_of(88, 95, 21, 5))
            ASSERT_GE(std::hypot(p.x() - hole.x, p.y() - hole.y), hole.radius - 1e-12);
    }
}

/// Rays with slope s enter a hole of height h. Those inside both its upper circle and its lower circle, shifted by s h,
/// pass through; the others end on its wall.
TEST(VirtualScanBlock, FromASlope_ShowsTheWallsOfItsHoles) {
    VirtualScanParams params = block_of({88.0, 95.0, 20.0, 21.0, 5.0}, 0.1);
    params.views = {0.25, 0, 1};
    const VirtualScanResult result = scan(params);
    std::size_t on_walls = 0;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const Vec3 normal = normal_of(result.points, i), &p = result.points.positions[i];
        ASSERT_GE(normal.dot(result.directions[0]), 0);
        if (normal.z() != 0 || std::abs(p.x()) == 44 || std::abs(p.y()) == 47.5) continue;
        ++on_walls;
        bool found = false;
        for (const Hole& hole : holes_of(88, 95, 21, 5)) {
            const Vec3 to_axis(hole.x - p.x(), hole.y - p.y(), 0);
            if (std::abs(to_axis.norm() - hole.radius) > 1e-12 * hole.radius) continue;
            found = true;
            ASSERT_LT((normal - to_axis / hole.radius).norm(), 1e-12);
        }
        ASSERT_TRUE(found) << p.transpose();
    }
    const double discs = pi * (21 * 21 + 4 * 25), through = lens(21, 5) + 4 * lens(5, 5);
    const double cosine = 1 / std::sqrt(1 + 0.25 * 0.25);
    EXPECT_NEAR(static_cast<double>(on_walls) * 0.01, (discs - through) * cosine, 0.005 * discs);
}

TEST(VirtualScanBlock, FromTheSide_IsABox) {
    VirtualScanParams params = block_of({8.0, 9.0, 4.0, 2.0, 0.5}, 0.05);
    params.views = {1, 0, 0};
    const VirtualScanResult result = scan(params);
    EXPECT_EQ(result.points.size(), 180u * 80u);
    for (const Vec3& p : result.points.positions) ASSERT_EQ(p.x(), 4);
}

TEST(VirtualScanBlock, WithoutSizes_HasThoseDocumented) {
    VirtualScanParams params = block_of({}, 0.002);
    // A row or column of rays may lie on the border or not.
    const double area = 0.88 * 0.95 - pi * (0.21 * 0.21 + 4 * 0.05 * 0.05);
    EXPECT_NEAR(static_cast<double>(scan(params).points.size()) * 4e-6, area, 0.002 * (0.88 + 0.95));
}

TEST(VirtualScanBlock, HolesThatMeet_AreRefused) {
    EXPECT_THAT(refusal(block_of({10.0, 20.0, 5.0, 5.0, 1.0}, 0.1)),
                HasSubstr("the large hole of radius 5 u does not fit into the block of 10 x 20 u"));
    // To the sides 0.15 · 10 = 1.5; to the large hole 0.35 √(10² + 10²) − 4 = 0.9497.
    EXPECT_THAT(refusal(block_of({10.0, 10.0, 5.0, 1.0, 1.6}, 0.1)),
                HasSubstr("the small holes of radius 1.6 u touch"));
    EXPECT_THAT(refusal(block_of({10.0, 10.0, 5.0, 4.0, 0.95}, 0.1)), HasSubstr("the small holes of radius 0.95 u"));
    EXPECT_EQ(refusal(block_of({10.0, 10.0, 5.0, 4.0, 0.949}, 0.1)), "not refused");
    EXPECT_THAT(refusal(block_of({1.0}, 0.1)), HasSubstr("has 5 dimensions (x, y, z, large hole's radius, small"));
}

/// For any view: the points satisfy z = h / r √(x² − y² + r²) over the disc, with the normal of that surface.
TEST(VirtualScanHyperboloid, EveryPointLiesOnItWithItsNormal) {
    VirtualScanParams params = saddle_of(2, 1.5, 0.05);
    params.views = {20};
    const VirtualScanResult result = scan(params);
    ASSERT_GT(result.points.size(), 20000u);
    const auto views = result.points.columns.find("view")->values<std::int32_t>();
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const Vec3& p = result.points.positions[i];
        ASSERT_LE(std::hypot(p.x(), p.y()), 2 + 1e-12);
        ASSERT_GE(p.z(), 0);
        ASSERT_NEAR(p.z() * p.z(), 0.5625 * (p.x() * p.x() - p.y() * p.y() + 4), 1e-12);
        const Vec3 gradient = Vec3(-0.5625 * p.x(), 0.5625 * p.y(), p.z()).normalized(),
                   normal = normal_of(result.points, i);
        ASSERT_NEAR(std::abs(normal.dot(gradient)), 1, 1e-12);
        ASSERT_GE(normal.dot(result.directions[static_cast<std::size_t>(views[i])]), -1e-12);
    }
}

TEST(VirtualScanHyperboloid, FromAboveAndBelow_ShowsItsDisc) {
    for (const double side : {1.0, -1.0}) {
        VirtualScanParams params = saddle_of(2, 1.5, 0.01);
        params.views = {0, 0, side};
        EXPECT_NEAR(static_cast<double>(scan(params).points.size()) * 1e-4, 4 * pi, 0.002 * 4 * pi);
    }
}

/// Seen along x, at each y the surface reaches from h / r √(r² − y²) in the middle to √2 times that at the border.
TEST(VirtualScanHyperboloid, FromTheSide_HidesItsFarHalf) {
    VirtualScanParams params = saddle_of(2, 1.5, 0.01);
    params.views = {1, 0, 0};
    const VirtualScanResult result = scan(params);
    EXPECT_NEAR(static_cast<double>(result.points.size()) * 1e-4, 0.75 * (std::sqrt(2) - 1) * pi * 2, 0.01);
    for (const Vec3& p : result.points.positions) ASSERT_GE(p.x(), 0);
}

}  // namespace
}  // namespace scanmill::test
