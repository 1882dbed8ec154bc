// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "filters/region_grow/cases.hpp"
#include "measure/measure.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill {
namespace {

using namespace test;

PointCloud positions_of(const std::filesystem::path& path, double voxel = 0) {
    PointCloud cloud;
    cloud.positions = read_points(path)->positions;
    if (voxel == 0) return cloud;
    VoxelThinParams params;
    params.bin_size = Length(voxel);
    Context context;
    return voxel_thin(cloud, params, context).points;
}

std::size_t self_intersections(const TriangleMesh& mesh) {
    MeasureParams params;
    params.samples = 1000;
    Context context;
    return measure(mesh, mesh, params, context).self_intersections.value();
}

/// A model whose vertices are dense enough for a surface through all of them, and its topology.
struct Model {
    const char* file;
    long genus;
    std::size_t loops;
};

void PrintTo(const Model& model, std::ostream* stream) { *stream << model.file; }

class RegionGrowOfAModel : public testing::TestWithParam<Model> {};

TEST_P(RegionGrowOfAModel, IsTheModelsSurface) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam().file);
    const PointCloud cloud = positions_of(path);
    const RegionGrowResult result = grown(cloud, {}, 2);
    expect_consistent(result);
    EXPECT_EQ(result.loops, GetParam().loops);
    EXPECT_EQ(topology(result.mesh).genus, GetParam().genus);
    EXPECT_EQ(result.unused_points, 0u);
    EXPECT_EQ(result.components, 1u);
}

INSTANTIATE_TEST_SUITE_P(Models, RegionGrowOfAModel,
                         testing::Values(Model{"points_3/kitten.xyz", 1, 0}, Model{"meshes/fandisk_large.off", 0, 0},
                                         Model{"meshes/cube-meshed.off", 0, 0}, Model{"meshes/bear.off", 0, 0},
                                         Model{"meshes/knot1.off", 1, 0}, Model{"meshes/eight.off", 2, 0},
                                         Model{"meshes/refined_elephant.off", 3, 0}, Model{"meshes/holes.off", 0, 7},
                                         Model{"meshes/armadillo.off", 0, 0}, Model{"meshes/three_peaks.off", 0, 1}));

/// Voxel sizes in percent of the diagonal.
struct ThinnedModel {
    const char* file;
    double voxel;
    long genus;
};

void PrintTo(const ThinnedModel& model, std::ostream* stream) { *stream << model.file << " at " << model.voxel; }

class RegionGrowOfAThinnedModel : public testing::TestWithParam<ThinnedModel> {};

TEST_P(RegionGrowOfAThinnedModel, IsClosedAndHasTheModelsGenus) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam().file);
    const double diagonal = bounding_box(positions_of(path).positions.span()).diagonal();
    const PointCloud cloud = positions_of(path, GetParam().voxel / 100 * diagonal);
    const RegionGrowResult result = grown(cloud, {}, 2);
    expect_consistent(result);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(topology(result.mesh).genus, GetParam().genus);
    EXPECT_EQ(result.components, 1u);
    EXPECT_LE(1000 * result.unused_points, cloud.size());
    EXPECT_EQ(self_intersections(result.mesh), 0u);
}

INSTANTIATE_TEST_SUITE_P(
    Models, RegionGrowOfAThinnedModel,
    testing::Values(ThinnedModel{"meshes/armadillo.off", 0.8, 0}, ThinnedModel{"meshes/bunny00.off", 1, 0},
                    ThinnedModel{"meshes/fandisk_large.off", 1, 0}, ThinnedModel{"meshes/fandisk_large.off", 1.5, 0},
                    ThinnedModel{"meshes/refined_elephant.off", 1.2, 3}, ThinnedModel{"points_3/kitten.xyz", 2, 1}));

/// Voxel sizes in percent of the diagonal; some parts are thinner than three of them.
struct ThinModel {
    const char* file;
    double voxel;
    std::size_t loops;
};

void PrintTo(const ThinModel& model, std::ostream* stream) { *stream << model.file << " at " << model.voxel; }

class RegionGrowOfAThinModel : public testing::TestWithParam<ThinModel> {};

TEST_P(RegionGrowOfAThinModel, HasTheModelsLoopsAndOthersOnlyAtThinParts) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam().file);
    const double diagonal = bounding_box(positions_of(path).positions.span()).diagonal();
    const PointCloud cloud = positions_of(path, GetParam().voxel / 100 * diagonal);
    const RegionGrowResult result = grown(cloud, {}, 2);
    EXPECT_GT(result.thin_loops, 0u);
    EXPECT_EQ(result.loops, result.thin_loops + GetParam().loops);
}

INSTANTIATE_TEST_SUITE_P(
    Models, RegionGrowOfAThinModel,
    testing::Values(ThinModel{"meshes/armadillo.off", 0.4, 0}, ThinModel{"meshes/armadillo.off", 0.6, 0},
                    ThinModel{"meshes/armadillo.off", 1, 0}, ThinModel{"meshes/armadillo.off", 1.2, 0},
                    ThinModel{"meshes/mannequin-devil.off", 0.8, 1}, ThinModel{"meshes/mannequin-devil.off", 1, 1},
                    ThinModel{"meshes/lion-head.off", 0.6, 1}, ThinModel{"meshes/lion-head.off", 0.8, 1},
                    ThinModel{"meshes/lion-head.off", 1, 1}, ThinModel{"dragon/dragon_vrip.ply", 0.6, 0}));

struct Scan {
    const char* file;
    double voxel;
    /// At most, including the scan's own holes.
    std::size_t loops;
};

void PrintTo(const Scan& scan, std::ostream* stream) { *stream << scan.file; }

class RegionGrowOfAThinnedScan : public testing::TestWithParam<Scan> {};

TEST_P(RegionGrowOfAThinnedScan, UsesNearlyEveryPoint) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam().file);
    const PointCloud cloud = positions_of(path, GetParam().voxel);
    const RegionGrowResult result = grown(cloud, {}, 2);
    expect_consistent(result);
    EXPECT_LE(1000 * result.unused_points, 5 * cloud.size());
    EXPECT_LE(result.loops, GetParam().loops);
    EXPECT_EQ(self_intersections(result.mesh), 0u);
}

INSTANTIATE_TEST_SUITE_P(Scans, RegionGrowOfAThinnedScan,
                         testing::Values(Scan{"meshes/bunny00.off", 0, 5}, Scan{"meshes/hand.off", 0, 1},
                                         Scan{"dragon/dragon_vrip_res2.ply", 0.001, 3},
                                         Scan{"dragon/dragon_vrip_res2.ply", 0, 6}));

}  // namespace
}  // namespace scanmill
