// SPDX-License-Identifier: GPL-3.0-or-later
/// sculpt takes the cells of tight-cocone.

#include "sculpt/sculpt.hpp"
#include "filters/tight_cocone/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill {
namespace {

using namespace test;

/// The surface of the same topology after sculpt.
void expect_sculpted(const PointCloud& cloud, long genus) {
    const TightCoconeResult solid = closed_through(cloud, {}, 2);
    ContextOptions options;
    options.threads = 2;
    Context context(options);
    const SculptResult result = sculpt(solid.tets, {}, context);
    const MeshTopology before = topology(solid.mesh), after = topology(result.mesh);
    EXPECT_TRUE(after.closed);
    EXPECT_EQ(before.genus, genus);
    EXPECT_EQ(after.genus, genus);
    EXPECT_EQ(after.components, before.components);
    EXPECT_GE(after.vertices, before.vertices);
    EXPECT_EQ(intersections(result.mesh), 0u);
}

TEST(SculptAfterTightCocone, Sphere_KeepsItsGenus) { expect_sculpted(fibonacci_sphere(1000, 1e-3), 0); }

TEST(SculptAfterTightCocone, SphereWithoutACap_KeepsItsGenus) {
    expect_sculpted(points_where(fibonacci_sphere(1000, 1e-3), [](const Vec3& p) { return p.z() < 0.9; }), 0);
}

TEST(SculptAfterTightCocone, Torus_KeepsItsGenus) { expect_sculpted(poisson_torus(0.1), 1); }

TEST(SculptAfterTightCocone, GroovedModel_KeepsItsGenus) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/anchor_dense.off");
    expect_sculpted(*read_points(path), 4);
}

}  // namespace
}  // namespace scanmill
