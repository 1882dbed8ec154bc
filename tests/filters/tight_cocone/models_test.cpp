// SPDX-License-Identifier: GPL-3.0-or-later
/// The vertices of well-known closed models as clouds. Skipped where the collections are absent.

#include <gmock/gmock.h>

#include "filters/tight_cocone/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/known_models.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::IsEmpty;
using testing::Not;

class TightCoconeOfModel : public testing::TestWithParam<Model> {
protected:
    void SetUp() override {
        const auto path = found(GetParam());
        if (!path) GTEST_SKIP() << missing_data(GetParam().file);
        const auto cloud = read_points(*path);
        outcome = outcome_of(*cloud);
        ASSERT_FALSE(outcome.refusal) << outcome.refusal->what();
        points = tets_of(*cloud).positions.size();
        properties = topology(outcome.result->mesh);
    }
    Outcome outcome;
    std::size_t points = 0;
    MeshTopology properties;
};

class TightCoconeOfDenseModel : public TightCoconeOfModel {};
TEST_P(TightCoconeOfDenseModel, HasTheModelsGenusAndNearlyAllItsPoints) {
    expect_promised(*outcome.result, points);
    EXPECT_EQ(properties.components, 1u);
    EXPECT_EQ(properties.genus, GetParam().genus);
    EXPECT_EQ(intersections(outcome.result->mesh), 0u);
    EXPECT_LE(100 * outcome.result->unused, points);
    EXPECT_THAT(outcome.doubts, IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Models, TightCoconeOfDenseModel, testing::ValuesIn(dense_models));

TEST(TightCoconeOfDenseModels, UsesAllButOneInAThousandOfTheirPoints) {
    std::size_t points = 0, unused = 0;
    for (const Model& model : dense_models) {
        const auto path = found(model);
        if (!path) GTEST_SKIP() << missing_data(model.file);
        const TightCoconeResult result = closed_through(*read_points(*path), {}, 2);
        points += result.unused + result.mesh.positions.size();
        unused += result.unused;
    }
    EXPECT_LE(1000 * unused, points);
}

/// With creases, and with grooves that are narrow beside the spacing.
class TightCoconeOfGroovedModel : public TightCoconeOfModel {};
TEST_P(TightCoconeOfGroovedModel, IsClosed_AndHasTheModelsGenusOrADoubt) {
    expect_promised(*outcome.result, points);
    EXPECT_EQ(intersections(outcome.result->mesh), 0u);
    if (properties.genus != GetParam().genus) {
        EXPECT_THAT(outcome.doubts, Not(IsEmpty()));
    }
}
INSTANTIATE_TEST_SUITE_P(Models, TightCoconeOfGroovedModel, testing::ValuesIn(grooved_models));

}  // namespace
}  // namespace scanmill
