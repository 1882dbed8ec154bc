// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "filters/region_grow_cases.hpp"
#include "filters/region_grow_patch.hpp"
#include "region_grow/filling.hpp"
#include "region_grow/point_normals.hpp"

namespace scanmill::growing {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const std::vector<Vec3> places{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0), Vec3(1, 1, -1), Vec3(1, 1, 1),
                               Vec3(5, 5, 0), Vec3(1, 1, 0), Vec3(9, 9, 5), Vec3(9, 8, 5),  Vec3(8, 9, 5)};

TEST(RegionGrowMeet_Triangles, MeetBeyondTheirCommonCornersAndEdges) {
    const auto met = [](const Triangle& one, const Triangle& other) {
        EXPECT_EQ(meet(places, one, other), meet(places, other, one));
        return meet(places, one, other);
    };
    const Triangle floor{0, 1, 2};
    EXPECT_TRUE(met(floor, {3, 4, 5})) << "stabs it";
    EXPECT_FALSE(met(floor, {7, 8, 9})) << "far away";
    EXPECT_TRUE(met(floor, {6, 7, 8})) << "a corner of the other lies in it";
    EXPECT_FALSE(met(floor, {0, 7, 8})) << "one common corner";
    EXPECT_TRUE(met(floor, {0, 3, 4})) << "one common corner, and the edge opposite stabs it";
    EXPECT_TRUE(met(floor, {0, 6, 7})) << "one common corner, and a corner in it";
    EXPECT_FALSE(met(floor, {2, 1, 5})) << "the next triangle in its plane";
    EXPECT_FALSE(met(floor, {2, 1, 4})) << "bent up at a common edge";
    EXPECT_TRUE(met(floor, {2, 1, 6})) << "folded flat onto it";
    EXPECT_TRUE(met(floor, {1, 2, 0})) << "itself";
}

/// As sorted corners; lengths as in the positions given.
std::vector<Triangle> filling(const Patch& patch, const std::vector<u32>& loop, double circle, double bend) {
    std::vector<u32> corners;
    for (u32 x : loop) corners.push_back(patch.place(x));
    NearTriangles near;
    std::vector<Triangle> triangles;
    for (Triangle t :
         cheapest_filling(patch.surface(), near, corners, {circle, std::cos(bend / 180 * std::numbers::pi)})) {
        for (u32& corner : t) corner = patch.name_of(corner);
        EXPECT_LT(std::ranges::find(loop, t[0]), std::ranges::find(loop, t[1])) << "in the loop's direction";
        std::ranges::sort(t);
        triangles.push_back(t);
    }
    return triangles;
}

constexpr double any = std::numeric_limits<double>::infinity();

/// A square of side 2 with one corner lifted by 1. Over the diagonal 0-2 two triangles of √5, over 1-3 one of 2 and
/// one of √6.
const std::vector<Vec3> lifted{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 1), Vec3(0, 2, 0)};

TEST(RegionGrowFilling_FourCorners, TakesTheDiagonalOfLessArea) {
    EXPECT_THAT(filling(Patch(lifted), {0, 1, 2, 3}, any, 150),
                UnorderedElementsAre(Triangle{0, 1, 3}, Triangle{1, 2, 3}));
}

TEST(RegionGrowFilling_Square, BreaksTheTieByTheFirstCorners) {
    const std::vector<Vec3> square{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 0), Vec3(0, 2, 0)};
    EXPECT_THAT(filling(Patch(square), {0, 1, 2, 3}, any, 150),
                UnorderedElementsAre(Triangle{0, 1, 3}, Triangle{1, 2, 3}));
    EXPECT_THAT(filling(Patch(square), {1, 2, 3, 0}, any, 150),
                UnorderedElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(RegionGrowFilling_Circles, LimitTheTrianglesNotTheirNumber) {
    const std::vector<Vec3> square{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 0), Vec3(0, 2, 0)};
    EXPECT_THAT(filling(Patch(square), {0, 1, 2, 3}, 1.415, 150), testing::SizeIs(2));
    EXPECT_THAT(filling(Patch(square), {0, 1, 2, 3}, 1.414, 150), IsEmpty());
    // A slit 1 wide and 40 long, and a round hole of radius 1.5: twelve corners each.
    std::vector<Vec3> slit, round;
    std::vector<u32> loop;
    for (u32 i = 0; i < 12; ++i) {
        slit.push_back(i < 6 ? Vec3(i * 8, 0, 0) : Vec3((11 - i) * 8, 1, 0));
        const double angle = 2 * std::numbers::pi * i / 12;
        round.push_back(1.5 * Vec3(std::cos(angle), std::sin(angle), 0));
        loop.push_back(i);
    }
    for (Vec3& p : slit) p.x() /= 8;
    EXPECT_THAT(filling(Patch(slit), loop, 0.75, 150), testing::SizeIs(10));
    EXPECT_THAT(filling(Patch(round), loop, 1.45, 150), IsEmpty());
    EXPECT_THAT(filling(Patch(round), loop, 1.51, 150), testing::SizeIs(10));
}

TEST(RegionGrowFilling_ATriangleInTheWay, IsPassedOrNothingIsFilled) {
    // One that stabs triangle 0 1 3 in (0.5, 0.5, 0) and neither 0 1 2 nor 0 2 3, and one that stabs them all.
    std::vector<Vec3> positions = lifted;
    for (const Vec3& p : {Vec3(0.5, 0.5, -3), Vec3(0.4, 0.6, -3), Vec3(0.5, 0.5, 0.1)}) positions.push_back(p);
    Patch under(positions);
    under.add(4, 5, 6);
    EXPECT_THAT(filling(under, {0, 1, 2, 3}, any, 150), UnorderedElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
    positions[6] = Vec3(0.5, 0.5, 3);
    Patch through(positions);
    through.add(4, 5, 6);
    EXPECT_THAT(filling(through, {0, 1, 2, 3}, any, 150), IsEmpty());
}

TEST(RegionGrowFilling_ATriangleInTheWay, IsSeenHoweverFarItsCornersAre) {
    // Through the whole lid, ten times as far as any search radius.
    std::vector<Vec3> positions = lifted;
    for (const Vec3& p : {Vec3(0.5, 0.5, -40), Vec3(0.4, 0.6, -40), Vec3(0.5, 0.5, 40)}) positions.push_back(p);
    Patch through(positions);
    EXPECT_THAT(filling(through, {0, 1, 2, 3}, any, 150), testing::SizeIs(2));
    through.add(4, 5, 6);
    EXPECT_THAT(filling(through, {0, 1, 2, 3}, any, 150), IsEmpty());
}

TEST(RegionGrowFilling_EdgesThatAreThere, AreNotRepeated) {
    std::vector<Vec3> positions = lifted;
    positions.push_back(Vec3(1, 1, -3));
    Patch patch(positions);
    patch.add(1, 3, 4);
    EXPECT_THAT(filling(patch, {0, 1, 2, 3}, any, 150), UnorderedElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(RegionGrowFilling_Bends, OfATentsRoofDecide) {
    // Beyond edge 0-1 the surface comes back over the hole, 15 degrees above it: a bend of 165 degrees.
    const double slope = std::tan(std::numbers::pi / 12);
    Patch patch({Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 1, 0), Vec3(1, 1.5, 1.5 * slope)});
    patch.add(1, 0, 3);
    EXPECT_THAT(filling(patch, {0, 1, 2}, any, 166), ElementsAre(Triangle{0, 1, 2}));
    EXPECT_THAT(filling(patch, {0, 1, 2}, any, 164), IsEmpty());
}

}  // namespace
}  // namespace scanmill::growing
