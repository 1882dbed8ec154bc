// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/distance/swept_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scanmill/base/random.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using Segment = std::array<Vec3, 2>;
using Corners = std::array<Vec3, 3>;

Vec3 random_point(Random& random) { return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; }

/// Degenerate now and then: equal or collinear corners.
Corners random_triangle(Random& random) {
    const double size = std::pow(10, random.uniform(-3, 0));
    const Vec3 at = random_point(random);
    Corners corners{at, Vec3(at + size * random_point(random)), Vec3(at + size * random_point(random))};
    if (random.index(9) == 0) corners[1] = corners[0];
    if (random.index(9) == 0) corners[2] = corners[0] + random.uniform(-1, 2) * (corners[1] - corners[0]);
    return corners;
}
Segment random_segment(Random& random) {
    const Corners corners = random_triangle(random);
    return {corners[0], corners[1]};
}

/// The least value of a convex function on [0, 1], by thirds.
template <class F>
double least_of_convex(F&& f) {
    double low = 0, high = 1;
    for (int step = 0; step < 60; ++step) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
    }
    return std::min({f(0.0), f(1.0), f((low + high) / 2)});
}

double sought_distance(const Segment& segment, const Corners& triangle) {
    return least_of_convex([&](double s) {
        const Vec3 p = segment[0] + s * (segment[1] - segment[0]);
        return (nearest_on_triangle(p, triangle[0], triangle[1], triangle[2]) - p).norm();
    });
}
double sought_distance(const Corners& one, const Corners& other) {
    return least_of_convex([&](double s) {
        const Vec3 p = one[0] + s * (one[1] - one[0]), q = one[0] + s * (one[2] - one[0]);
        return sought_distance(Segment{p, q}, other);
    });
}

TEST(SweptDistance, OfASegmentAndATriangle_IsTheLeastDistanceOfItsPoints) {
    Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const Corners triangle = random_triangle(random);
        const Segment segment = random_segment(random);
        EXPECT_NEAR(std::sqrt(squared_distance(segment, triangle)), sought_distance(segment, triangle), 1e-9) << i;
    }
}

TEST(SweptDistance, OfTwoTriangles_IsTheLeastDistanceOfTheirPoints) {
    Random random(2);
    for (int i = 0; i < 300; ++i) {
        const Corners one = random_triangle(random), other = random_triangle(random);
        EXPECT_NEAR(std::sqrt(squared_distance(one, other)), sought_distance(one, other), 1e-9) << i;
        EXPECT_EQ(squared_distance(one, other), squared_distance(other, one)) << i;
    }
}

TEST(SweptDistance, KnownCases) {
    const Corners triangle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
    const auto to = [&](const Vec3& p, const Vec3& q) { return squared_distance(Segment{p, q}, triangle); };
    EXPECT_EQ(to({1, 1, 3}, {1, 1, -1}), 0) << "through the inside";
    EXPECT_EQ(to({1, 1, 3}, {1, 1, 2}), 4) << "above the inside";
    EXPECT_EQ(to({-3, 2, 0}, {5, 2, 0}), 0) << "in its plane, across";
    EXPECT_EQ(to({1, 1, 0}, {1.5, 1, 0}), 0) << "in its plane, inside";
    EXPECT_EQ(to({-1, -3, 2}, {5, -3, 2}), 13) << "parallel to an edge";
    EXPECT_EQ(to({4, 4, -1}, {4, 4, 1}), 8) << "across the plane, beside the longest edge";
    EXPECT_EQ(to({1, 1, 2}, {1, 1, 2}), 4) << "a point";
    const Corners crossing{Vec3(1, 1, -1), Vec3(1, 1, 1), Vec3(9, 9, 0)};
    EXPECT_EQ(squared_distance(triangle, crossing), 0);
    const Corners inside{Vec3(1, 1, 0), Vec3(1.5, 1, 0), Vec3(1, 1.5, 0)};
    EXPECT_EQ(squared_distance(triangle, inside), 0) << "in its plane, inside";
    const Corners above{Vec3(-9, -9, 2), Vec3(20, 0, 2), Vec3(0, 20, 2)};
    EXPECT_EQ(squared_distance(triangle, above), 4);
}

TEST(SweptDistance, OfSegments_ParallelAndCrossing) {
    const Segment x{Vec3(0, 0, 0), Vec3(2, 0, 0)};
    EXPECT_EQ(squared_distance_of_segments(x, {Vec3(1, 1, 0), Vec3(5, 1, 0)}), 1);
    EXPECT_EQ(squared_distance_of_segments(x, {Vec3(3, 1, 0), Vec3(5, 1, 0)}), 2);
    EXPECT_EQ(squared_distance_of_segments(x, {Vec3(1, -1, 3), Vec3(1, 1, 3)}), 9);
    EXPECT_EQ(squared_distance_of_segments(x, x), 0);
    EXPECT_EQ(squared_distance_of_segments({x[0], x[0]}, {Vec3(0, 2, 0), Vec3(0, 2, 0)}), 4);
}

/// Triangles of all sizes at `at`.
TriangleMesh soup(std::size_t count, Random& random, const Vec3& at) {
    Array<Vec3> positions;
    Array<Triangle> rows;
    for (std::size_t i = 0; i < count; ++i) {
        for (const Vec3& corner : random_triangle(random)) positions.push_back(at + corner);
        const auto first = static_cast<u32>(3 * i);
        rows.push_back({first, first + 1, first + 2});
    }
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(rows);
    return mesh;
}

template <class Body>
bool any_of_all(const TriangleMesh& mesh, const Body& body, double distance) {
    return std::ranges::any_of(mesh.triangles, [&](const Triangle& t) {
        return squared_distance(body, Corners{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]}) <
               distance * distance;
    });
}

TEST(SweptDistance, FromAMesh_IsThatFromAllItsTriangles) {
    Random random(3);
    int near = 0, far = 0;
    for (const std::size_t triangles : {1, 5, 40, 300})
        for (const Vec3& at : {Vec3(0, 0, 0), Vec3(1e6, -3, 7)}) {
            const TriangleMesh mesh = soup(triangles, random, at);
            const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
            for (int i = 0; i < 400; ++i) {
                const double distance = std::pow(10, random.uniform(-4, 0));
                Segment segment = random_segment(random);
                Corners triangle = random_triangle(random);
                for (Vec3& p : segment) p += at;
                for (Vec3& p : triangle) p += at;
                const bool expected = any_of_all(mesh, segment, distance);
                EXPECT_EQ(is_nearer(tree, segment, distance), expected);
                EXPECT_EQ(is_nearer(tree, triangle, distance), any_of_all(mesh, triangle, distance));
                (expected ? near : far) += 1;
            }
        }
    EXPECT_GT(near, 300);
    EXPECT_GT(far, 300);
}

TEST(SweptDistance, OfASegmentThatMoves_IsTheLeastOfItsPositions) {
    Random random(4);
    for (int i = 0; i < 300; ++i) {
        const TriangleMesh mesh = soup(5, random, Vec3::Zero());
        const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
        const Segment segment = random_segment(random);
        const Vec3 motion = random_point(random);
        double least = 1e9;
        for (const Triangle& t : mesh.triangles)
            least =
                std::min(least, least_of_convex([&](double s) {
                             const Vec3 shift = s * motion;
                             return sought_distance(Segment{Vec3(segment[0] + shift), Vec3(segment[1] + shift)},
                                                    {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
                         }));
        EXPECT_FALSE(is_nearer_when_moved(tree, segment, motion, std::max(0.0, least - 1e-9))) << i;
        EXPECT_TRUE(is_nearer_when_moved(tree, segment, motion, least + 1e-9)) << i;
    }
}

TEST(SweptDistance, TrianglesThatDoNotCount_AreIgnored) {
    const TriangleMesh mesh = cube();
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    const BoundingBox box = bounding_box(mesh.positions.span());
    const Segment down{Vec3((box.low + box.high) / 2 + Vec3(0, 0, 5)), Vec3((box.low + box.high) / 2)};
    EXPECT_TRUE(is_nearer(tree, down, 0.01));
    EXPECT_FALSE(is_nearer(tree, down, 0.01, [&](u32 slot) {
        const Corners& c = tree.corners(slot);
        return !(c[0].z() == box.high.z() && c[1].z() == box.high.z() && c[2].z() == box.high.z());
    }));
}

}  // namespace
}  // namespace scanmill::test
