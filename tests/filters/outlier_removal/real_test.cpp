// SPDX-License-Identifier: GPL-3.0-or-later
/// Real scans: clean ones keep their points, and outliers that are added to them are found.
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "filters/outlier_removal/cases.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/formats/files.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

/// The distance from every outlier that is kept to the nearest point of the scan, in spacings.
std::vector<double> left_outliers(const PointCloud& scan, const PointCloud& dirty, std::span<const u32> kept) {
    std::vector<double> result;
    const double spacing = point_spacing(scan.positions.span());
    for (const u32 row : kept) {
        if (row < scan.size()) continue;
        double squared = std::numeric_limits<double>::infinity();
        for (const Vec3& p : scan.positions) squared = std::min(squared, (p - dirty.positions[row]).squaredNorm());
        result.push_back(std::sqrt(squared) / spacing);
    }
    return result;
}

void expect_clean(const std::filesystem::path& path, double spacings_left) {
    const PointCloud scan = *read_points(path);
    EXPECT_EQ(clean(scan).removed, 0u) << path;
    const std::size_t strays = std::max<std::size_t>(1, scan.size() / 1000);
    const PointCloud near = with_outliers(scan, scan.size() / 20, 2, 11);
    const PointCloud both = joined(near, with_outliers(scan, strays, 100, 12));
    std::vector<Vec3> points(both.positions.begin(), both.positions.begin() + static_cast<std::ptrdiff_t>(near.size()));
    points.insert(points.end(), both.positions.end() - static_cast<std::ptrdiff_t>(strays), both.positions.end());
    const PointCloud dirty = cloud_of_points(points);
    const OutlierRemovalResult result = clean(dirty, {}, 2);
    std::size_t lost = scan.size();
    for (const u32 row : result.kept) lost -= row < scan.size();
    EXPECT_EQ(lost, 0u) << path;
    const std::vector<double> left = left_outliers(scan, dirty, result.kept);
    EXPECT_LT(static_cast<double>(left.size()), 0.06 * static_cast<double>(dirty.size() - scan.size())) << path;
    for (const double distance : left) EXPECT_LT(distance, spacings_left) << path;
}

TEST(OutlierRemovalReal, CleanModels_LoseNothingAndOutliersOnlyStayBesideTheSurface) {
    SCANMILL_REAL_SCAN(kitten, fetched_data, "points_3/kitten.xyz");
    SCANMILL_REAL_SCAN(armadillo, fetched_data, "meshes/armadillo.off");
    SCANMILL_REAL_SCAN(fandisk, fetched_data, "meshes/fandisk_large.off");
    expect_clean(kitten, 3);
    expect_clean(armadillo, 4);
    expect_clean(fandisk, 3);
}

TEST(OutlierRemovalReal, VerticesOfCadModels_SparseFlatFacesStay) {
    for (const char* name : {"meshes/cube-ouvert.off", "meshes/rotor.off", "meshes/couplingdown.off",
                             "meshes/cylinder_locally_refined.off"}) {
        SCANMILL_REAL_SCAN(path, fetched_data, name);
        EXPECT_EQ(clean(*read_points(path)).removed, 0u) << name;
    }
    for (const char* name : {"meshes/mannequin-devil.off", "meshes/bull.off"}) {  // some vertices stand out
        SCANMILL_REAL_SCAN(path, fetched_data, name);
        const PointCloud cloud = *read_points(path);
        EXPECT_LE(static_cast<double>(clean(cloud).removed), 0.002 * static_cast<double>(cloud.size())) << name;
    }
}

TEST(OutlierRemovalReal, Bunny_KeepsAllPoints) {
    SCANMILL_REAL_SCAN(bunny, shared_data, "1-bunny/bun_zipper.ply");
    EXPECT_EQ(clean(*read_points(bunny)).removed, 0u);
}

}  // namespace
}  // namespace scanmill::test
