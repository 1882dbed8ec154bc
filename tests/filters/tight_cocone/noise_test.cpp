// SPDX-License-Identifier: GPL-3.0-or-later
/// The noise mode on a sphere and a torus with Gaussian noise of known deviation.

#include <gmock/gmock.h>

#include <array>

#include "filters/tight_cocone/cases.hpp"
#include "support/thrown.hpp"
#include "tight_cocone/big_balls.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

constexpr double pi = std::numbers::pi;
constexpr std::size_t count = 2900;

/// A shape of known distance to every point. The spacing is the distance that a Poisson-disc sample of as many points
/// keeps, which is 0.76 times the square root of the area per point.
struct Shape {
    const char* name;
    PointCloud cloud;
    double spacing;
    double (*height)(const Vec3&);  ///< above the surface
    long euler;
};

const std::array<Shape, 2>& shapes() {
    static const std::array<Shape, 2> both{
        {{"sphere", fibonacci_sphere(count, 1e-6), 0.76 * std::sqrt(4 * pi / count),
          [](const Vec3& p) { return p.norm() - 1; }, 2},
         {"torus", poisson_torus(0.0561, 0.4, 20000, 1, count), 0.0561,
          [](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()) - 0.4; }, 0}}};
    return both;
}

Array<u32> kept(const PointCloud& cloud, double factor = 1, u32 neighbours = 12) {
    ContextOptions options;
    options.threads = 2;
    Context context(options);
    return cocones::outer_points(tets_of(cloud, 2), neighbours, factor, context);
}

TEST(TightCoconeNoise, SharesOfKeptPoints_AreThoseOfTheDocumentation) {
    for (const Shape& shape : shapes()) {
        ASSERT_EQ(shape.cloud.positions.size(), count);
        for (const auto& [noise, percent] : {std::pair(0.1, 99.0), {0.3, 73.0}, {0.5, 55.0}, {1.0, 35.0}, {1.5, 25.0}})
            for (const std::uint64_t seed : {1, 2}) {
                const std::size_t number = kept(noisy(shape.cloud, noise * shape.spacing, seed)).size();
                EXPECT_NEAR(100.0 * static_cast<double>(number) / count, percent, 3) << shape.name << " at " << noise;
            }
    }
}

TEST(TightCoconeNoise, PointsWithoutNoise_AreAllKept) {
    for (const Shape& shape : shapes()) {
        const Array<u32> all = kept(shape.cloud);
        EXPECT_EQ(all.size(), count) << shape.name;
        EXPECT_TRUE(std::ranges::is_sorted(all));
        const TightCoconeResult result = closed_through(shape.cloud, with_big_balls());
        const TightCoconeResult plain = closed_through(shape.cloud);
        EXPECT_TRUE(std::ranges::equal(result.mesh.triangles, plain.mesh.triangles)) << shape.name;
    }
}

TEST(TightCoconeNoise, KeptPoints_LieOutsideByTheDocumentedBias) {
    for (const Shape& shape : shapes())
        for (const auto& [noise, bias, scatter] : {std::array{0.3, 0.4, 0.8}, {0.5, 0.65, 0.73}, {1.0, 1.05, 0.66}}) {
            const double deviation = noise * shape.spacing;
            const PointCloud cloud = noisy(shape.cloud, deviation);
            double sum = 0, squares = 0;
            const Array<u32> points = kept(cloud);
            for (const u32 v : points) {
                const double height = shape.height(cloud.positions[v]) / deviation;
                sum += height;
                squares += height * height;
            }
            const double number = static_cast<double>(points.size()), mean = sum / number;
            EXPECT_NEAR(mean, bias, 0.1) << shape.name << " at " << noise;
            EXPECT_NEAR(std::sqrt(squares / number - mean * mean), scatter, 0.07) << shape.name << " at " << noise;
        }
}

TEST(TightCoconeNoise, HalfASpacing_GivesAClosedSurfaceOfTheShapesTopologyNearIt) {
    for (const Shape& shape : shapes())
        for (const std::uint64_t seed : {1, 2}) {
            const double deviation = 0.5 * shape.spacing;
            const Outcome outcome = outcome_of(noisy(shape.cloud, deviation, seed), with_big_balls());
            SCOPED_TRACE(shape.name);
            ASSERT_TRUE(outcome.result) << outcome.refusal->what();
            expect_promised(*outcome.result, count);
            EXPECT_EQ(topology(outcome.result->mesh).euler, shape.euler);
            EXPECT_EQ(topology(outcome.result->mesh).components, 1u);
            // By area, at the middles of the triangles.
            const TriangleMesh& mesh = outcome.result->mesh;
            double sum = 0, bias = 0, whole = 0;
            for (const auto& [a, b, c] : mesh.triangles) {
                const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
                const double area = (q - p).cross(r - p).norm(), height = shape.height((p + q + r) / 3);
                sum += area * std::abs(height);
                bias += area * height;
                whole += area;
            }
            EXPECT_LT(sum / whole, deviation + 0.1 * shape.spacing);
            EXPECT_GT(bias / whole, 0);
            EXPECT_LT(bias / whole, deviation);
        }
}

TEST(TightCoconeNoise, FactorThatLetsTheOutsideIn_IsRefusedWithALargerOne) {
    for (const Shape& shape : shapes())
        for (const double noise : {0.3, 0.5, 1.0}) {
            const PointCloud cloud = noisy(shape.cloud, noise * shape.spacing);
            const Error error = error_of([&] { closed_through(cloud, with_big_balls(0.5)); });
            EXPECT_THAT(error.sentence(), HasSubstr("noise-factor 0.5")) << shape.name << " at " << noise;
            EXPECT_THAT(error.sentence(), HasSubstr("entered the object"));
            // A larger factor than the one refused.
            EXPECT_THAT(error.hint(), HasSubstr("0.75"));
        }
}

TEST(TightCoconeNoise, ParametersOutOfRange_AreRefused) {
    TightCoconeParams params = with_big_balls();
    params.noise_neighbours = 0;
    const PointCloud cloud = fibonacci_sphere(100);
    const std::string neighbours = sentence_of([&] { closed_through(cloud, params); });
    EXPECT_THAT(neighbours,
                testing::AllOf(HasSubstr("noise-neighbours"), HasSubstr("from 1 to 1000"), HasSubstr("is 0")));
    for (const double factor : {0.0, -1.0, std::nan("")})
        EXPECT_THAT(sentence_of([&] { closed_through(cloud, with_big_balls(factor)); }),
                    testing::AllOf(HasSubstr("noise-factor"), HasSubstr("above 0")));
}

TEST(TightCoconeNoise, MoreNeighboursThanPoints_ComparesWithTheFarthest) {
    TightCoconeParams params = with_big_balls();
    params.noise_neighbours = 1000;
    // No ball of a sphere's points is larger than the distance to the farthest of them, about 2.
    const Error error = error_of([&] { closed_through(fibonacci_sphere(300, 1e-6), params); });
    EXPECT_THAT(error.sentence(), testing::AllOf(HasSubstr("none of"), HasSubstr("is large")));
    EXPECT_THAT(error.hint(), testing::AllOf(HasSubstr("noise-neighbours"), HasSubstr("smaller noise-factor")));
    // But the balls at the centre are larger than 0.45 times this distance.
    EXPECT_EQ(kept(fibonacci_sphere(300, 1e-6), 0.45, 1000).size(), 300u);
}

TEST(TightCoconeNoise, Result_DoesNotDependOnTheNumberOfThreads) {
    const PointCloud cloud = noisy(shapes()[1].cloud, 0.5 * shapes()[1].spacing);
    const TightCoconeResult one = closed_through(cloud, with_big_balls(), 1),
                            two = closed_through(cloud, with_big_balls(), 2);
    EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles));
    EXPECT_TRUE(std::ranges::equal(one.mesh.positions, two.mesh.positions));
    EXPECT_TRUE(std::ranges::equal(one.tets.inside, two.tets.inside));
    EXPECT_TRUE(std::ranges::equal(one.tets.cells, two.tets.cells));
}

}  // namespace
}  // namespace scanmill
