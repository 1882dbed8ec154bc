// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "alpha_solid/alpha_solid.hpp"
#include "delaunay/delaunay.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

AlphaSolidResult solid_of(const PointCloud& cloud, const AlphaSolidParams& params = {}) {
    ContextOptions options;
    options.threads = 2;
    Context context(options);
    return alpha_solid(delaunay(cloud, {}, context).tets, params, context);
}

/// The guarantees of an automatic alpha for any scan.
void expect_valid(const AlphaSolidResult& result) {
    const MeshTopology properties = topology(result.mesh);
    EXPECT_TRUE(properties.closed);
    EXPECT_EQ(properties.unused_vertices, 0u);
    EXPECT_EQ(properties.components, 1u);
    EXPECT_EQ(result.components, 1u);
    EXPECT_GE(result.alpha, result.alpha_cover);
    EXPECT_GT(signed_volume(result.mesh), 0);
    EXPECT_EQ(properties.vertices + result.interior_points.size() + result.uncovered_points.size(),
              result.tets.positions.size());
    // F = 2n − 2χ over the points on the boundary.
    EXPECT_EQ(static_cast<long>(properties.triangles), 2 * (static_cast<long>(properties.vertices) - properties.euler));
}

struct Scan {
    const char* file;
    std::size_t points;
    long genus;
};

void PrintTo(const Scan& scan, std::ostream* stream) { *stream << scan.file; }

class AlphaSolidOfRealScan : public testing::TestWithParam<Scan> {};

TEST_P(AlphaSolidOfRealScan, IsOneClosedManifoldOfTheObjectsGenus) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam().file);
    const auto cloud = read_points(path);
    ASSERT_EQ(cloud->size(), GetParam().points);
    const AlphaSolidResult result = solid_of(*cloud);
    expect_valid(result);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    EXPECT_EQ(topology(result.mesh).genus, GetParam().genus);
}

INSTANTIATE_TEST_SUITE_P(Scans, AlphaSolidOfRealScan,
                         testing::Values(Scan{"points_3/kitten.xyz", 5210, 1},
                                         Scan{"meshes/fandisk_large.off", 15843, 0},
                                         Scan{"meshes/bunny00.off", 37706, 0}, Scan{"meshes/hand.off", 1197, 0}));

TEST(AlphaSolidOfTheBunny, ReachesIntoNoPointsNeighbourhood) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/bun_zipper.ply");
    const auto cloud = read_points(path);
    const AlphaSolidResult result = solid_of(*cloud);
    expect_valid(result);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    // The columns confidence and intensity of the scan must be carried to the boundary.
    ASSERT_NE(result.mesh.vertex_columns.find("confidence"), nullptr);
    EXPECT_EQ(result.mesh.vertex_columns.find("confidence")->rows(), result.mesh.positions.size());
}

TEST(AlphaSolidOfABodyInThreeParts, IsOne_BecauseTheirCutsAreOpen_WithAWarningThatGapsAreSpanned) {
    // Two rings were cut out of it: the alpha that closes the ends of the three parts spans the gaps as well.
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/blobby_3cc.off");
    const auto cloud = read_points(path);
    for (AlphaComponents components : {AlphaComponents::single, AlphaComponents::many}) {
        Context context;
        AlphaSolidParams params;
        params.components = components;
        const AlphaSolidResult result = alpha_solid(delaunay(*cloud, {}, context).tets, params, context);
        expect_valid(result);
        EXPECT_FALSE(result.separate);
        EXPECT_EQ(topology(result.mesh).genus, 0u);
        EXPECT_THAT(
            sentences_of(context),
            testing::Contains(testing::AllOf(
                testing::HasSubstr("to span gaps"),
                testing::HasSubstr("gaps and hollows narrower than 2 alpha may be filled, even between parts"))));
    }
}

TEST(AlphaSolidOfTheDragon, InFull_IsOneClosedManifoldThroughAllItsPoints) {
    SCANMILL_REAL_SCAN(path, fetched_data, "dragon/dragon_vrip.ply");
    const auto cloud = read_points(path);
    ASSERT_EQ(cloud->size(), 437645u);
    const AlphaSolidResult result = solid_of(*cloud);
    expect_valid(result);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    EXPECT_EQ(topology(result.mesh).genus, 1);
}

TEST(AlphaSolidOfTheDragon, WithItsDebris_IsOneClosedManifold) {
    SCANMILL_REAL_SCAN(path, fetched_data, "dragon/dragon_vrip_res2.ply");
    const auto cloud = read_points(path);
    for (double share : {100.0, 99.0}) {
        AlphaSolidParams params;
        params.coverage = Ratio::percent(share);
        const AlphaSolidResult result = solid_of(*cloud, params);
        expect_valid(result);
        EXPECT_LE(static_cast<double>(result.uncovered_points.size()),
                  (1 - share / 100) * static_cast<double>(cloud->size()) + 1e-6);
    }
}

}  // namespace
}  // namespace scanmill
