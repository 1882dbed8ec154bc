// SPDX-License-Identifier: GPL-3.0-or-later
/// Hole triangulations, and which loops are closed: one on either side of every limit.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "geometry/growing/patch.hpp"
#include "scanmill/geometry/growing/holes.hpp"
#include "support/numbers.hpp"

namespace scanmill {
namespace {

using namespace growing;
using test::degree;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

/// The triangulation of a hole, as sorted corners. `angle`: largest dihedral deviation in degrees.
std::vector<Triangle> triangles_of(const Patch& patch, const std::vector<u32>& loop, double radius, double angle,
                                   double longest_edge = any_length) {
    std::vector<u32> corners;
    for (u32 x : loop) corners.push_back(patch.point(x));
    NearTriangles near;
    std::vector<Triangle> triangles;
    const TriangulationLimits limits{radius, std::cos(angle / 180 * std::numbers::pi), longest_edge};
    for (Triangle t : triangulate_hole(patch.surface(), near, corners, limits)) {
        for (u32& corner : t) corner = patch.name_of(corner);
        EXPECT_LT(std::ranges::find(loop, t[0]), std::ranges::find(loop, t[1])) << "in the loop's direction";
        std::ranges::sort(t);
        triangles.push_back(t);
    }
    return triangles;
}

constexpr double any_radius = std::numeric_limits<double>::infinity();

/// A square of side 2 with one corner lifted by 1. Over the diagonal 0-2 two triangles of √5, over 1-3 one of 2 and
/// one of √6.
const std::vector<Vec3> lifted{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 1), Vec3(0, 2, 0)};

TEST(HoleTriangulation_FourCorners, TakesTheDiagonalOfLessArea) {
    EXPECT_THAT(triangles_of(Patch(lifted), {0, 1, 2, 3}, any_radius, 150),
                UnorderedElementsAre(Triangle{0, 1, 3}, Triangle{1, 2, 3}));
}

TEST(HoleTriangulation_Square, BreaksTheTieByTheFirstCorners) {
    const std::vector<Vec3> square{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 0), Vec3(0, 2, 0)};
    EXPECT_THAT(triangles_of(Patch(square), {0, 1, 2, 3}, any_radius, 150),
                UnorderedElementsAre(Triangle{0, 1, 3}, Triangle{1, 2, 3}));
    EXPECT_THAT(triangles_of(Patch(square), {1, 2, 3, 0}, any_radius, 150),
                UnorderedElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(HoleTriangulation_LargestRadius, LimitsTheTrianglesNotTheirNumber) {
    const std::vector<Vec3> square{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 0), Vec3(0, 2, 0)};
    EXPECT_THAT(triangles_of(Patch(square), {0, 1, 2, 3}, 1.415, 150), testing::SizeIs(2));
    EXPECT_THAT(triangles_of(Patch(square), {0, 1, 2, 3}, 1.414, 150), IsEmpty());
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
    EXPECT_THAT(triangles_of(Patch(slit), loop, 0.75, 150), testing::SizeIs(10));
    EXPECT_THAT(triangles_of(Patch(round), loop, 1.45, 150), IsEmpty());
    EXPECT_THAT(triangles_of(Patch(round), loop, 1.51, 150), testing::SizeIs(10));
}

TEST(HoleTriangulation_NewEdges, AreShorterThanTheLongestEdge) {
    // A rhombus with diagonals of 4 and 2 and sides of √5. Both diagonals give the same area.
    const Patch rhombus({Vec3(0, -1, 0), Vec3(2, 0, 0), Vec3(0, 1, 0), Vec3(-2, 0, 0)});
    const auto found = [&](double longest_edge) {
        return triangles_of(rhombus, {0, 1, 2, 3}, any_radius, 150, longest_edge);
    };
    EXPECT_THAT(found(4.001), UnorderedElementsAre(Triangle{0, 1, 3}, Triangle{1, 2, 3}));
    EXPECT_THAT(found(4), UnorderedElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
    EXPECT_THAT(found(2.001), UnorderedElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3})) << "the sides are longer";
    EXPECT_THAT(found(2), IsEmpty());
}

TEST(HoleTriangulation_AnObstacle, IsAvoidedOrNothingIsFound) {
    // One that intersects triangle 0 1 3 in (0.5, 0.5, 0) but neither 0 1 2 nor 0 2 3, and one that intersects all.
    std::vector<Vec3> positions = lifted;
    for (const Vec3& p : {Vec3(0.5, 0.5, -3), Vec3(0.4, 0.6, -3), Vec3(0.5, 0.5, 0.1)}) positions.push_back(p);
    Patch under(positions);
    under.add(4, 5, 6);
    EXPECT_THAT(triangles_of(under, {0, 1, 2, 3}, any_radius, 150),
                UnorderedElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
    positions[6] = Vec3(0.5, 0.5, 3);
    Patch through(positions);
    through.add(4, 5, 6);
    EXPECT_THAT(triangles_of(through, {0, 1, 2, 3}, any_radius, 150), IsEmpty());
}

TEST(HoleTriangulation_AnObstacle, IsFoundHoweverFarItsCornersAre) {
    // Through the whole lid, with corners ten search radii away.
    std::vector<Vec3> positions = lifted;
    for (const Vec3& p : {Vec3(0.5, 0.5, -40), Vec3(0.4, 0.6, -40), Vec3(0.5, 0.5, 40)}) positions.push_back(p);
    Patch through(positions);
    EXPECT_THAT(triangles_of(through, {0, 1, 2, 3}, any_radius, 150), testing::SizeIs(2));
    through.add(4, 5, 6);
    EXPECT_THAT(triangles_of(through, {0, 1, 2, 3}, any_radius, 150), IsEmpty());
}

TEST(HoleTriangulation_ExistingEdges, AreNotRepeated) {
    std::vector<Vec3> positions = lifted;
    positions.push_back(Vec3(1, 1, -3));
    Patch patch(positions);
    patch.add(1, 3, 4);
    EXPECT_THAT(triangles_of(patch, {0, 1, 2, 3}, any_radius, 150),
                UnorderedElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(HoleTriangulation_DihedralDeviation, IsLimited) {
    // Beyond edge 0-1 the surface folds back over the hole, 15 degrees above it: a deviation of 165 degrees.
    const double slope = std::tan(std::numbers::pi / 12);
    Patch patch({Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 1, 0), Vec3(1, 1.5, 1.5 * slope)});
    patch.add(1, 0, 3);
    EXPECT_THAT(triangles_of(patch, {0, 1, 2}, any_radius, 166), ElementsAre(Triangle{0, 1, 2}));
    EXPECT_THAT(triangles_of(patch, {0, 1, 2}, any_radius, 164), IsEmpty());
}

/// A loop with a strip around it that slopes down outwards by `fall` degrees: 0 is the loop's plane, 90 a wall below
/// it, and more a fold back under it. At `flaps` edges the strip's triangle is replaced by three around a point inside
/// the hole.
Patch strip_around(const std::vector<Vec3>& loop, const std::vector<Vec3>& outwards, double fall,
                   std::size_t flaps = 0) {
    const u32 count = static_cast<u32>(loop.size());
    std::vector<Vec3> positions = loop;
    for (u32 i = 0; i < count; ++i)
        positions.push_back(loop[i] +
                            0.3 * (std::cos(fall * degree) * outwards[i] - std::sin(fall * degree) * Vec3::UnitZ()));
    const auto flap_at = [&](std::size_t flap) { return static_cast<u32>(flap * count / 2); };
    for (std::size_t flap = 0; flap < flaps; ++flap) {
        const u32 i = flap_at(flap), next = (i + 1) % count;
        positions.push_back((loop[i] + loop[next]) / 2 - 0.2 * outwards[i] - Vec3(0, 0, 0.01));
    }
    Patch patch(positions);
    u32 flap = 0;
    for (u32 i = 0; i < count; ++i) {
        const u32 next = (i + 1) % count, middle = 2 * count + flap;
        if (flap < flaps && i == flap_at(flap)) {
            patch.add(next, i, middle);
            patch.add(i, count + i, middle);
            patch.add(count + i, next, middle);
            ++flap;
        } else
            patch.add(next, i, count + i);
        patch.add(count + i, count + next, next);
        // The outer boundary of the strip must stay open.
        patch.set_search_radius(count + i, 1e-6);
    }
    return patch;
}

Patch ring(u32 corners, double radius, double fall, std::size_t flaps = 0) {
    std::vector<Vec3> loop, outwards;
    for (u32 i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        outwards.push_back(Vec3(std::cos(angle), std::sin(angle), 0));
        loop.push_back(radius * outwards.back());
    }
    return strip_around(loop, outwards, fall, flaps);
}

/// 1 wide and `length` long, a corner at every unit.
Patch slit(u32 length, double fall) {
    std::vector<Vec3> loop, outwards;
    for (u32 x = 0; x <= length; ++x) {
        loop.push_back(Vec3(x, 0, 0));
        outwards.push_back(-Vec3::UnitY());
    }
    for (u32 x = length + 1; x-- > 0;) {
        loop.push_back(Vec3(x, 1, 0));
        outwards.push_back(Vec3::UnitY());
    }
    for (const std::size_t corner : {std::size_t(0), loop.size() - 1}) outwards[corner].x() = -0.5;
    for (const std::size_t corner : {std::size_t(length), std::size_t(length) + 1}) outwards[corner].x() = 0.5;
    for (Vec3& out : outwards) out.normalize();
    return strip_around(loop, outwards, fall);
}

/// `angle`: largest dihedral deviation in degrees.
NarrowHoles closed(Patch patch, double largest_radius, double angle = 180, std::size_t most_edges = 4) {
    return close_narrow_holes(patch.surface(), {largest_radius / 4, most_edges, angle * degree}, Execution());
}

TEST(NarrowHoles_RoundHoles, AreClosedBelowTheLargestRadius) {
    EXPECT_EQ(closed(ring(16, 1, 0), 1.001).closed, 1u);
    EXPECT_EQ(closed(ring(16, 1, 0), 0.99).closed, 0u);
    EXPECT_EQ(closed(ring(16, 1, 0), 0.99, 180, 15).closed, 0u);
    EXPECT_EQ(closed(ring(16, 1, 0), 0.99, 180, 16).closed, 1u) << "of any_radius size";
}

TEST(NarrowHoles_LoopsBesideSparsePoints, AreClosedBelowTheLargestRadiusOfAPoint) {
    const auto closed_with = [](double one) {
        Patch patch = ring(16, 1, 0);
        patch.set_search_radius(5, one);
        return close_narrow_holes(patch.surface(), {0.99 / 4, 4, 180 * degree}, Execution()).closed;
    };
    EXPECT_EQ(closed_with(4 * 1.02), 1u);
    EXPECT_EQ(closed_with(4 * 1.005), 0u);
    EXPECT_EQ(closed_with(1), 0u);
}

TEST(NarrowHoles_Slits, OfAtMost100EdgesAreClosed) {
    EXPECT_EQ(closed(slit(49, 0), 0.75).closed, 1u) << "100 edges";
    EXPECT_EQ(closed(slit(50, 0), 0.75).closed, 0u) << "102 edges";
}

TEST(NarrowHoles_LoopsThatTheSurfaceFacesAwayFrom, StayOpen) {
    for (const double fall : {0.0, 60.0, 90.0, 117.0}) EXPECT_EQ(closed(ring(16, 1, fall), 1.1).closed, 1u) << fall;
    for (const double fall : {123.0, 150.0}) EXPECT_EQ(closed(ring(16, 1, fall), 1.1).closed, 0u) << fall;
}

TEST(NarrowHoles_LongLoops, StayOpenWithSidesBetween78And120Degrees) {
    // The corners lie up to 15.008 from the middle.
    for (const double fall : {0.0, 60.0, 75.0}) EXPECT_EQ(closed(slit(30, fall), 1).closed, 1u) << fall;
    for (const double fall : {81.0, 90.0, 110.0}) EXPECT_EQ(closed(slit(30, fall), 1).closed, 0u) << fall;
    EXPECT_EQ(closed(slit(30, 90), 15.02 / 2).closed, 1u);
    EXPECT_EQ(closed(slit(30, 90), 15.00 / 2).closed, 0u);
}

TEST(NarrowHoles_DihedralDeviation, EndsTheSurfaceAboveItsLimit) {
    // A lid deviates from the strip by its fall, opposite parts of the strip from each other by twice as much.
    EXPECT_EQ(closed(ring(16, 1, 50), 1.1, 103).closed, 1u);
    EXPECT_EQ(closed(ring(16, 1, 50), 1.1, 97).closed, 0u) << "opposite parts of the strip differ too much";
    EXPECT_EQ(closed(ring(16, 1, 50), 1.1, 97, 16).closed, 1u) << "of any_radius size";
    EXPECT_EQ(closed(ring(16, 1, 85), 1.1, 171).closed, 1u);
    EXPECT_EQ(closed(ring(16, 1, 88), 1.1, 171).closed, 0u);
    EXPECT_EQ(closed(ring(16, 1, 88), 1.1, 172).closed, 1u) << "a tip";
}

TEST(NarrowHoles_NewEdges, AreShorterThanTheLongestEdge) {
    // A triangulation of 16 corners on a circle of radius 1 has an edge of at least 1.66: a triangle contains the
    // centre.
    for (const auto& [longest_edge, count] : {std::pair(1.65, 0u), std::pair(2.01, 1u)}) {
        for (const std::size_t most_edges : {4, 16}) {
            Patch patch = ring(16, 1, 0);
            EXPECT_EQ(close_narrow_holes(patch.surface(), {0.3, most_edges, 3, longest_edge}, Execution()).closed,
                      count)
                << longest_edge << " up to " << most_edges << " edges";
        }
        Patch patch = ring(16, 1, 0);
        EXPECT_EQ(close_small_holes(patch.surface(), 16, Execution(), longest_edge), count) << longest_edge;
    }
}

TEST(NarrowHoles_OneObstacle, IsReplacedAtLoopsOfAtMost30Corners) {
    const NarrowHoles at_30 = closed(ring(30, 3, 0, 1), 3.1);
    EXPECT_EQ(at_30.closed, 1u);
    EXPECT_EQ(at_30.replaced, 1u);
    const NarrowHoles at_31 = closed(ring(31, 3, 0, 1), 3.1);
    EXPECT_EQ(at_31.closed, 0u);
    EXPECT_EQ(at_31.replaced, 0u);
    EXPECT_EQ(closed(ring(30, 3, 0, 1), 2.5).replaced, 0u) << "a hole in any_radius case";
}

TEST(NarrowHoles_TwoObstacles, AreReplacedAtLoopsOfAtMost12Corners) {
    const NarrowHoles at_12 = closed(ring(12, 1, 0, 2), 1.1);
    EXPECT_EQ(at_12.closed, 1u);
    EXPECT_EQ(at_12.replaced, 2u);
    EXPECT_EQ(closed(ring(13, 1, 0, 2), 1.1).closed, 0u);
}

TEST(NarrowHoles_Closing, CanBeCancelledAtEveryLoop) {
    Patch patch = ring(16, 1, 0);
    ExecutionOptions options;
    options.is_cancelled = [] { return true; };
    EXPECT_THROW(close_narrow_holes(patch.surface(), {0.3, 4, 3}, Execution(options)), Cancelled);
}

}  // namespace
}  // namespace scanmill
