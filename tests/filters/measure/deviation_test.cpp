// SPDX-License-Identifier: GPL-3.0-or-later
/// The distance of every vertex from the truth, with its sign.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "filters/measure/cases.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill::test {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;

template <class Truth>
Array<double> distances(const TriangleMesh& mesh, const Truth& truth, MeasureParams params = few_samples()) {
    params.same_frame = true;
    params.self_intersections = false;
    const TriangleMesh result = deviation_of(mesh, measured(mesh, truth, params));
    const auto values = result.vertex_columns.find("distance-to-truth")->template values<double>();
    return Array<double>(values.begin(), values.end());
}

/// A mesh with vertices at these points, by triangles over any three of them.
TriangleMesh mesh_at(Array<Vec3> points) {
    Array<Triangle> triangles;
    for (u32 i = 0; i < points.size(); ++i) {
        const u32 count = static_cast<u32>(points.size());
        triangles.push_back({i, (i + 1) % count, (i + 2) % count});
    }
    return soup(std::move(points), std::move(triangles));
}

TEST(MeasureDeviation, OfACube_IsNegativeInside) {
    const TriangleMesh mesh = mesh_at({{0.5, 0.5, 0.5}, {0.5, 0.5, 0.75}, {2, 0.5, 0.5}, {0.25, 0.5, -0.125}});
    EXPECT_THAT(distances(mesh, cube()), ElementsAre(-0.5, -0.25, 1, 0.125));
}

TEST(MeasureDeviation, NearEdgesAndCorners_HasTheirDistance) {
    const TriangleMesh mesh = mesh_at({{1.5, 1.5, 0.5}, {2, 2, 2}, {0.875, 0.9375, 0.5}, {0.75, 0.875, 0.9375}});
    EXPECT_THAT(distances(mesh, cube()),
                Pointwise(DoubleNear(1e-15), {std::sqrt(0.5), std::sqrt(3.0), -0.0625, -0.0625}));
}

TEST(MeasureDeviation, OnTheSurface_IsExactlyZeroWithoutASign) {
    for (const TriangleMesh& truth : {cube(), inside_out(cube())})
        for (const double distance :
             distances(mesh_at({{0, 0, 0}, {1, 0.5, 0.5}, {0.5, 0, 0}, {0.25, 0.75, 1}, {1, 1, 0.3}}), truth)) {
            EXPECT_EQ(distance, 0);
            EXPECT_FALSE(std::signbit(distance));
        }
    const TriangleMesh sphere = turned(geodesic_sphere(3, 9), 0.7, {1, 2, 3});
    EXPECT_THAT(distances(sphere, sphere), testing::Each(0.0));
}

/// Beyond the sharp edge of a blade the nearest triangle's own normal points away from half of all points, and those of
/// both triangles almost cancel each other out.
TEST(MeasureDeviation, BeyondASharpEdge_IsPositive) {
    const double thin = 1e-3;
    const TriangleMesh blade =
        soup({{0, 0, 0}, {0, 1, 0}, {-1, 0, thin}, {-1, 1, thin}, {-1, 0, -thin}, {-1, 1, -thin}},
             {{0, 1, 3}, {0, 3, 2}, {0, 5, 1}, {0, 4, 5}, {0, 2, 4}, {1, 5, 3}, {2, 3, 5}, {2, 5, 4}});
    ASSERT_GT(signed_volume(blade), 0);
    const TriangleMesh mesh =
        mesh_at({{0.5, 0.5, 0.1}, {0.5, 0.5, -0.1}, {0.5, 0.5, 0}, {0.1, 0.2, 0}, {-0.5, 0.5, 0}, {0.1, -0.1, 1e-4}});
    const Array<double> found = distances(mesh, blade);
    EXPECT_DOUBLE_EQ(found[0], std::sqrt(0.26));
    EXPECT_DOUBLE_EQ(found[1], std::sqrt(0.26));
    EXPECT_DOUBLE_EQ(found[2], 0.5);
    EXPECT_DOUBLE_EQ(found[3], 0.1);
    EXPECT_NEAR(found[4], -0.5 * thin / std::sqrt(1 + thin * thin), 1e-15);
    EXPECT_GT(found[5], 0.14);
}

TEST(MeasureDeviation, OfConcentricSpheres_IsTheDifferenceOfRadii) {
    const TriangleMesh truth = geodesic_sphere(1, 40);
    const double sagitta = 1 - std::cos(std::atan(2.0) / 40 * 0.8);
    for (const double radius : {0.5, 0.9, 1.1, 1.5})
        for (const double distance : distances(geodesic_sphere(radius, 7), truth)) {
            EXPECT_GE(distance, radius - 1 - 1e-12);
            EXPECT_LE(distance, radius - 1 + sagitta);
        }
}

TEST(MeasureDeviation, OfATruthInsideOut_IsTheSame) {
    const TriangleMesh mesh = turned(scaled(torus(2, 0.6, 21, 9), 0.9), 0.1, {1, 2, 3}), truth = torus(2, 0.6, 33, 17);
    const Array<double> found = distances(mesh, truth);
    EXPECT_LT(*std::ranges::min_element(found), -0.01);
    EXPECT_GT(*std::ranges::max_element(found), 0.01);
    EXPECT_THAT(distances(mesh, inside_out(truth)), Pointwise(DoubleNear(1e-14), found));
}

TEST(MeasureDeviation, OfATruthThatIsNotClosed_HasNoSign) {
    const TriangleMesh mesh = mesh_at({{0.5, 0.5, 0.5}, {0.25, 0.5, 0.5}, {2, 0.5, 0.5}, {0.5, 0.5, 0.125}});
    EXPECT_THAT(distances(mesh, without_triangles(cube(), {3})), testing::Each(testing::Ge(0)));
    EXPECT_THAT(distances(mesh, rectangle(1, 1)), ElementsAre(0.5, 0.5, std::sqrt(1.25), 0.125));
}

TEST(MeasureDeviation, OfPoints_IsTheDistanceToTheNearest) {
    const TriangleMesh mesh = mesh_at({{0.5, 0.5, 0.5}, {0, 0, 0}, {2, 1, 1}, {0.25, 0, 0}});
    EXPECT_THAT(distances(mesh, vertices_of(cube())), ElementsAre(std::sqrt(0.75), 0, 1, 0.25));
}

TEST(MeasureDeviation, VerticesInNoTriangle_HaveADistanceToo) {
    const TriangleMesh mesh =
        soup({{0.5, 0.5, 0.75}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 3}, {1, 1, 1}}, {{1, 2, 3}});
    EXPECT_THAT(distances(mesh, cube()), ElementsAre(-0.25, 0, 0, 0, 2, 0));
    EXPECT_THAT(distances(mesh, cloud_of({{0.5, 0.5, 1}})),
                ElementsAre(0.25, std::sqrt(1.5), std::sqrt(1.5), std::sqrt(1.5), 2, std::sqrt(0.5)));
}

/// The nearest of all triangles, and the sign by the solid angle of all of them.
double brute_force(const Vec3& point, const TriangleMesh& truth) {
    double least = std::numeric_limits<double>::infinity(), angle = 0;
    for (const auto& [i, j, k] : truth.triangles) {
        const Vec3 a = truth.positions[i] - point, b = truth.positions[j] - point, c = truth.positions[k] - point;
        least = std::min(least, nearest_on_triangle(Vec3::Zero(), a, b, c).norm());
        angle += std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                   b.dot(c) * a.norm() + c.dot(a) * b.norm());
    }
    return std::abs(angle) > std::numbers::pi ? -least : least;
}

TEST(MeasureDeviation, OfRandomSurfaces_AgreesWithBruteForce) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        Random random(seed);
        const auto bumpy = [&](u32 frequency) {
            return shifted(scaled(with_positions(geodesic_sphere(1, frequency),
                                                 [&](const Vec3& p) -> Vec3 { return p * random.uniform(0.7, 1.2); }),
                                  0.37),
                           {random.uniform(), 1000, -3});
        };
        const TriangleMesh truth = bumpy(6), mesh = shifted(truth, {0.05, 0.02, 0});
        const Array<double> found = distances(mesh, truth);
        std::size_t inside = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_NEAR(found[i], brute_force(mesh.positions[i], truth), 1e-12) << seed << ' ' << i;
            inside += found[i] < 0;
        }
        EXPECT_GT(inside, 50u);
        EXPECT_LT(inside, found.size() - 50);
    }
}

TEST(MeasureDeviation, Mesh_KeepsItsColumnsAndFrame) {
    TriangleMesh mesh = mesh_at({{0.5, 0.5, 0.5}, {2, 0.5, 0.5}, {0, 0, 0}});
    mesh.frame.unit = LengthUnit::millimetre;
    mesh.frame.name = "part";
    mesh.vertex_columns.add(Column("weight", 1, Buffer<double>{1, 2, 3}));
    mesh.vertex_columns.add(Column("distance-to-truth", 1, Buffer<float>{7, 7, 7}));
    mesh.face_columns.add(Column("class", 1, Buffer<u8>{4, 5, 6}));
    mesh.sharp_edges = {{0, 1}};
    const TriangleMesh result = deviation_of(mesh, measured(mesh, cube(), few_samples()));
    EXPECT_EQ(result.positions.data(), mesh.positions.data());
    EXPECT_EQ(result.triangles.data(), mesh.triangles.data());
    EXPECT_EQ(result.sharp_edges.data(), mesh.sharp_edges.data());
    EXPECT_EQ(result.face_columns, mesh.face_columns);
    EXPECT_EQ(result.frame.name, "part");
    ASSERT_EQ(result.vertex_columns.size(), 2u);
    EXPECT_EQ(*result.vertex_columns.find("weight"), *mesh.vertex_columns.find("weight"));
    const Column& column = *result.vertex_columns.find("distance-to-truth");
    EXPECT_EQ(column.length_exponent(), 1);
    EXPECT_THAT(column.values<double>(), ElementsAre(-0.5, 1, 0));
}

TEST(MeasureDeviation, TruthOfAnotherUnit_IsConverted) {
    TriangleMesh mesh = mesh_at({{0.5, 0.5, 0.5}, {2, 0.5, 0.5}, {0, 0, 0}}), truth = scaled(cube(), 1.0 / 1024);
    mesh.frame.unit = LengthUnit::millimetre;
    truth.frame.unit = LengthUnit::metre;
    truth = scaled(truth, 1.024);
    EXPECT_THAT(distances(mesh, truth), Pointwise(DoubleNear(1e-12), {-0.5, 1.0, 0.0}));
}

TEST(MeasureDeviation, AnyNumberOfThreads_GivesTheSame) {
    const TriangleMesh mesh = geodesic_sphere(1.01, 30), truth = shifted(geodesic_sphere(1, 25), {0.02, 0, 0});
    EXPECT_EQ(measured(mesh, truth, few_samples(), 3).vertex_distances,
              measured(mesh, truth, few_samples(), 1).vertex_distances);
}

}  // namespace
}  // namespace scanmill::test
