// SPDX-License-Identifier: GPL-3.0-or-later
// Scans from other sources, with their published counts.
#include "core/formats/support.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

TEST(Readers_RealScan, BunnyOfStanford_HasItsKnownCountsAndBounds) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/bun_zipper.ply");
    const auto mesh = read_mesh(path);
    EXPECT_EQ(mesh->positions.size(), 35947u);
    EXPECT_EQ(mesh->triangles.size(), 69451u);
    EXPECT_EQ(mesh->vertex_columns.size(), 2u);
    const BoundingBox box = bounding_box(mesh->positions.span());
    EXPECT_NEAR(box.low.x(), -0.09469, 1e-5);
    EXPECT_NEAR(box.high.y(), 0.1873, 1e-4);
}

TEST(Readers_RealScan, RawRangeScan_IsAPointCloudWithoutItsGrid) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/raw/bun000.ply");
    Warnings warnings;
    EXPECT_EQ(read_file(path, warnings.reading()).value.get<PointCloud>()->size(), 40256u);
    EXPECT_THAT(warnings.sentences, testing::ElementsAre(testing::HasSubstr("204800 cells")));
}

TEST(Readers_RealScan, FemurStl_IsClosed_ByEulersFormula) {
    SCANMILL_REAL_SCAN(path, shared_data, "7-seed-like/femur_gfxmorph.stl");
    const auto mesh = read_mesh(path);
    // A closed triangulation of the sphere has 2 V - 4 triangles: only if exactly the equal corners were merged.
    EXPECT_EQ(mesh->positions.size(), 10156u);
    EXPECT_EQ(mesh->triangles.size(), 2 * mesh->positions.size() - 4);
}

TEST(Readers_RealScan, TheSameSphereInThreeFormats_IsTheSameMesh) {
    SCANMILL_REAL_SCAN(ply, fetched_data, "meshes/sphere.ply");
    SCANMILL_REAL_SCAN(stl, fetched_data, "meshes/sphere.stl");
    SCANMILL_REAL_SCAN(off, fetched_data, "meshes/sphere.off");
    for (const auto& path : {ply, stl, off}) {
        const auto mesh = read_mesh(path);
        EXPECT_EQ(mesh->positions.size(), 162u) << path;
        EXPECT_EQ(mesh->triangles.size(), 320u) << path;
    }
}

TEST(Readers_RealScan, TriangleStrips_GiveTheBunnysTriangles) {
    SCANMILL_REAL_SCAN(path, shared_data, "6-formats/ply/odd/loadersgl_bunny_tristrips.ply");
    const auto mesh = read_mesh(path);
    EXPECT_EQ(mesh->positions.size(), 34834u);
    EXPECT_EQ(mesh->triangles.size(), 69451u);
}

TEST(Readers_RealScan, SurveyInMetres_KeepsItsLastDigits) {
    SCANMILL_REAL_SCAN(path, shared_data, "6-formats/xyz/ok/trimesh_points_agisoft.xyz");
    const auto cloud = read_points(path);
    EXPECT_NE(cloud->frame.origin, Vec3(0, 0, 0));
    EXPECT_EQ(world_of(*cloud, 0), Vec3(665187.522077, 5648349.895035, 241.767693));
}

TEST(Readers_RealScan, ThroughEveryWriter_AMeshComesBack) {
    SCANMILL_REAL_SCAN(path, shared_data, "7-seed-like/femur_gfxmorph.stl");
    const TemporaryFolder folder;
    const auto mesh = read_mesh(path);
    for (const char* name : {"a.ply", "a.stl", "a.off", "a.obj"}) {
        Warnings warnings;
        write_file(folder / name, mesh, warnings.writing());
        const auto back = read_mesh(folder / name);
        EXPECT_TRUE(std::ranges::equal(back->positions, mesh->positions)) << name;
        EXPECT_TRUE(std::ranges::equal(back->triangles, mesh->triangles)) << name;
        EXPECT_TRUE(warnings.sentences.empty()) << name;
    }
}

}  // namespace
}  // namespace scanmill::test
