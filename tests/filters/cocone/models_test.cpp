// SPDX-License-Identifier: GPL-3.0-or-later
/// The vertices of well-known models as clouds. Skipped where the collections are absent.

#include <gtest/gtest.h>

#include "filters/cocone/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/known_models.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

void expect_closed(const CoconeResult& result, long genus) {
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.components, 1u);
    EXPECT_EQ(found.genus, genus);
    EXPECT_EQ(result.loops, 0u);
    EXPECT_TRUE(result.features.polylines.empty());
    EXPECT_GT(signed_volume(result.mesh), 0);
    EXPECT_LT(static_cast<double>(result.unused), 1e-3 * static_cast<double>(found.vertices));
    EXPECT_EQ(static_cast<long>(found.triangles), 2 * static_cast<long>(found.vertices) - 4 + 4 * genus);
}

class CoconeOfDenseModel : public testing::TestWithParam<Model> {};
TEST_P(CoconeOfDenseModel, IsClosedWithTheModelsGenus) {
    const auto path = found(GetParam());
    if (!path) GTEST_SKIP() << missing_data(GetParam().file);
    expect_closed(surface_through(*read_points(*path), {}, 2), GetParam().genus);
}
INSTANTIATE_TEST_SUITE_P(Models, CoconeOfDenseModel, testing::ValuesIn(dense_models));

TEST(CoconeReal, Bunny_IsClosedThroughAllItsPoints) {
    SCANMILL_REAL_SCAN(path, fetched_data, "meshes/bunny00.off");
    const CoconeResult result = surface_through(*read_points(path), {}, 2);
    expect_closed(result, 0);
    EXPECT_EQ(result.unused, 0u);
}

TEST(CoconeReal, ASphereWithHoles_HasSevenLoops) {
    SCANMILL_REAL_SCAN(path, shared_data, "4-open/holes.off");
    const CoconeResult result = surface_through(*read_points(path), {}, 2);
    const MeshTopology found = topology(result.mesh);
    EXPECT_EQ(result.loops, 7u);
    EXPECT_EQ(result.features.polylines.size(), 7u);
    EXPECT_EQ(found.boundary_loops, 7u);
    EXPECT_EQ(found.nonmanifold_vertices, 0u);
    EXPECT_EQ(found.components, 1u);
    EXPECT_EQ(found.genus, 0);
}

}  // namespace
}  // namespace scanmill
