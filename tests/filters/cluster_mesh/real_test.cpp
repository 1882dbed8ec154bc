// SPDX-License-Identifier: GPL-3.0-or-later
// Scanned and designed objects, thinned.
#include <gmock/gmock.h>

#include "filters/cluster_mesh/cases.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill {
namespace {

using namespace test;

PointCloud thinned(const PointCloud& cloud, double percent) {
    Context context;
    VoxelThinParams params;
    params.bin_size = Length(percent / 100 * bounding_box(cloud.positions).diagonal());
    return voxel_thin(cloud, params, context).points;
}

TEST(ClusterMesh_RealScans, TheKitten_IsClosedWithGenusOne) {
    SCANMILL_REAL_SCAN(path, fetched_data, "points_3/kitten.xyz");
    const auto cloud = read_points(path);
    const ClusterMeshResult result = clustered(*cloud, {}, 2);
    expect_laws(*cloud, result);
    EXPECT_EQ(result.mesh.triangles.size(), 2 * cloud->size());
    EXPECT_EQ(topology(result.mesh).genus, 1);
    EXPECT_GT(volume_of(result.mesh), 0);
}

class ClusterMesh_OfAModel : public testing::TestWithParam<const char*> {};

/// Every missing triangle belongs to a loop: F = 2 V - 2 chi - b, and few points are unused.
TEST_P(ClusterMesh_OfAModel, KeepsTheLaws) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam());
    const PointCloud cloud = thinned(*read_points(path), 1.2);
    const ClusterMeshResult result = clustered(cloud, {}, 2);
    expect_laws(cloud, result);
    EXPECT_LT(result.unused_points, cloud.size() / 200);
    EXPECT_GT(result.mesh.triangles.size(), 2 * cloud.size() * 97 / 100);
    EXPECT_EQ(result.clusters, 1u);
}

INSTANTIATE_TEST_SUITE_P(, ClusterMesh_OfAModel,
                         testing::Values("meshes/bunny00.off", "meshes/armadillo.off", "meshes/fandisk_large.off",
                                         "points_3/ball.ply"));

}  // namespace
}  // namespace scanmill
