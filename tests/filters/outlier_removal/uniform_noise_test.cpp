// SPDX-License-Identifier: GPL-3.0-or-later
/// Outliers that are uniform in the doubled box of a scan, and scans with parts of different densities.
#include <gmock/gmock.h>

#include "filters/outlier_removal/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

struct Shares {
    double outliers = 0, surface = 0;  ///< removed share of either
    bool is_doubtful = false;
};

Shares removed_shares(const PointCloud& scan, double share, std::uint64_t seed) {
    const auto count = static_cast<std::size_t>(share * static_cast<double>(scan.size()));
    ContextOptions options;
    options.threads = 2;
    Context context(options);
    const OutlierRemovalResult result = outlier_removal(with_outliers(scan, count, 2, seed), {}, context);
    std::size_t surface = 0;
    for (const u32 row : result.kept) surface += row < scan.size();
    const double outliers_left = static_cast<double>(result.kept.size() - surface);
    return {count > 0 ? 1 - outliers_left / static_cast<double>(count) : 1,
            1 - static_cast<double>(surface) / static_cast<double>(scan.size()), !doubts_of(context).empty()};
}

void expect_found(const PointCloud& scan, const char* name) {
    EXPECT_EQ(removed_shares(scan, 0, 1).surface, 0) << name;
    for (const double share : {0.02, 0.05, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5}) {
        const Shares found = removed_shares(scan, share, 1 + static_cast<std::uint64_t>(1000 * share));
        EXPECT_GE(found.outliers, 0.95) << name << ", " << share;
        EXPECT_LE(found.surface, 0.001) << name << ", " << share;
    }
    for (const double share : {0.6, 0.7, 1.0}) {
        const Shares found = removed_shares(scan, share, 7);
        EXPECT_TRUE(found.outliers >= 0.95 || found.is_doubtful) << name << ", " << share;
    }
}

TEST(OutlierRemovalUniform, UpToHalfAsManyAsPoints_AreFoundRoundASphere) {
    expect_found(random_sphere(9'000, 2), "random sphere");
}

TEST(OutlierRemovalUniform, UpToHalfAsManyAsPoints_AreFoundRoundATorus) {
    expect_found(poisson_torus(0.03, 0.4, 2000, 3), "torus");
}

TEST(OutlierRemovalUniform, UpToHalfAsManyAsPoints_AreFoundRoundScans) {
    SCANMILL_REAL_SCAN(bunny, fetched_data, "meshes/bunny00.off");
    SCANMILL_REAL_SCAN(armadillo, fetched_data, "meshes/armadillo.off");
    SCANMILL_REAL_SCAN(fandisk, fetched_data, "meshes/fandisk_large.off");
    expect_found(*read_points(bunny), "bunny");
    expect_found(*read_points(armadillo), "armadillo");
    expect_found(*read_points(fandisk), "fandisk");
}

/// The surface of a cube, on a lattice.
PointCloud hollow_cube(int per_edge) {
    PointCloud cloud;
    Array<Vec3> positions;
    const auto is_end = [&](int i) { return i == 0 || i == per_edge; };
    for (int x = 0; x <= per_edge; ++x)
        for (int y = 0; y <= per_edge; ++y)
            for (int z = 0; z <= per_edge; ++z)
                if (is_end(x) || is_end(y) || is_end(z)) positions.emplace_back(x, y, z);
    cloud.positions = std::move(positions);
    return cloud;
}

TEST(OutlierRemovalUniform, FewInsideADenseScan_AreFoundAlthoughTheirNeighboursAreNearTheSurface) {
    const PointCloud cube = hollow_cube(120);
    for (const double share : {0.003, 0.005, 0.01}) {
        const Shares found = removed_shares(cube, share, 3);
        EXPECT_GE(found.outliers, 0.98) << share;
        EXPECT_EQ(found.surface, 0) << share;
    }
}

TEST(OutlierRemovalUniform, HalvesOfDifferentDensities_BothStay) {
    for (const std::size_t times : {1, 2, 3, 5, 8}) {
        std::vector<Vec3> points;
        for (const Vec3& p : random_sphere(2'400, 5).positions)
            if (p.z() > 0) points.push_back(p);
        const std::size_t sparse = points.size();
        for (const Vec3& p : random_sphere(2'400 * times * times, 6).positions)
            if (p.z() <= 0) points.push_back(p);
        Context context;
        const OutlierRemovalResult result = outlier_removal(cloud_of_points(points), {}, context);
        const auto kept =
            static_cast<std::size_t>(std::ranges::count_if(result.kept, [&](u32 row) { return row < sparse; }));
        EXPECT_GE(static_cast<double>(kept), 0.995 * static_cast<double>(sparse)) << times;
        EXPECT_GE(static_cast<double>(result.kept.size() - kept), 0.995 * static_cast<double>(points.size() - sparse))
            << times;
        EXPECT_THAT(doubts_of(context), testing::IsEmpty()) << times;
    }
}

TEST(OutlierRemovalUniform, OutliersAlone_StayAndAreNoSurface) {
    const OutlierRemovalResult result = clean(random_cube(5'000, 3));
    EXPECT_GT(result.kept.size(), 4'500u) << "nothing tells which of them belong to an object";
}

TEST(OutlierRemovalUniform, RemovedSparsePart_IsDoubtfulByItsArea) {
    // A sheet with a 15th of the points and most of the area, apart from the other one.
    std::vector<Vec3> points = square_grid(100, 1);
    const std::vector<Vec3> sparse = square_grid(25, 10, Vec3(500, 0, 0));
    points.insert(points.end(), sparse.begin(), sparse.end());
    OutlierRemovalParams params;
    params.min_component = Ratio::percent(90);
    Context context;
    EXPECT_EQ(outlier_removal(cloud_of_points(points), params, context).removed, 625u);
    EXPECT_THAT(doubts_of(context), testing::ElementsAre(testing::HasSubstr("% of the area")));
}

}  // namespace
}  // namespace scanmill::test
