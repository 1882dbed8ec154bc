// SPDX-License-Identifier: GPL-3.0-or-later
/// Samples on surfaces, and the statistics of distances.
#include <gmock/gmock.h>

#include <vector>

#include "filters/measure/cases.hpp"
#include "measure/sampled_distances.hpp"

namespace scanmill::test {
namespace {

using namespace measuring;

TEST(SurfaceSamples, EveryTriangle_GetsItsShareRoundedUpOrDown) {
    const TriangleMesh mesh = turned(torus(2, 0.7, 31, 17), 1, {1, 2, 3});
    const double whole = area(mesh);
    for (std::size_t count : {std::size_t(32), std::size_t(5000), std::size_t(100'000)}) {
        const SurfaceSamples samples = sample_surface(mesh, count, Random(5), 2);
        ASSERT_EQ(samples.triangles.size(), count);
        std::vector<std::size_t> taken(mesh.triangles.size(), 0);
        for (u32 row : samples.triangles) ++taken[row];
        for (u32 row = 0; row < taken.size(); ++row) {
            const double share =
                static_cast<double>(count) *
                area(soup({mesh.positions[mesh.triangles[row][0]], mesh.positions[mesh.triangles[row][1]],
                           mesh.positions[mesh.triangles[row][2]]},
                          {{0, 1, 2}})) /
                whole;
            EXPECT_GT(static_cast<double>(taken[row]), share - 1 - 1e-9);
            EXPECT_LT(static_cast<double>(taken[row]), share + 1 + 1e-9);
        }
    }
}

TEST(SurfaceSamples, WithinATriangle_TheyAreUniform) {
    // Barycentric weights of a uniform point have mean 1/3 and mean square 1/6.
    const TriangleMesh mesh = soup({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}});
    const std::size_t count = 100'000;
    const SurfaceSamples samples = sample_surface(mesh, count, Random(1), 1);
    Vec3 mean = Vec3::Zero(), square = Vec3::Zero();
    for (const Vec3& p : samples.positions) {
        EXPECT_NEAR(p.sum(), 1, 1e-15);
        EXPECT_GE(p.minCoeff(), -1e-16);
        mean += p / static_cast<double>(count);
        square += p.cwiseProduct(p) / static_cast<double>(count);
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(mean[axis], 1.0 / 3, 4 * std::sqrt(1.0 / 18 / static_cast<double>(count)));
        EXPECT_NEAR(square[axis], 1.0 / 6, 2e-3);
    }
}

TEST(SurfaceSamples, TrianglesWithoutArea_GetNone) {
    const TriangleMesh mesh =
        soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}}, {{0, 1, 3}, {0, 1, 2}, {0, 0, 1}, {1, 3, 0}});
    for (std::uint64_t seed = 0; seed < 50; ++seed)
        EXPECT_THAT(sample_surface(mesh, 40, Random(seed), 1).triangles, testing::Each(1u));
}

TEST(DistanceNumbers, Quantiles_AreByNearestRank) {
    std::vector<double> values;
    for (int i = 100; i > 0; --i) values.push_back(i);
    const DistanceNumbers numbers = numbers_of(values, std::vector<double>{100.5, 3});
    EXPECT_EQ(numbers.samples, 100u);
    EXPECT_EQ(numbers.p50, 50);
    EXPECT_EQ(numbers.p90, 90);
    EXPECT_EQ(numbers.p95, 95);
    EXPECT_EQ(numbers.p99, 99);
    EXPECT_EQ(numbers.max, 100.5);
    EXPECT_EQ(numbers.mean, 50.5);
    const DistanceNumbers one = numbers_of(std::vector<double>{7}, {});
    EXPECT_EQ(one.p50, 7);
    EXPECT_EQ(one.max, 7);
    EXPECT_EQ(one.mean_spread, 0);
}

TEST(DistanceNumbers, MeanSpread_IsThatOf32Batches) {
    // 64 values: batch i contains the value i twice, so the batch means are 0 … 31: their variance over 32.
    std::vector<double> values;
    for (int i = 0; i < 64; ++i) values.push_back(i % 32);
    EXPECT_NEAR(*numbers_of(values, {}).mean_spread, std::sqrt((32.0 * 32 - 1) / 12 * 32 / (32.0 * 31)), 1e-12);
    // 33 values: one batch contains two.
    values.assign(33, 1.0);
    EXPECT_EQ(numbers_of(values, {}).mean_spread, 0);
}

TEST(DistanceNumbers, ThresholdItself_IsWithin) {
    EXPECT_EQ(share_within(std::vector<double>{1, 2, 3, 4}, 2), 0.5);
    EXPECT_EQ(share_within(std::vector<double>{1, 2, 3, 4}, 1.99), 0.25);
}

TEST(CompensatedSum, SmallTerms_AreNotLost) {
    CompensatedSum sum;
    for (double term : {1.0, 1e100, 1.0, -1e100}) sum.add(term);
    EXPECT_EQ(sum.value(), 2);
    CompensatedSum tenths;
    for (int i = 0; i < 1'000'000; ++i) tenths.add(0.1);
    EXPECT_EQ(tenths.value(), 100'000);
}

}  // namespace
}  // namespace scanmill::test
