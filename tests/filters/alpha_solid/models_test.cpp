// SPDX-License-Identifier: GPL-3.0-or-later
/// The vertices of well-known closed models as clouds: which models are reconstructed, and the warnings about the
/// others. Skipped where the collections are absent.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "alpha_solid/alpha_solid.hpp"
#include "delaunay/delaunay.hpp"
#include "filters/known_models.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

struct Reconstruction {
    AlphaSolidResult solid;
    std::vector<std::string> warnings;
};

Reconstruction reconstructed(const std::filesystem::path& path) {
    ContextOptions options;
    options.threads = 2;
    Context context(options);
    const TetMesh tets = delaunay(*read_points(path), {}, context).tets;
    return {alpha_solid(tets, {}, context), sentences_of(context)};
}

/// One closed, outward manifold through every point but those inside.
void expect_promised(const AlphaSolidResult& solid, const MeshTopology& properties) {
    EXPECT_TRUE(properties.closed);
    EXPECT_EQ(properties.components, 1u);
    EXPECT_EQ(properties.unused_vertices, 0u);
    EXPECT_EQ(solid.uncovered_points.size(), 0u);
    EXPECT_EQ(properties.vertices + solid.interior_points.size(), solid.tets.positions.size());
    EXPECT_GT(signed_volume(solid.mesh), 0);
    EXPECT_FALSE(intersects_itself(solid.mesh));
}

class AlphaSolidOfModel : public testing::TestWithParam<Model> {
protected:
    void SetUp() override {
        const auto path = found(GetParam());
        if (!path) GTEST_SKIP() << missing_data(GetParam().file);
        const MeshTopology model = topology(*read_mesh(*path));
        ASSERT_TRUE(model.closed);
        ASSERT_EQ(model.components, 1u);
        ASSERT_EQ(model.genus, GetParam().genus);
        result = reconstructed(*path);
        properties = topology(result.solid.mesh);
    }
    Reconstruction result;
    MeshTopology properties;
};

class AlphaSolidOfDenseModel : public AlphaSolidOfModel {};
TEST_P(AlphaSolidOfDenseModel, HasTheModelsGenusAndAllItsPointsWithoutAWarning) {
    expect_promised(result.solid, properties);
    const long points = static_cast<long>(result.solid.tets.positions.size());
    EXPECT_EQ(static_cast<long>(properties.triangles), 2 * points - 4 + 4 * GetParam().genus);
    EXPECT_EQ(properties.genus, GetParam().genus);
    EXPECT_THAT(result.warnings, testing::IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Models, AlphaSolidOfDenseModel, testing::ValuesIn(dense_models));

class AlphaSolidOfGroovedModel : public AlphaSolidOfModel {};
TEST_P(AlphaSolidOfGroovedModel, HasTheModelsGenusAndReportsThePointsInside) {
    expect_promised(result.solid, properties);
    const long points = static_cast<long>(result.solid.tets.positions.size());
    const long inside = static_cast<long>(result.solid.interior_points.size());
    EXPECT_GT(inside, 0);
    EXPECT_EQ(static_cast<long>(properties.triangles), 2 * points - 4 - 2 * inside + 4 * GetParam().genus);
    EXPECT_EQ(properties.genus, GetParam().genus);
    EXPECT_THAT(result.warnings,
                testing::Contains(testing::HasSubstr(fmt::format("{} of {} points lie inside", inside, points))));
}
INSTANTIATE_TEST_SUITE_P(Models, AlphaSolidOfGroovedModel, testing::ValuesIn(grooved_models));

/// Too thin or too sparsely sampled: the result has another genus. The points do not show that, but they show that
/// alpha is doubtful.
class AlphaSolidOfSparseModel : public AlphaSolidOfModel {};
TEST_P(AlphaSolidOfSparseModel, HasAnotherGenusWithAWarning) {
    expect_promised(result.solid, properties);
    EXPECT_NE(properties.genus, GetParam().genus);
    EXPECT_THAT(result.warnings, testing::Contains(testing::HasSubstr("narrower than 2 alpha may be filled")));
}
INSTANTIATE_TEST_SUITE_P(Models, AlphaSolidOfSparseModel,
                         testing::Values(Model{"meshes/anchor.off", 4}, Model{"meshes/cheese.off", 133},
                                         Model{"meshes/couplingdown.off", 9}, Model{"meshes/elephant.off", 3},
                                         Model{"meshes/elk.off", 1}, Model{"meshes/femur.off", 2},
                                         Model{"meshes/helmet.off", 3}, Model{"meshes/joint.off", 2},
                                         Model{"meshes/man.off", 0}, Model{"meshes/pinion.off", 1},
                                         Model{"meshes/rotor_small.off", 1}));

/// Open surfaces and posts with a few distant points: the alpha of the solid spans regions that were not scanned.
class AlphaSolidOfOpenModel : public testing::TestWithParam<Model> {};
TEST_P(AlphaSolidOfOpenModel, IsASolidWithADoubtfulAlpha) {
    const auto path = found(GetParam());
    if (!path) GTEST_SKIP() << missing_data(GetParam().file);
    const Reconstruction result = reconstructed(*path);
    expect_promised(result.solid, topology(result.solid.mesh));
    EXPECT_THAT(result.warnings, testing::Contains(testing::HasSubstr("times the boundary's median edge")));
}
INSTANTIATE_TEST_SUITE_P(Models, AlphaSolidOfOpenModel,
                         testing::Values(Model{"meshes/patch-20.off", 0}, Model{"points_3/half.xyz", 0},
                                         Model{"points_3/radar.xyz", 0}, Model{"points_3/poste_france.xyz", 0},
                                         Model{"4-open/holes.off", 0}));

}  // namespace
}  // namespace scanmill
