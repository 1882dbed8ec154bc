// SPDX-License-Identifier: GPL-3.0-or-later
/// Hits of rays: by hand, ties, and against a search over all items.

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "render/ray_caster.hpp"
#include "scanmill/base/random.hpp"
#include "support/numbers.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;

const Array<Vec3> corners{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
const Array<Triangle> one_triangle{{0, 1, 2}};

TEST(RayCaster, OneTriangle_DistanceAndWeightsByHand) {
    const RayCaster caster(corners, one_triangle, {}, 1);
    const RayHit hit = caster.first({{0.5, 0.25, 3}, {0, 0, -1}});
    ASSERT_TRUE(hit.found());
    EXPECT_EQ(hit.item, 0u);
    EXPECT_EQ(hit.distance, 3);
    EXPECT_EQ(hit.weights, (std::array<double, 3>{0.625, 0.25, 0.125}));
    EXPECT_FALSE(caster.first({{1.5, 1.5, 3}, {0, 0, -1}}).found());
    EXPECT_FALSE(caster.first({{0.5, 0.25, 3}, {0, 0, 1}}).found()) << "the triangle is behind";
    EXPECT_FALSE(caster.first({{0.5, 0.25, 3}, {0, 0, -1}, 3.5}).found()) << "nearer than `from`";
    EXPECT_TRUE(caster.is_blocked({{0.5, 0.25, 3}, {0, 0, -1}}, 3.001));
    EXPECT_FALSE(caster.is_blocked({{0.5, 0.25, 3}, {0, 0, -1}}, 3));
    EXPECT_TRUE(caster.faces(0, {{0, 0, 1}, {0, 0, -1}}));
    EXPECT_FALSE(caster.faces(0, {{0, 0, -1}, {0, 0, 1}}));
}

TEST(RayCaster, RayThroughEdgeOrCorner_HitsLowerRowOfEquallyNearTriangles) {
    const Array<Vec3> positions{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    const Array<Triangle> triangles{{0, 2, 3}, {0, 1, 2}, {0, 1, 2}};
    const RayCaster caster(positions, triangles, {}, 1);
    EXPECT_EQ(caster.first({{1, 1, 5}, {0, 0, -1}}).item, 0u) << "on the diagonal";
    EXPECT_EQ(caster.first({{0, 0, 5}, {0, 0, -1}}).item, 0u) << "at the corner";
    EXPECT_EQ(caster.first({{1.5, 0.5, 5}, {0, 0, -1}}).item, 1u) << "a triangle that is there twice";
}

TEST(RayCaster, TriangleTwiceInEitherOrientation_LowerRowIsHit) {
    Random random(2);
    for (int i = 0; i < 200; ++i) {
        const auto number = [&] { return random.uniform(-1, 1); };
        const Array<Vec3> positions{
            {number(), number(), number()}, {number(), number(), number()}, {number(), number(), number()}};
        const Array<Triangle> triangles{{0, 2, 1}, {0, 1, 2}, {1, 2, 0}, {2, 1, 0}};
        const RayCaster caster(positions, triangles, {}, 1);
        const Vec3 middle = (positions[0] + positions[1] + positions[2]) / 3;
        EXPECT_EQ(caster.first({Vec3(0, 0, 9), (middle - Vec3(0, 0, 9)).normalized()}).item, 0u);
    }
}

TEST(RayCaster, TriangleWithoutArea_IsNeverHit) {
    const Array<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, -1}, {1, 0, -1}, {0, 1, -1}};
    const Array<Triangle> triangles{{0, 1, 2}, {0, 1, 1}, {3, 4, 5}};
    const RayCaster caster(positions, triangles, {}, 1);
    const RayHit hit = caster.first({{0.25, 0, 5}, {0, 0, -1}});
    EXPECT_EQ(hit.item, 2u);
    EXPECT_EQ(hit.distance, 6);
}

TEST(RayCaster, Disc_FacesItsNormalOrTheRay) {
    const std::vector<Disc> discs{{{0, 0, 0}, Vec3::Zero(), 1}, {{5, 0, 0}, Vec3(1, 0, 1).normalized(), 1}};
    const RayCaster caster({}, {}, discs, 1);
    EXPECT_EQ(caster.first({{0, 0, 4}, {0, 0, -1}}).distance, 4);
    EXPECT_EQ(caster.first({{1, 0, 4}, {0, 0, -1}}).distance, 4) << "the rim counts";
    EXPECT_FALSE(caster.first({{1.01, 0, 4}, {0, 0, -1}}).found());
    const RayHit oblique = caster.first({{5.5, 0, 4}, {0, 0, -1}});
    ASSERT_TRUE(oblique.found());
    EXPECT_EQ(oblique.item, 1u);
    EXPECT_NEAR(oblique.distance, 4.5, 1e-15);
    EXPECT_FALSE(caster.first({{5.8, 0, 4}, {0, 0, -1}}).found()) << "the disc is seen obliquely";
    EXPECT_TRUE(caster.faces(1, {{}, {0, 0, -1}}));
    EXPECT_FALSE(caster.faces(1, {{}, {0, 0, 1}}));
}

TEST(RayCaster, NothingToHit_Refused) {
    const Error error = error_of([] { RayCaster({}, {}, {}, 1); });
    EXPECT_FALSE(error.hint().empty());
}

/// The search over all items, by the same arithmetic.
RayHit first_of_all(const Ray& ray, std::span<const Vec3> positions, std::span<const Triangle> triangles,
                    std::span<const Disc> discs) {
    RayHit best;
    for (std::size_t i = 0; i < triangles.size() + discs.size(); ++i) {
        RayHit hit;
        if (i < triangles.size()) {
            const auto& [a, b, c] = triangles[i];
            hit = hit_triangle(ray, positions[a], positions[b], positions[c]);
        } else {
            hit = hit_disc(ray, discs[i - triangles.size()]);
        }
        if (!hit.found() || !(hit.distance < best.distance)) continue;
        best = hit;
        best.item = static_cast<u32>(i);
    }
    return best;
}

struct Scene {
    TriangleMesh mesh = geodesic_sphere(3, 12);
    std::vector<Disc> discs;
    std::vector<Ray> rays;

    /// Far from zero and of an odd size. Half of the rays aim at vertices and at the middles of edges.
    Scene() {
        Random random(7);
        const Vec3 shift(1000.1, -2000.3, 500.7);
        Array<Vec3> positions;
        for (const Vec3& position : mesh.positions) positions.push_back(0.37 * position + shift);
        mesh.positions = std::move(positions);
        const auto number = [&] { return 2 * random.uniform() - 1; };
        for (int i = 0; i < 200; ++i)
            discs.push_back(
                {shift + Vec3(number(), number(), number()), Vec3(number(), number(), number()).normalized(), 0.1});
        for (u32 i = 0; i < 3000; ++i) {
            const Vec3 origin = shift + 4 * Vec3(number(), number(), number());
            Vec3 target = shift + Vec3(number(), number(), number());
            const Triangle& triangle = mesh.triangles[i % mesh.triangles.size()];
            if (i % 4 == 0) target = mesh.positions[triangle[0]];
            if (i % 4 == 1) target = (mesh.positions[triangle[0]] + mesh.positions[triangle[1]]) / 2;
            rays.push_back({origin, (target - origin).normalized()});
        }
    }
};

TEST(RayCaster, Hits_AreThoseOfASearchOverAllItems) {
    const Scene scene;
    const RayCaster caster(scene.mesh.positions.span(), scene.mesh.triangles.span(), scene.discs, 2);
    std::size_t hits = 0;
    for (const Ray& ray : scene.rays) {
        const RayHit expected =
            first_of_all(ray, scene.mesh.positions.span(), scene.mesh.triangles.span(), scene.discs);
        const RayHit found = caster.first(ray);
        ASSERT_EQ(found.item, expected.item);
        ASSERT_EQ(found.distance, expected.distance);
        ASSERT_EQ(caster.is_blocked(ray, 2), expected.found() && expected.distance < 2);
        hits += found.found();
    }
    EXPECT_GT(hits, scene.rays.size() / 2);
}

TEST(RayCaster, RaysThroughEdgesAndVerticesOfAClosedMesh_NeverPass) {
    const Scene scene;
    const RayCaster caster(scene.mesh.positions.span(), scene.mesh.triangles.span(), {}, 2);
    const Vec3 middle(1000.1, -2000.3, 500.7);
    Random random(11);
    for (int i = 0; i < 20'000; ++i) {
        const Triangle& triangle = scene.mesh.triangles[random.index(scene.mesh.triangles.size())];
        const Vec3 &a = scene.mesh.positions[triangle[0]], &b = scene.mesh.positions[triangle[1]];
        const double share = i % 3 == 0 ? 0 : random.uniform();  // a vertex, or a point of an edge
        const Vec3 target = a + share * (b - a);
        // From outside, within 60 degrees of the direction away from the middle.
        const Vec3 away = (target - middle).normalized();
        const Vec3 aside = Vec3(random.normal(), random.normal(), random.normal()).cross(away).normalized();
        const Vec3 origin = target + 2 * (away + random.uniform(0, 1.7) * aside);
        EXPECT_TRUE(caster.first({origin, (target - origin).normalized()}).found());
    }
}

TEST(RayCaster, InstructionSetsAndThreads_GiveEqualHits) {
    const Scene scene;
    const RayCaster usual(scene.mesh.positions.span(), scene.mesh.triangles.span(), scene.discs, 1);
    for (const char* set : {"sse2", "sse4.2", "avx", "avx2"}) {
        if (std::string(set) == "avx2" && !__builtin_cpu_supports("avx2")) GTEST_SKIP() << "no AVX2";
        const RayCaster other(scene.mesh.positions.span(), scene.mesh.triangles.span(), scene.discs, 8, set);
        for (const Ray& ray : scene.rays) {
            ASSERT_EQ(usual.first(ray).item, other.first(ray).item) << set;
            ASSERT_EQ(usual.first(ray).distance, other.first(ray).distance) << set;
        }
    }
}

}  // namespace
}  // namespace scanmill
