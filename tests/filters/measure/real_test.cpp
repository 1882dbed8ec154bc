// SPDX-License-Identifier: GPL-3.0-or-later
/// measure on real scans.
#include <gtest/gtest.h>

#include "filters/measure/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

void expect_zero_of_itself(const std::filesystem::path& path) {
    const auto mesh = read_mesh(path);
    MeasureParams params = certified();
    params.samples = 300'000;
    const Measurement result = measured(*mesh, *mesh, params);
    EXPECT_EQ(result.both.max, 0);
    EXPECT_EQ(result.both.rms, 0);
    EXPECT_EQ(result.certified->upper, 0);
}

TEST(MeasureOfRealScan, AgainstItself_IsExactlyZero) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/elephant.off");
    expect_zero_of_itself(path);
}

TEST(MeasureOfRealScan, PartOfSlimTrianglesAgainstItself_IsExactlyZero) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/anchor.off");
    expect_zero_of_itself(path);
}

/// Against the model decimated by vertex clustering, with cells of one 40th of its diagonal.
void expect_near_certified(const std::filesystem::path& path) {
    const auto truth = read_mesh(path);
    const TriangleMesh mesh = clustered(*truth, bounding_box(truth->positions.span()).diagonal() / 40);
    MeasureParams params = certified();
    params.samples = MeasureParams().samples;
    const Measurement exact = measured(mesh, *truth, params);
    EXPECT_GE(*exact.hausdorff, exact.certified->lower);
    params.certify = false;
    const Measurement found = measured(mesh, *truth, params);
    EXPECT_GE(*found.hausdorff, 0.98 * exact.certified->lower);
    EXPECT_LE(*found.hausdorff, exact.certified->upper);
}

TEST(MeasureOfRealScan, ClusteredElephant_HasAHausdorffDistanceNearTheCertifiedOne) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/elephant.off");
    expect_near_certified(path);
}

TEST(MeasureOfRealScan, ClusteredHand_HasAHausdorffDistanceNearTheCertifiedOne) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/hand.off");
    expect_near_certified(path);
}

TEST(MeasureOfRealScan, CoarseDragonAgainstTheFineOne_LiesWithinCertifiedBounds) {
    SCANMILL_REAL_SCAN(coarse, fetched_data, "dragon/dragon_vrip_res4.ply");
    SCANMILL_REAL_SCAN(fine, fetched_data, "dragon/dragon_vrip_res3.ply");
    const auto mesh = read_mesh(coarse), truth = read_mesh(fine);
    MeasureParams params = certified();
    params.samples = 100'000;
    const Measurement result = measured(*mesh, *truth, params);
    EXPECT_TRUE(result.certified->reached);
    EXPECT_LE(*result.hausdorff, result.certified->upper);
    EXPECT_LE(result.certified->lower, result.certified->upper);
    EXPECT_LE(result.certified->upper - result.certified->lower, 0.01 * result.certified->upper * (1 + 1e-9));
    // Two meshes of one scan: the mean is far below the edges of the coarse one, and normals agree.
    EXPECT_LT(result.both.mean, 0.005 * bounding_box(truth->positions.span()).diagonal());
    EXPECT_GT(*result.normal_consistency, 0.8);
    EXPECT_LE(result.to_truth->p50, result.to_truth->p90);
    EXPECT_LE(result.to_truth->p90, result.to_truth->p99);
    EXPECT_LE(result.to_truth->p99, result.to_truth->max);
}

TEST(MeasureOfRealScan, AgainstItsOwnPoints_IsExactlyZeroFromThem) {
    SCANMILL_REAL_SCAN(path, fetched_data, "dragon/dragon_vrip_res3.ply");
    const auto mesh = read_mesh(path);
    const Measurement result = measured(*mesh, vertices_of(without_unused_vertices(*mesh)), few_samples());
    EXPECT_EQ(result.from_truth.max, 0);
    EXPECT_GT(result.to_points->mean, 0);
}

}  // namespace
}  // namespace scanmill::test
