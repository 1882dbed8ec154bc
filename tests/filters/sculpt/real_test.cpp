// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "filters/sculpt/cases.hpp"
#include "measure/measure.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill {
namespace {

using namespace test;

struct Scan {
    const char* file;
    long genus;
};

void PrintTo(const Scan& scan, std::ostream* stream) { *stream << scan.file; }

class SculptOfRealScan : public testing::TestWithParam<Scan> {};

TEST_P(SculptOfRealScan, IsAClosedSurfaceThroughItsPointsThatDoesNotIntersectItself) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam().file);
    const AlphaSolidResult solid = solid_of(tets_of(*read_points(path)));
    const SculptResult result = sculpted(solid.tets, {}, 2);
    const std::size_t left = result.blocked_points.size() + result.deep_points.size();
    // Nearly all points in the interior of the alpha-solid come to the boundary.
    EXPECT_LE(100 * left, solid.interior_points.size());
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.components, 1u);
    EXPECT_EQ(found.genus, GetParam().genus);
    EXPECT_EQ(found.vertices, result.tets.positions.size() - left);
    EXPECT_EQ(static_cast<long>(found.triangles), 2 * static_cast<long>(found.vertices) - 4 + 4 * GetParam().genus);
    EXPECT_EQ(result.exposing, solid.interior_points.size() - left);
    MeasureParams params;
    params.samples = 1000;
    Context context;
    EXPECT_EQ(measure(result.mesh, result.mesh, params, context).self_intersections, 0u);
}

INSTANTIATE_TEST_SUITE_P(Scans, SculptOfRealScan,
                         testing::Values(Scan{"meshes/bunny00.off", 0}, Scan{"points_3/kitten.xyz", 1},
                                         Scan{"meshes/fandisk_large.off", 0}, Scan{"meshes/hand.off", 0}));

TEST(SculptOfTheBunny, KeepsTheScansColumns) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/bun_zipper.ply");
    const SculptResult result = sculpted(solid_of(tets_of(*read_points(path))).tets, {}, 2);
    EXPECT_TRUE(topology(result.mesh).closed);
    ASSERT_NE(result.mesh.vertex_columns.find("confidence"), nullptr);
}

}  // namespace
}  // namespace scanmill
