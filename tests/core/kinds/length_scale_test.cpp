// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/length_scale.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "scanmill/base/error.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Value as_value(auto object) { return std::make_shared<const decltype(object)>(std::move(object)); }

TEST(LengthScale, Points_AreMeasuredByTheirNeighbours) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {3, 0, 0}, {3, 4, 0}});
    cloud.frame.unit = LengthUnit::millimetre;
    const LengthScale scale = length_scale(as_value(cloud));
    EXPECT_EQ(scale.unit, LengthUnit::millimetre);
    EXPECT_EQ(scale.diagonal(), 5);
    EXPECT_EQ(scale.spacing(), 3);
    EXPECT_EQ(Length::percent_of_diagonal(10).resolved(scale).value(), 0.5);
}

TEST(LengthScale, Mesh_IsMeasuredByItsEdges) {
    const LengthScale scale = length_scale(as_value(cube(2)));
    EXPECT_EQ(scale.unit, LengthUnit::unknown);
    EXPECT_DOUBLE_EQ(scale.diagonal(), 2 * std::sqrt(3.0));
    EXPECT_EQ(scale.spacing(), 2);
}

TEST(LengthScale, MeshWithoutTriangles_IsMeasuredAsPoints) {
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, 0), Vec3(0, 0, 7)};
    EXPECT_EQ(length_scale(as_value(mesh)).spacing(), 7);
}

TEST(LengthScale, ValueWithoutPositions_HasNoScale) {
    const LengthScale scale = length_scale(as_value(Transforms(RigidTransform{})));
    EXPECT_EQ(scale.unit, LengthUnit::unknown);
    EXPECT_EQ(scale.diagonal(), 0);
    EXPECT_EQ(scale.spacing(), 0);
    EXPECT_THROW(Length::spacings(1).resolved(scale), Error);
}

std::string refusal(const auto& ask) {
    try {
        ask();
    } catch (const Error& error) {
        EXPECT_NE(error.hint(), "") << error.sentence();
        return error.sentence();
    }
    return "no refusal";
}

TEST(LengthScale, OnePlace_HasNoDiagonalToTakeAShareOf) {
    EXPECT_THAT(
        refusal(length_scale(as_value(cloud_of({{1, 2, 3}}))).diagonal),
        AllOf(HasSubstr("%diag is not defined here"), HasSubstr("the diagonal is 0, because the only point is at")));
    EXPECT_THAT(refusal(length_scale(as_value(cloud_of({{1, 2, 3}, {1, 2, 3}}))).diagonal),
                HasSubstr("all 2 points are at one position"));
}

TEST(LengthScale, Scale_OutlivesWhoMadeTheValue) {
    LengthScale scale;
    {
        const Value value = as_value(cloud_of({{0, 0, 0}, {0, 3, 4}}));
        scale = length_scale(value);
    }
    const LengthScale copy = scale;
    EXPECT_EQ(copy.diagonal(), 5);
    EXPECT_EQ(scale.spacing(), 5);
}

TEST(LengthScale, StrayPoints_AreNotPartOfTheDiagonalAndAreReportedOnce) {
    PointCloud cloud = random_cube(1000, 1);
    const double diagonal = length_scale(as_value(cloud)).diagonal();
    Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
    positions.push_back(Vec3(-100, 0, 0));
    cloud.positions = std::move(positions);
    cloud.frame.origin = Vec3(5000, 0, 0);
    std::vector<std::string> warnings;
    const LengthScale scale = length_scale(as_value(cloud), [&](std::string text) { warnings.push_back(text); });
    EXPECT_TRUE(warnings.empty()) << "the diagonal was not needed";
    EXPECT_EQ(scale.diagonal(), diagonal);
    EXPECT_EQ(scale.diagonal(), diagonal);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_THAT(warnings[0], AllOf(HasSubstr("without 1 stray point,"), HasSubstr("number 1000 at (4900, 0, 0)"),
                                   HasSubstr("remove it if it is not part of the object")));
}

TEST(LengthScale, ManyStrayPoints_AreCountedAndTheFirstAreNamed) {
    PointCloud cloud = random_cube(5000, 1);
    Array<Vec3> positions(cloud.positions.begin(), cloud.positions.end());
    for (std::size_t i = 0; i < 5; ++i) positions[10 * i] = Vec3(0, 100, static_cast<double>(i));
    cloud.positions = std::move(positions);
    std::string warning;
    length_scale(as_value(cloud), [&](std::string text) { warning = text; }).diagonal();
    EXPECT_THAT(warning, AllOf(HasSubstr("without 5 stray points,"), HasSubstr("number 20 at (0, 100, 2) and 2 more"),
                               HasSubstr("remove them if they are not part of the object")));
}

TEST(LengthScale, MeshWithAStrayVertex_HasItsOrdinaryBox) {
    TriangleMesh mesh = geodesic_sphere(1, 10);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    positions[0] = Vec3(100, 0, 0);
    mesh.positions = std::move(positions);
    EXPECT_GT(length_scale(as_value(mesh)).diagonal(), 100);
}

}  // namespace
}  // namespace scanmill::test
