// SPDX-License-Identifier: GPL-3.0-or-later
/// Whether two triangles intersect: cases by hand, and comparisons with intersections that CGAL constructs exactly.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "scanmill/base/random.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"

namespace scanmill::test {
namespace {

/// The answer, which must not depend on the order of triangles or corners.
bool do_intersect(const std::vector<Vec3>& positions, Triangle one, Triangle other) {
    const bool result = triangles_intersect(positions, one, other);
    std::ranges::sort(one);
    std::ranges::sort(other);
    const Triangle first = one, second = other;
    do {
        do {
            EXPECT_EQ(triangles_intersect(positions, one, other), result);
            EXPECT_EQ(triangles_intersect(positions, other, one), result);
        } while (std::ranges::next_permutation(other).found);
        EXPECT_EQ(other, second);
    } while (std::ranges::next_permutation(one).found);
    EXPECT_EQ(one, first);
    return result;
}

/// The floor (0, 0, 0), (4, 0, 0), (0, 4, 0) and a triangle with these corners, without common indices.
bool meets_floor(const Vec3& a, const Vec3& b, const Vec3& c) {
    return do_intersect({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, a, b, c}, {0, 1, 2}, {3, 4, 5});
}
/// The same with the first corner in common.
bool meets_floor_from_corner(const Vec3& b, const Vec3& c) {
    return do_intersect({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, b, c}, {0, 1, 2}, {0, 3, 4});
}
/// The same with the edge from (0, 0, 0) to (4, 0, 0) in common.
bool meets_floor_over_edge(const Vec3& d) {
    return do_intersect({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, d}, {0, 1, 2}, {1, 0, 3});
}

TEST(TrianglesIntersect, NoCommonCorner) {
    EXPECT_TRUE(meets_floor({1, 1, -1}, {1, 1, 1}, {5, 5, 0})) << "passes through it";
    EXPECT_FALSE(meets_floor({1, 1, 1}, {2, 1, 1}, {1, 2, 3})) << "above it";
    EXPECT_FALSE(meets_floor({3, 3, -1}, {3, 3, 1}, {5, 5, 0})) << "beside it, with boxes that overlap";
    EXPECT_TRUE(meets_floor({1, 1, 0}, {1, 1, 1}, {2, 1, 1})) << "a corner on the face";
    EXPECT_TRUE(meets_floor({1, 0, 0}, {1, -1, 0}, {2, -1, 0})) << "a corner on an edge";
    EXPECT_TRUE(meets_floor({0, 0, 0}, {-1, 0, 0}, {0, -1, 0})) << "a corner on a corner";
    EXPECT_TRUE(meets_floor({2, -1, 1}, {2, -1, -1}, {2, 0, 0})) << "a corner on an edge, out of the plane";
    EXPECT_TRUE(meets_floor({2, -1, -1}, {2, 1, 1}, {2, -9, 0})) << "an edge on an edge, crossing";
    EXPECT_TRUE(meets_floor({1, 0, 0}, {3, 0, 0}, {2, -1, 0})) << "a part of an edge";
    EXPECT_TRUE(meets_floor({0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0})) << "inside it, in its plane";
    EXPECT_TRUE(meets_floor({-1, 1, 0}, {5, 1, 0}, {2, -9, 0})) << "across it, in its plane";
    EXPECT_FALSE(meets_floor({3, 3, 0}, {5, 3, 0}, {3, 5, 0})) << "beside it, in its plane";
    EXPECT_FALSE(meets_floor({1, 1, 1e-300}, {1, 1, 1}, {2, 1, 1})) << "next to the face";
    EXPECT_TRUE(meets_floor({0, 0, 0}, {4, 0, 0}, {0, 4, 0})) << "equal positions are not common corners";
}

TEST(TrianglesIntersect, OneCommonCorner) {
    EXPECT_FALSE(meets_floor_from_corner({-1, 0, 0}, {0, -1, 0})) << "opposite, in its plane";
    EXPECT_FALSE(meets_floor_from_corner({1, -1, 0}, {-1, -1, 0})) << "beside it, in its plane";
    EXPECT_FALSE(meets_floor_from_corner({1, 1, 1}, {2, 1, 1})) << "above it";
    EXPECT_FALSE(meets_floor_from_corner({-1, 1, 1}, {-1, 1, -1})) << "beside it, and crossing its plane";
    EXPECT_TRUE(meets_floor_from_corner({1, 1, 1}, {1, 1, -1})) << "the edge opposite passes through it";
    EXPECT_TRUE(meets_floor_from_corner({5, 5, 1}, {5, 5, -1})) << "passes through the other's opposite edge";
    EXPECT_TRUE(meets_floor_from_corner({1, 1, 0}, {1, 1, 1})) << "a corner on the face";
    EXPECT_TRUE(meets_floor_from_corner({2, 2, 0}, {3, 3, 1})) << "a corner on the opposite edge";
    EXPECT_TRUE(meets_floor_from_corner({1, 2, 0}, {2, 1, 0})) << "on it, in its plane";
    EXPECT_TRUE(meets_floor_from_corner({2, 0, 0}, {0, 0, 1})) << "a part of an edge is an edge of the other";
    EXPECT_TRUE(meets_floor_from_corner({2, 0, 0}, {1, -1, 0})) << "the same in its plane";
}

TEST(TrianglesIntersect, CommonEdge) {
    EXPECT_FALSE(meets_floor_over_edge({0, -4, 0})) << "the next triangle in its plane";
    EXPECT_FALSE(meets_floor_over_edge({1, 1, 1})) << "at an angle";
    EXPECT_FALSE(meets_floor_over_edge({0, 4, 1e-300})) << "folded nearly flat";
    EXPECT_TRUE(meets_floor_over_edge({1, 1, 0})) << "folded flat onto it";
    EXPECT_TRUE(meets_floor_over_edge({-9, 4, 0})) << "folded flat, and over its edge";
}

TEST(TrianglesIntersect, TheSameTriangleTwice) {
    EXPECT_TRUE(do_intersect({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {0, 1, 2}, {2, 1, 0}));
    EXPECT_TRUE(do_intersect({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {0, 1, 2}, {0, 1, 2}));
}

TEST(TrianglesIntersect, CollinearTriangles_IntersectNothing) {
    EXPECT_FALSE(meets_floor({1, 1, -1}, {1, 1, 0}, {1, 1, 1}));
    EXPECT_FALSE(meets_floor({1, 1, 0}, {1, 1, 0}, {1, 1, 0}));
    EXPECT_FALSE(meets_floor_from_corner({1, 1, 0}, {2, 2, 0}));
    EXPECT_FALSE(meets_floor_from_corner({1, 1, 0}, {1, 1, 0}));
    EXPECT_FALSE(meets_floor_over_edge({2, 0, 0}));
    const std::vector<Vec3> positions{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {2, 0, 0}};
    for (const Triangle& repeated : {Triangle{0, 0, 1}, {0, 0, 4}, {3, 3, 4}, {3, 4, 4}, {5, 5, 5}, {0, 1, 1}})
        EXPECT_FALSE(do_intersect(positions, {0, 1, 2}, repeated));
    EXPECT_FALSE(do_intersect(positions, {0, 5, 1}, {0, 5, 1}));
    EXPECT_FALSE(do_intersect(positions, {0, 0, 1}, {0, 0, 1}));
}

TEST(Collinear, IsExact) {
    EXPECT_TRUE(collinear({0, 0, 0}, {1, 2, 3}, {3, 6, 9}));
    EXPECT_TRUE(collinear({1, 2, 3}, {1, 2, 3}, {4, 4, 4}));
    EXPECT_FALSE(collinear({0, 0, 0}, {1, 0, 0}, {2, 1e-300, 0}));
    EXPECT_FALSE(collinear({0, 0, 0}, {1, 1, 1}, {3, 3, std::nextafter(3, 4)}));
    // 0.1, 0.2 and 0.3 are not equally spaced as doubles.
    EXPECT_FALSE(collinear({0.1, 1, 0}, {0.2, 2, 0}, {0.3, 3, 0}));
}

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;

/// By constructing the intersection, in rational numbers.
bool intersect_beyond_common(const std::vector<Vec3>& positions, const Triangle& one, const Triangle& other) {
    const auto point = [&](u32 i) { return Kernel::Point_3(positions[i].x(), positions[i].y(), positions[i].z()); };
    const auto triangle = [&](const Triangle& t) { return Kernel::Triangle_3(point(t[0]), point(t[1]), point(t[2])); };
    if (triangle(one).is_degenerate() || triangle(other).is_degenerate()) return false;
    const auto shared = CGAL::intersection(triangle(one), triangle(other));
    if (!shared) return false;
    std::vector<Kernel::Point_3> common;
    for (const u32 corner : one)
        if (std::ranges::count(other, corner) > 0) common.push_back(point(corner));
    if (const auto* at = boost::get<Kernel::Point_3>(&*shared)) return common.size() != 1 || *at != common[0];
    if (const auto* edge = boost::get<Kernel::Segment_3>(&*shared))
        return common.size() != 2 ||
               (*edge != Kernel::Segment_3(common[0], common[1]) && *edge != Kernel::Segment_3(common[1], common[0]));
    return true;
}

/// Compares pairs of triangles between `points` corners each that `position` draws. Returns how often they intersect.
template <class Position>
std::map<bool, int> compared(int rounds, u32 points, std::uint64_t seed, Position&& position) {
    std::map<bool, int> answers;
    Random random(seed);
    for (int round = 0; round < rounds; ++round) {
        std::vector<Vec3> positions(points);
        for (Vec3& p : positions) p = position(random);
        // Equal positions with different indices are not common corners: merged, as self_intersections() does.
        const auto corner = [&] {
            const Vec3& p = positions[random.index(points)];
            return static_cast<u32>(std::ranges::find(positions, p) - positions.begin());
        };
        const Triangle one{corner(), corner(), corner()}, other{corner(), corner(), corner()};
        const bool expected = intersect_beyond_common(positions, one, other);
        ++answers[expected];
        EXPECT_EQ(triangles_intersect(positions, one, other), expected)
            << "round " << round << " of seed " << seed << ": " << one[0] << ' ' << one[1] << ' ' << one[2] << " and "
            << other[0] << ' ' << other[1] << ' ' << other[2];
    }
    return answers;
}

Vec3 small_integers(Random& random, std::uint64_t most) {
    const auto coordinate = [&] { return static_cast<double>(random.index(most + 1)); };
    const double x = coordinate(), y = coordinate();
    return {x, y, coordinate()};
}

void expect_both_often(std::map<bool, int> answers, int times) {
    EXPECT_GT(answers[false], times);
    EXPECT_GT(answers[true], times);
}

TEST(TrianglesIntersect, SmallIntegers_AreAsConstructedExactly) {
    for (const std::uint64_t most : {1, 2, 3, 6})
        for (const u32 points : {5u, 6u, 9u})
            expect_both_often(compared(3000, points, most * 100 + points,
                                       [&](Random& random) { return small_integers(random, most); }),
                              50);
}

TEST(TrianglesIntersect, CoplanarTriangles_AreAsConstructedExactly) {
    for (const u32 points : {4u, 5u, 6u, 9u})
        expect_both_often(compared(3000, points, points,
                                   [](Random& random) -> Vec3 {
                                       const Vec3 p = small_integers(random, 4);
                                       return {p.x(), p.y(), p.x() + 2 * p.y()};
                                   }),
                          200);
}

TEST(TrianglesIntersect, RoundedPositions_AreAsConstructedExactly) {
    // Nearly coplanar, nearly on common lines, by a few roundings; also where products underflow.
    const Eigen::Matrix3d turn = (Eigen::Matrix3d() << 0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6).finished();
    for (const double scale : {0.1, 1e-9, 1e7, 1e30, 1e-105, 1e-107, 1e-160})
        for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(1.1, -20.3, 300.7)})
            expect_both_often(compared(3000, 6, 7,
                                       [&](Random& random) -> Vec3 {
                                           Vec3 p = small_integers(random, 3);
                                           if (random.index(2) == 0) p.z() = 0;
                                           return scale * (turn * p + shift);
                                       }),
                              50);
}

}  // namespace
}  // namespace scanmill::test
