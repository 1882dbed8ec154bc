// SPDX-License-Identifier: GPL-3.0-or-later
/// The certified Hausdorff distance: it holds the true one, and ends.
#include <gtest/gtest.h>

#include <numbers>

#include "filters/measure_cases.hpp"

namespace scanmill::test {
namespace {

CertifiedHausdorff bounds(const TriangleMesh& one, const TriangleMesh& other, const CertifyLimits& limits = {},
                          unsigned threads = 2) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    const TriangleTree tree(one.positions.span(), one.triangles.span(), 1);
    const TriangleTree other_tree(other.positions.span(), other.triangles.span(), 1);
    return certified_hausdorff({one.positions.span(), one.triangles.span(), tree},
                               {other.positions.span(), other.triangles.span(), other_tree}, limits, context);
}

void expect_holds(const CertifiedHausdorff& found, double truth, double gap = 0.01) {
    EXPECT_TRUE(found.reached);
    EXPECT_LE(found.lower, truth * (1 + 1e-14));
    EXPECT_GE(found.upper, truth * (1 - 1e-14));
    EXPECT_LE(found.upper - found.lower, gap * found.upper + 1e-12);
}

TEST(CertifiedHausdorff, MaximumInsideATriangle_IsFound) {
    // A roof over a square: from the square's centre it is 0.5 / √2 to the roof's planes, and 0 at all its vertices
    // but the ridge's; back from the ridge 0.5. Neither surface has a vertex in its middle.
    const TriangleMesh roof = soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0, 0.5}, {0.5, 1, 0.5}},
                                   {{0, 4, 5}, {0, 5, 3}, {4, 1, 2}, {4, 2, 5}});
    expect_holds(bounds(rectangle(1, 1), roof), 0.5);
    // One way of that alone: the roof as a part of the other surface leaves the square's side as the larger.
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

TEST(CertifiedHausdorff, EqualSurfacesOfDifferentTriangles_AreAsGoodAsZero) {
    // The other diagonal; and a mesh whose triangles come in another order, from other corners.
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

TEST(CertifiedHausdorff, CutsRunOut_LeavesWiderBoundsThatHold) {
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

TEST(CertifiedHausdorff, RandomSurfaces_HoldEverySample) {
    // No point of either surface may be farther from the other than the upper bound, none needs to reach the lower.
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        Random random(seed);
        const auto bumpy = [&](u32 frequency) {
            return with_positions(geodesic_sphere(1, frequency),
                                  [&](const Vec3& p) -> Vec3 { return p * random.uniform(0.9, 1.1); });
        };
        const TriangleMesh one = bumpy(5), other = bumpy(7);
        const CertifiedHausdorff found = bounds(one, other);
        MeasureParams params;
        params.samples = 50'000;
        const Measurement sampled = measured(one, other, params);
        EXPECT_TRUE(found.reached);
        EXPECT_LE(*sampled.hausdorff, found.upper);
        EXPECT_GE(*sampled.hausdorff, found.lower * 0.9);
        EXPECT_GE(found.upper, found.lower);
    }
}

TEST(CertifiedHausdorff, TwoWays_AreOne) {
    const TriangleMesh one = geodesic_sphere(1, 6), other = icosahedron(1.1);
    const CertifiedHausdorff there = bounds(one, other), back = bounds(other, one);
    EXPECT_LE(there.lower, back.upper);
    EXPECT_LE(back.lower, there.upper);
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
