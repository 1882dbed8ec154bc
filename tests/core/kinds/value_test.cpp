// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/value.hpp"

#include <gtest/gtest.h>

#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

template <class T>
Value value_of(T object) {
    return std::make_shared<const T>(std::move(object));
}

template <class T>
void expect_kind(Kind kind, std::string_view name, bool geometric) {
    EXPECT_EQ(kind_of<T>(), kind);
    EXPECT_EQ(kind_of(value_of(T{})), kind);
    EXPECT_EQ(name_of(kind), name);
    EXPECT_EQ(kind_named(name), kind);
    EXPECT_EQ(is_geometric(kind), geometric);
    EXPECT_EQ(frame_of(value_of(T{})).has_value(), geometric) << "a frame goes with positions";
    EXPECT_NE(kind_names().find(name), std::string::npos);
}

TEST(Kind, EveryKind_HasItsNameItsTypeAndMaybeAFrame) {
    expect_kind<PointCloud>(kind_of<PointCloud>(), "points", true);
    expect_kind<TriangleMesh>(kind_of<TriangleMesh>(), "mesh", true);
    expect_kind<TetMesh>(kind_of<TetMesh>(), "tets", true);
    expect_kind<FeatureGraph>(kind_of<FeatureGraph>(), "features", true);
    expect_kind<PatchComplex>(kind_of<PatchComplex>(), "patches", true);
    expect_kind<ProbePlan>(kind_of<ProbePlan>(), "probes", true);
    expect_kind<Transforms>(kind_of<Transforms>(), "transform", false);
    expect_kind<Metrics>(kind_of<Metrics>(), "metrics", false);
    expect_kind<Picture>(kind_of<Picture>(), "picture", false);
}

TEST(Kind, UnknownName_IsNoKind) {
    for (const char* name : {"", "Points", "point", "surface"}) EXPECT_FALSE(kind_named(name)) << name;
}

const Frame far_away{LengthUnit::millimetre, Vec3(1000, -2000, 0), "machine"};

template <class T>
class Reframed : public testing::Test {};
using Geometries = testing::Types<PointCloud, TriangleMesh, TetMesh, FeatureGraph, PatchComplex>;
TYPED_TEST_SUITE(Reframed, Geometries);

TYPED_TEST(Reframed, OtherOrigin_KeepsWorldPositions) {
    TypeParam object;
    object.frame = {LengthUnit::metre, Vec3(500, 0, 7), "site"};
    object.positions = {Vec3(1, 2, 3), Vec3(-4, 0, 0.5)};
    const Value moved = reframed(value_of(object), far_away);
    const auto& result = *moved.get<TypeParam>();
    EXPECT_EQ(result.frame, far_away) << "unit and name are set, not converted";
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(result.positions[i] + far_away.origin, object.positions[i] + object.frame.origin);
    EXPECT_EQ(result.positions[0], Vec3(1 + 500 - 1000, 2 + 2000, 3 + 7));
}

TYPED_TEST(Reframed, EqualFrame_IsTheSameObject) {
    TypeParam object;
    object.frame = far_away;
    const Value value = value_of(object);
    EXPECT_EQ(reframed(value, far_away), value);
}

TYPED_TEST(Reframed, OtherUnitOnly_LeavesPositionsWhereTheyAre) {
    TypeParam object;
    object.positions = {Vec3(1, 2, 3)};
    const Value moved = reframed(value_of(object), {LengthUnit::inch, Vec3::Zero(), ""});
    const auto& result = *moved.get<TypeParam>();
    EXPECT_EQ(result.frame.unit, LengthUnit::inch);
    EXPECT_EQ(result.positions.data(), object.positions.data()) << "the memory is shared";
}

TEST(ReframedMesh, EverythingButPositions_IsCarried) {
    TriangleMesh mesh = cube();
    mesh.vertex_columns.add(Column("id", 1, Buffer<u32>{0, 1, 2, 3, 4, 5, 6, 7}));
    mesh.sharp_edges = {make_edge(0, 1)};
    const Value moved = reframed(value_of(mesh), far_away);
    const auto& result = *moved.get<TriangleMesh>();
    EXPECT_TRUE(std::ranges::equal(result.triangles, mesh.triangles));
    EXPECT_EQ(result.vertex_columns, mesh.vertex_columns);
    EXPECT_TRUE(std::ranges::equal(result.sharp_edges, mesh.sharp_edges));
}

TEST(ReframedTransform, WithoutPositions_ComesBackAsItIs) {
    const Value transform = value_of(Transforms(RigidTransform{}));
    EXPECT_EQ(reframed(transform, far_away), transform);
    EXPECT_FALSE(frame_of(transform).has_value());
}

TEST(FrameOf, Geometry_IsItsFrame) {
    PointCloud cloud;
    cloud.frame = far_away;
    const Value value = value_of(cloud);
    ASSERT_TRUE(frame_of(value));
    EXPECT_EQ(*frame_of(value), far_away);
}

TEST(PictureKind, PropertiesAreItsSize_AndEveryPixelIsRequired) {
    Picture picture{3, 2, Array<Colour>(6, Colour{1, 2, 3}), "Two rows"};
    const Metrics properties = properties_of(value_of(picture));
    ASSERT_NE(properties.find("width"), nullptr);
    EXPECT_EQ(properties.find("width")->value, 3);
    EXPECT_EQ(properties.find("height")->value, 2);
    const auto refusal = [](const Picture& each) {
        return sentence_of([&] { kind_of<Picture>().info().require_usable(&each); });
    };
    EXPECT_NO_THROW(kind_of<Picture>().info().require_usable(&picture));
    picture.height = 3;
    EXPECT_EQ(refusal(picture), "the picture has 6 pixels; expected 3 x 3 = 9");
    EXPECT_EQ(refusal(Picture{4, 0, {}, ""}), "the picture is empty: 4 x 0 pixels");
}

TEST(RigidTransform, Apply_RotatesThenTranslates) {
    RigidTransform transform;
    transform.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
    transform.translation = Vec3(10, 20, 30);
    EXPECT_EQ(transform.apply(Vec3(1, 2, 3)), Vec3(8, 21, 33));
}

}  // namespace
}  // namespace scanmill::test
