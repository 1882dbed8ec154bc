// SPDX-License-Identifier: GPL-3.0-or-later
/// The certified Hausdorff distance: its bounds contain the true distance, and the search ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "scanmill/base/random.hpp"
#include "scanmill/geometry/distance/certified_hausdorff.hpp"
#include "scanmill/geometry/distance/detail/triangle_part.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

CertifiedHausdorff bounds(const TriangleMesh& one, const TriangleMesh& other, const CertifyLimits& limits = {},
                          unsigned threads = 2) {
    Execution execution({threads, {}, {}});
    const TriangleTree tree(one.positions.span(), one.triangles.span(), 1);
    const TriangleTree other_tree(other.positions.span(), other.triangles.span(), 1);
    const auto to = nearest_of_vertices(one.positions.span(), one.triangles.span(), other_tree, 0, execution);
    const auto from = nearest_of_vertices(other.positions.span(), other.triangles.span(), tree, 0, execution);
    return certified_hausdorff({one.positions.span(), one.triangles.span(), tree, to},
                               {other.positions.span(), other.triangles.span(), other_tree, from}, 0, limits,
                               execution);
}

/// The largest distance to `other` of the corners of `mesh` and of 100 random points on each of its triangles.
double largest_sampled(const TriangleMesh& mesh, const TriangleMesh& other, Random& random) {
    const TriangleTree tree(other.positions.span(), other.triangles.span(), 1);
    double largest = 0;
    const auto add = [&](const Vec3& p) { largest = std::max(largest, std::sqrt(tree.nearest(p).squared_distance)); };
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        add(p);
        for (int i = 0; i < 100; ++i) {
            const double across = random.uniform(), along = (1 - across) * random.uniform();
            add(p + along * (q - p) + across * (r - p));
        }
    }
    return largest;
}

void expect_holds(const CertifiedHausdorff& found, double truth, double gap = 0.01) {
    EXPECT_TRUE(found.reached);
    EXPECT_LE(found.lower, truth * (1 + 1e-14));
    EXPECT_GE(found.upper, truth * (1 - 1e-14));
    EXPECT_LE(found.upper - found.lower, gap * found.upper + 1e-12);
}

TEST(CertifiedHausdorff, MaximumInsideATriangle_IsFound) {
    // A roof over a square: 0.5 / √2 from the square's centre to the roof's planes, 0.5 from the ridge to the square.
    // Neither surface has a vertex in its middle.
    const TriangleMesh roof = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0, 0.5}, {0.5, 1, 0.5}},
                                   {{0, 4, 5}, {0, 5, 3}, {4, 1, 2}, {4, 2, 5}});
    expect_holds(bounds(rectangle(1, 1), roof), 0.5);
    // The direction from the square alone: with the roof as a part of the other surface the ridge has distance 0.
    const TriangleMesh covered = both(rectangle(1, 1), roof);
    expect_holds(bounds(roof, covered), 0.5 / std::numbers::sqrt2);
}

TEST(CertifiedHausdorff, TightGap_IsReached) {
    const TriangleMesh roof = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0, 0.5}, {0.5, 1, 0.5}},
                                   {{0, 4, 5}, {0, 5, 3}, {4, 1, 2}, {4, 2, 5}});
    expect_holds(bounds(roof, both(rectangle(1, 1), roof), {1e-6, 1'000'000}), 0.5 / std::numbers::sqrt2, 1e-6);
}

TEST(CertifiedHausdorff, NearlyEqualMeshes_EndAtOnce) {
    const TriangleMesh mesh = torus(2, 0.5, 60, 30);
    for (double shift : {1e-10, 1e-13, 1e-18}) {
        const CertifiedHausdorff found = bounds(mesh, shifted(mesh, {shift, 0, 0}));
        EXPECT_TRUE(found.reached);
        EXPECT_EQ(found.cuts, 0u);
        EXPECT_LE(found.upper, 1.1e-10);
    }
}

TEST(CertifiedHausdorff, EqualSurfacesOfDifferentTriangles_AreNearlyZero) {
    // The other diagonal; and a mesh with its triangles in another order, begun at other corners.
    const TriangleMesh other = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 3}, {1, 2, 3}});
    const CertifiedHausdorff found = bounds(rectangle(1, 1), other, {0.01, 100'000});
    EXPECT_EQ(found.lower, 0);
    EXPECT_LT(found.upper, 1e-3);
    Array<Triangle> reordered;
    const TriangleMesh sphere = geodesic_sphere(1, 9);
    for (std::size_t i = sphere.triangles.size(); i-- > 0;)
        reordered.push_back({sphere.triangles[i][2], sphere.triangles[i][0], sphere.triangles[i][1]});
    TriangleMesh same = sphere;
    same.triangles = std::move(reordered);
    EXPECT_EQ(bounds(sphere, same).upper, 0);
}

TEST(CertifiedHausdorff, CutsUsedUp_LeavesWiderBoundsThatHold) {
    const TriangleMesh roof = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0, 0.5}, {0.5, 1, 0.5}},
                                   {{0, 4, 5}, {0, 5, 3}, {4, 1, 2}, {4, 2, 5}});
    const double truth = 0.5 / std::numbers::sqrt2;
    double last = 10;
    for (u64 cuts : {0u, 1u, 2u, 3u}) {
        const CertifiedHausdorff found = bounds(roof, both(rectangle(1, 1), roof), {1e-9, cuts});
        EXPECT_FALSE(found.reached);
        EXPECT_EQ(found.cuts, cuts);
        EXPECT_LE(found.lower, truth);
        EXPECT_GE(found.upper, truth);
        EXPECT_LE(found.upper, last);
        last = found.upper;
    }
}

TEST(CertifiedHausdorff, RandomSurfaces_BoundEverySample) {
    // No point of either surface is farther from the other than the upper bound.
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        Random random(seed);
        const auto bumpy = [&](u32 frequency) {
            return with_positions(geodesic_sphere(1, frequency),
                                  [&](const Vec3& p) -> Vec3 { return p * random.uniform(0.9, 1.1); });
        };
        const TriangleMesh one = bumpy(5), other = bumpy(7);
        const CertifiedHausdorff found = bounds(one, other);
        const double sampled = std::max(largest_sampled(one, other, random), largest_sampled(other, one, random));
        EXPECT_TRUE(found.reached);
        EXPECT_LE(sampled, found.upper);
        EXPECT_GE(sampled, found.lower * 0.9);
        EXPECT_GE(found.upper, found.lower);
    }
}

double area_of(const triangle_parts::TrianglePart& part) {
    const auto& [a, b, c] = part.corners;
    return (b.position - a.position).cross(c.position - a.position).norm() / 2;
}

/// No point of the part is farther from the other surface than its bound.
void expect_bounded(const triangle_parts::TrianglePart& part, Random& random) {
    const auto& [a, b, c] = part.corners;
    for (int i = 0; i < 30; ++i) {
        const double across = random.uniform(), along = (1 - across) * random.uniform();
        const Vec3 point = a.position + along * (b.position - a.position) + across * (c.position - a.position);
        EXPECT_LE(std::sqrt(part.other->nearest(point).squared_distance), part.upper * (1 + 1e-12));
    }
}

TEST(CertifiedHausdorff, EveryPart_IsBoundedAndCutWithoutLoss) {
    // Small triangles, near and far, below and beside a large triangle, which is cut four times.
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Random random(seed);
        Array<Vec3> positions;
        Array<Triangle> triangles;
        for (u32 i = 0; i < 12; ++i) {
            const Vec3 middle(random.uniform(), random.uniform(), 0.3 * random.uniform());
            for (int corner = 0; corner < 3; ++corner)
                positions.push_back(middle + random.uniform(0, 0.3) * Vec3(random.normal(), random.normal(), 0));
            triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        }
        const TriangleTree tree(positions, triangles, 1);
        triangle_parts::TrianglePart whole;
        whole.corners = {{{Vec3(0, 0, 0)}, {Vec3(1, 0, 0)}, {Vec3(0, 1, 0)}}};
        whole.other = &tree;
        triangle_parts::bound(whole, 0);
        std::vector<triangle_parts::TrianglePart> parts{whole};
        for (int level = 0; level < 4; ++level) {
            std::vector<triangle_parts::TrianglePart> next;
            double area = 0;
            for (const triangle_parts::TrianglePart& part : parts) {
                expect_bounded(part, random);
                const triangle_parts::Cut cut = triangle_parts::cut(part, 0);
                for (std::size_t i = 0; i < cut.count; ++i) {
                    next.push_back(cut.parts[i]);
                    area += area_of(cut.parts[i]);
                    EXPECT_LE(cut.parts[i].upper, part.upper);
                }
            }
            EXPECT_NEAR(area, 0.5, 1e-12);
            parts = std::move(next);
        }
    }
}

TEST(CertifiedHausdorff, BoundsHoldAfterAnyNumberOfCuts) {
    // An equilateral triangle of circumradius 1 against tiny triangles at its corners and centre: 1/√3, at the points
    // of its edges that are equally far from the centre and the next corner.
    const double height = 1.5, half = std::sqrt(3) / 2;
    const TriangleMesh large = soup({{0, 1, 0}, {-half, 1 - height, 0}, {half, 1 - height, 0}}, {{0, 1, 2}});
    TriangleMesh tiny = scaled(large, 1e-7);
    for (const Vec3& corner : large.positions) tiny = both(tiny, shifted(scaled(large, 1e-7), 0.9999999 * corner));
    const double truth = 1 / std::numbers::sqrt3;
    for (u64 cuts = 0; cuts < 200; cuts = 2 * cuts + 1) {
        const CertifiedHausdorff found = bounds(large, tiny, {0.001, cuts});
        EXPECT_LE(found.lower, truth + 1e-6) << cuts;
        EXPECT_GE(found.upper, truth - 1e-6) << cuts;
    }
    const CertifiedHausdorff found = bounds(large, tiny);
    EXPECT_TRUE(found.reached);
    EXPECT_LE(found.upper - found.lower, 0.01 * found.upper + 1e-12);
}

/// A sphere of 2,880 triangles and one of 80, with random bumps: at least a few hundred cuts.
std::pair<TriangleMesh, TriangleMesh> bumpy_spheres(std::uint64_t seed) {
    Random random(seed);
    const auto bumpy = [&](u32 frequency, double height) {
        return with_positions(geodesic_sphere(1, frequency),
                              [&](const Vec3& p) -> Vec3 { return p * random.uniform(1, 1 + height); });
    };
    TriangleMesh fine = bumpy(12, 0.02), coarse = bumpy(2, 0.2);
    return {std::move(fine), std::move(coarse)};
}

TEST(CertifiedHausdorffBound, AboveTheDistance_IsProvenHoweverSmallTheSlack) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const auto [fine, coarse] = bumpy_spheres(seed);
        const CertifiedHausdorff tight = bounds(fine, coarse, {1e-6, 1'000'000});
        ASSERT_TRUE(tight.reached);
        EXPECT_GT(bounds(fine, coarse, {0.3, 1'000'000}).upper, 1.0005 * tight.upper) << "the gap alone proves less";
        for (const double slack : {1.0005, 1.01, 1.2}) {
            const double bound = slack * tight.upper;
            const CertifiedHausdorff found = bounds(fine, coarse, {0.3, 1'000'000, bound});
            EXPECT_LE(found.upper, bound) << slack;
            EXPECT_LE(found.lower, tight.upper);
            EXPECT_GE(found.upper, tight.lower);
            EXPECT_TRUE(found.reached);
        }
    }
}

TEST(CertifiedHausdorffBound, AboveTheDistance_LeavesTheGapAsItIs) {
    const auto [fine, coarse] = bumpy_spheres(7);
    const CertifiedHausdorff plain = bounds(fine, coarse);
    const CertifiedHausdorff found = bounds(fine, coarse, {0.01, 1'000'000, 2 * plain.upper});
    EXPECT_EQ(found.lower, plain.lower);
    EXPECT_EQ(found.upper, plain.upper);
    EXPECT_EQ(found.cuts, plain.cuts);
}

TEST(CertifiedHausdorffBound, BelowTheDistance_IsRefutedBeforeTheGapIsReached) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const auto [fine, coarse] = bumpy_spheres(seed);
        const CertifiedHausdorff tight = bounds(fine, coarse, {1e-6, 1'000'000});
        for (const double share : {0.999, 0.9, 0.3, 0.0}) {
            const double bound = share * tight.lower;
            const CertifiedHausdorff found = bounds(fine, coarse, {1e-6, 1'000'000, bound});
            EXPECT_GT(found.lower, bound) << share;
            EXPECT_LE(found.lower, tight.upper);
            EXPECT_GE(found.upper, tight.lower);
            EXPECT_FALSE(found.reached);
            EXPECT_LT(found.cuts, tight.cuts);
        }
        EXPECT_LT(bounds(fine, coarse, {1e-6, 1'000'000, 0.3 * tight.lower}).cuts, 10u);
    }
}

TEST(CertifiedHausdorffBound, FarAboveTheDistance_NeedsNoGap) {
    // At 1 % of the bound the distance is negligible.
    const TriangleMesh one = geodesic_sphere(1, 12), other = geodesic_sphere(1, 11);
    const CertifiedHausdorff found = bounds(one, other, {0.01, 1'000'000, 5.0});
    EXPECT_TRUE(found.reached);
    EXPECT_LE(found.upper, 0.05);
    EXPECT_LT(2 * found.cuts, bounds(one, other).cuts);
}

TEST(CertifiedHausdorffBound, Zero_IsProvenForEqualSurfacesOfDifferentTriangles) {
    // An n × n grid in a slanted plane against the two triangles of its square; all positions are exact.
    constexpr u32 n = 16;
    const auto point = [](u32 x, u32 y) -> Vec3 { return {x / 16.0, y / 16.0, x / 32.0 + 1}; };
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 y = 0; y <= n; ++y)
        for (u32 x = 0; x <= n; ++x) positions.push_back(point(x, y));
    for (u32 y = 0; y < n; ++y)
        for (u32 x = 0; x < n; ++x) {
            const u32 corner = y * (n + 1) + x;
            triangles.push_back({corner, corner + 1, corner + n + 2});
            triangles.push_back({corner, corner + n + 2, corner + n + 1});
        }
    const TriangleMesh grid = soup(positions, triangles);
    const TriangleMesh square = soup({point(0, 0), point(n, 0), point(n, n), point(0, n)}, {{0, 1, 3}, {1, 2, 3}});
    const CertifiedHausdorff found = bounds(grid, square, {0.01, 10'000, 0.0});
    EXPECT_EQ(found.upper, 0);
    EXPECT_LT(found.cuts, 10 * triangles.size());
    EXPECT_GT(bounds(grid, shifted(square, {0, 0, 1e-9}), {0.01, 10'000, 0.0}).lower, 0);
}

TEST(CertifiedHausdorffBound, CutsUsedUp_LeavesItOpen) {
    const auto [fine, coarse] = bumpy_spheres(2);
    const double bound = 1.0005 * bounds(fine, coarse, {1e-6, 1'000'000}).upper;
    const CertifiedHausdorff found = bounds(fine, coarse, {0.01, 20, bound});
    EXPECT_EQ(found.cuts, 20u);
    EXPECT_LE(found.lower, bound);
    EXPECT_GT(found.upper, bound);
}

TEST(CertifiedHausdorff, TwoMeshes_NeedNoTrees) {
    const auto [fine, coarse] = bumpy_spheres(1);
    Execution execution({2, {}, {}});
    const CertifiedHausdorff tight = bounds(fine, coarse, {1e-6, 1'000'000});
    const CertifiedHausdorff found = certified_hausdorff(fine, coarse, {0.001}, execution);
    EXPECT_TRUE(found.reached);
    EXPECT_LE(found.lower, tight.upper);
    EXPECT_GE(found.upper, tight.lower);
    EXPECT_LE(found.upper - found.lower, 0.001 * found.upper + 1e-12);
    // Vertices in no triangle are no part of the surface.
    Array<Vec3> positions(fine.positions.begin(), fine.positions.end());
    positions.push_back({100, 0, 0});
    TriangleMesh with_unused = fine;
    with_unused.positions = std::move(positions);
    EXPECT_EQ(certified_hausdorff(with_unused, coarse, {0.001}, execution).upper, found.upper);
    EXPECT_EQ(certified_hausdorff(fine, fine, {}, execution).upper, 0);
}

TEST(CertifiedHausdorff, Cancelled_Ends) {
    const auto [fine, coarse] = bumpy_spheres(1);
    Execution execution({2, {}, [] { return true; }});
    EXPECT_THROW(certified_hausdorff(fine, coarse, {}, execution), Cancelled);
}

TEST(CertifiedHausdorff, ExchangedSurfaces_HaveTheSameDistance) {
    const TriangleMesh one = geodesic_sphere(1, 6), other = icosahedron(1.1);
    const CertifiedHausdorff there = bounds(one, other), back = bounds(other, one);
    EXPECT_LE(there.lower, back.upper);
    EXPECT_LE(back.lower, there.upper);
}

/// A slanted triangle with a longest edge of 3 and this height over it, as a share of that edge; whole, and split at a
/// point inside it.
std::pair<TriangleMesh, TriangleMesh> needle(double height) {
    const Vec3 a(0.1, 0.2, 0.3), b(2.1, 2.2, 1.3), c = a + 0.3 * (b - a) + 3 * height * Vec3(1, -1, 0).normalized();
    const Vec3 inside = (a + b + 2 * c) / 4;
    return {soup({a, b, c}, {{0, 1, 2}}), soup({a, b, c, inside}, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}})};
}

TEST(CertifiedHausdorff, NeedlesAgainstTheirParts_HaveDistanceZero) {
    for (double height = 0.3; height > 1e-9; height /= 3) {
        const auto& [whole, parts] = needle(height);
        const CertifiedHausdorff found = bounds(whole, parts, {0.01, 100'000});
        EXPECT_EQ(found.lower, 0) << height;
        EXPECT_LT(found.upper, 1e-6) << height;
    }
}

TEST(CertifiedHausdorff, AnyNumberOfThreads_GivesTheSameBounds) {
    const TriangleMesh one = turned(torus(2, 0.5, 40, 20), 0.1, {1, 2, 3}), other = torus(2, 0.5, 33, 21);
    const CertifiedHausdorff serial = bounds(one, other, {0.001, 20'000}, 1);
    for (unsigned threads : {2u, 3u}) {
        const CertifiedHausdorff parallel = bounds(one, other, {0.001, 20'000}, threads);
        EXPECT_EQ(parallel.lower, serial.lower);
        EXPECT_EQ(parallel.upper, serial.upper);
        EXPECT_EQ(parallel.cuts, serial.cuts);
    }
}

}  // namespace
}  // namespace scanmill::test
