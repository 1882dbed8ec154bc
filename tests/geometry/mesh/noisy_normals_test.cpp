// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/noisy_normals.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <numbers>
#include <numeric>
#include <random>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "support/mesh_operations.hpp"
#include "support/numbers.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

Execution with_threads(unsigned threads) {
    ExecutionOptions options;
    options.threads = threads;
    return Execution(options);
}

double noise_of(const TriangleMesh& mesh, unsigned threads = 1) {
    return vertex_noise(mesh, half_edges::opposites(mesh), with_threads(threads));
}

NoisyNormals normals_of(const TriangleMesh& mesh, double noise, double degrees = 40, unsigned threads = 1) {
    const Array<u32> opposite = half_edges::opposites(mesh);
    const FacetNormals own = facet_normals(mesh, opposite, 1);
    return noisy_normals(mesh, opposite, own.unit, noise, degrees * degree, with_threads(threads));
}

/// A square of `size` edges of length 1 each way, with its lower corner at the origin, over which height(x, y) stands.
template <class Height>
TriangleMesh sheet(u32 size, Height&& height) {
    TriangleMesh mesh;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 y = 0; y <= size; ++y)
        for (u32 x = 0; x <= size; ++x) positions.emplace_back(x, y, height(double(x), double(y)));
    for (u32 y = 0; y < size; ++y)
        for (u32 x = 0; x < size; ++x) {
            const u32 a = y * (size + 1) + x, b = a + 1, c = a + size + 1, d = c + 1;
            triangles.push_back({a, b, d});
            triangles.push_back({a, d, c});
        }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

TriangleMesh plane(u32 size) {
    return sheet(size, [](double, double) { return 0.0; });
}

/// Two planes that meet at x = size / 2, where the normal turns by `degrees`.
TriangleMesh roof(u32 size, double degrees) {
    const double slope = std::tan(degrees / 2 * degree), middle = size / 2;
    return sheet(size, [=](double x, double) { return -slope * std::abs(x - middle); });
}

/// In each coordinate.
TriangleMesh with_noise(const TriangleMesh& mesh, double noise) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal(0, noise);
    return with_positions(mesh, [&](const Vec3& p) {
        const double x = normal(random), y = normal(random), z = normal(random);
        return Vec3(p + Vec3(x, y, z));
    });
}

/// The largest angle, in degrees, between the normals of triangles that share an edge.
double largest_angle(const TriangleMesh& mesh, std::span<const Vec3> normals) {
    const Array<u32> opposite = half_edges::opposites(mesh);
    double largest = 0;
    for (u32 h = 0; h < opposite.size(); ++h)
        if (opposite[h] < half_edges::no_half_edge)
            largest = std::max(largest, angle_between(normals[h / 3], normals[opposite[h] / 3]));
    return largest / degree;
}

TEST(VertexNoise, OfAPlaneWithNoise_IsItsStandardDeviation) {
    for (const double noise : {0.001, 0.05, 0.2})
        EXPECT_NEAR(noise_of(with_noise(plane(60), noise)) / noise, 1, 0.1) << noise;
}

TEST(VertexNoise, OfARoofAndASphereWithNoise_IsItsStandardDeviation) {
    EXPECT_NEAR(noise_of(with_noise(roof(60, 90), 0.1)) / 0.1, 1, 0.2);
    const TriangleMesh sphere = geodesic_sphere(30, 30);  // edges of about 1
    EXPECT_NEAR(noise_of(with_noise(sphere, 0.1)) / 0.1, 1, 0.2);
}

TEST(VertexNoise, OfCleanMeshes_IsZero) {
    EXPECT_EQ(noise_of(cube()), 0);
    EXPECT_EQ(noise_of(icosahedron()), 0);
    EXPECT_EQ(noise_of(l_block()), 0);
    EXPECT_EQ(noise_of(torus(3, 1, 12, 6)), 0);
    EXPECT_EQ(noise_of(roof(20, 90)), 0);
    EXPECT_EQ(noise_of(plane(20)), 0);
    EXPECT_EQ(noise_of(geodesic_sphere(1, 10)), 0) << "all edges are convex";
}

TEST(VertexNoise, OfWavesThatTheMeshResolves_IsZero_HoweverSteep) {
    // As many convex edges as concave ones; six edges per wave.
    const TriangleMesh waves = sheet(60, [](double x, double y) {
        return 0.8 * std::sin(std::numbers::pi / 3 * x + 0.1) * std::sin(std::numbers::pi / 3 * y + 0.2);
    });
    EXPECT_EQ(noise_of(waves), 0);
}

TEST(VertexNoise, ScalesWithTheMesh_AndDoesNotDependOnThreadsOrOrder) {
    const TriangleMesh mesh = with_noise(roof(70, 60), 0.1);
    const double noise = noise_of(mesh);
    EXPECT_GT(noise, 0);
    EXPECT_EQ(noise_of(scaled(mesh, 8)), 8 * noise);
    EXPECT_EQ(noise_of(mesh, 4), noise);
    EXPECT_NEAR(noise_of(inside_out(mesh)), noise, 1e-3 * noise);
    TriangleMesh reordered = mesh;
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    std::ranges::reverse(triangles);
    for (Triangle& t : triangles) t = {t[1], t[2], t[0]};
    reordered.triangles = std::move(triangles);
    EXPECT_EQ(noise_of(reordered), noise);
}

TEST(NoisyNormals, WithoutNoise_AreTheTriangles) {
    const TriangleMesh mesh = with_noise(plane(10), 0.3);
    const NoisyNormals normals = normals_of(mesh, 0);
    EXPECT_EQ(normals.unreliable, 0u);
    const FacetNormals own = facet_normals(mesh, half_edges::opposites(mesh), 1);
    EXPECT_TRUE(std::ranges::equal(normals.unit, own.unit));
}

TEST(NoisyNormals, OfTrianglesThatAreLargeForTheNoise_StayAsTheyAre) {
    const TriangleMesh mesh = with_noise(roof(20, 90), 0.01);
    EXPECT_EQ(normals_of(mesh, 0.01).unreliable, 0u);
    EXPECT_GT(normals_of(mesh, 0.01, 1).unreliable, 0u) << "for an angle of 1 degree they are too small";
}

TEST(NoisyNormals, OfAPlane_AreNearlyItsNormal) {
    const TriangleMesh mesh = with_noise(plane(40), 0.2);
    const FacetNormals own = facet_normals(mesh, half_edges::opposites(mesh), 1);
    EXPECT_GT(largest_angle(mesh, own.unit), 60);
    const NoisyNormals normals = normals_of(mesh, 0.2);
    EXPECT_GT(normals.unreliable, mesh.triangles.size() / 2);
    EXPECT_LT(largest_angle(mesh, normals.unit), 40);
    double sum = 0;
    for (const Vec3& n : normals.unit) sum += std::pow(angle_between(n, Vec3::UnitZ()) / degree, 2);
    EXPECT_LT(std::sqrt(sum / double(normals.unit.size())), 8);
}

TEST(NoisyNormals, AtARoof_AreThoseOfItsSides_NotRounded) {
    for (const double turn : {60.0, 90.0}) {
        const TriangleMesh mesh = with_noise(roof(40, turn), 0.15);
        const NoisyNormals normals = normals_of(mesh, 0.15);
        const double half = turn / 2 * degree;
        const Vec3 left(-std::sin(half), 0, std::cos(half)), right(std::sin(half), 0, std::cos(half));
        std::size_t wrong = 0, between = 0, beside = 0;
        for (u32 t = 0; t < mesh.triangles.size(); ++t) {
            double x = 0;
            for (const u32 v : mesh.triangles[t]) x += mesh.positions[v].x() / 3;
            const double from_left = angle_between(normals.unit[t], left) / degree,
                         from_right = angle_between(normals.unit[t], right) / degree;
            if (std::abs(x - 20) < 1.5) {
                ++beside;
                between += std::min(from_left, from_right) > turn / 4;
            } else if (std::abs(x - 20) > 4) {
                wrong += (x < 20 ? from_left : from_right) > turn / 3;
            }
        }
        EXPECT_LT(100 * wrong, mesh.triangles.size()) << turn;
        EXPECT_LT(10 * between, beside) << turn << ": beside the ridge normals belong to one side";
    }
}

TEST(NoisyNormals, DoNotDependOnThreadsOrOrder) {
    const TriangleMesh mesh = with_noise(roof(100, 90), 0.2);
    const NoisyNormals one = normals_of(mesh, 0.2), four = normals_of(mesh, 0.2, 40, 4);
    EXPECT_TRUE(std::ranges::equal(one.unit, four.unit));
    TriangleMesh reordered = mesh;
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    std::ranges::reverse(triangles);
    for (Triangle& t : triangles) t = {t[2], t[0], t[1]};
    reordered.triangles = std::move(triangles);
    NoisyNormals reversed = normals_of(reordered, 0.2);
    std::ranges::reverse(reversed.unit);
    EXPECT_TRUE(std::ranges::equal(one.unit, reversed.unit));
}

TEST(NoisyNormals, Cancelled_End) {
    const TriangleMesh mesh = with_noise(plane(40), 0.2);
    const Array<u32> opposite = half_edges::opposites(mesh);
    const FacetNormals own = facet_normals(mesh, opposite, 1);
    ExecutionOptions options;
    options.is_cancelled = [] { return true; };
    const Execution execution(options);
    EXPECT_THROW(vertex_noise(mesh, opposite, execution), Cancelled);
    EXPECT_THROW(noisy_normals(mesh, opposite, own.unit, 0.2, 40 * degree, execution), Cancelled);
}

TEST(NoisyNormals, OfSmallMeshesAndSmallAngles_AreOfUnitLength) {
    for (const TriangleMesh& mesh : {cube(), regular_tetrahedron(), icosahedron(), plane(2)})
        for (const double degrees : {0.0, 1.0, 40.0, 180.0})
            for (const double noise : {1e-3, 1.0, 1e3})
                for (const Vec3& normal : normals_of(mesh, noise, degrees).unit)
                    EXPECT_NEAR(normal.norm(), 1, 1e-12) << degrees << ' ' << noise;
}

}  // namespace
}  // namespace scanmill
