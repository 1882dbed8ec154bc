// SPDX-License-Identifier: GPL-3.0-or-later
/// The vertices of well-known closed models, used as scans, give surfaces of the models' genus. Skipped if the models
/// are absent.

#include <gmock/gmock.h>

#include "filters/known_models.hpp"
#include "filters/sculpt/cases.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {
namespace {

using namespace test;

class SculptOfModel : public testing::TestWithParam<Model> {};

TEST_P(SculptOfModel, IsAClosedSurfaceOfItsGenusThatDoesNotIntersectItself) {
    const auto path = found(GetParam());
    if (!path) GTEST_SKIP() << missing_data(GetParam().file);
    const AlphaSolidResult solid = solid_of(tets_of(*read_points(*path)));
    const SculptResult result = sculpted(solid.tets, {}, 2);
    const MeshTopology found = topology(result.mesh);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.components, 1u);
    EXPECT_EQ(found.genus, GetParam().genus);
    const long left = static_cast<long>(result.blocked_points.size() + result.deep_points.size());
    const long points = static_cast<long>(result.tets.positions.size());
    EXPECT_EQ(static_cast<long>(found.triangles), 2 * (points - left) - 4 + 4 * GetParam().genus);
    EXPECT_LE(20 * left, static_cast<long>(solid.interior_points.size())) << "nearly all come to the boundary";
    EXPECT_FALSE(intersects_itself(result.mesh));
}

INSTANTIATE_TEST_SUITE_P(Dense, SculptOfModel, testing::ValuesIn(dense_models));
INSTANTIATE_TEST_SUITE_P(Grooved, SculptOfModel, testing::ValuesIn(grooved_models));

}  // namespace
}  // namespace scanmill
