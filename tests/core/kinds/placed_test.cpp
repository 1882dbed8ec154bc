// SPDX-License-Identifier: GPL-3.0-or-later
/// Values moved by a pose.
#include "scanmill/kinds/value.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "support/point_sets.hpp"
#include "support/poses.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::HasSubstr;

Value points(Array<Vec3> positions, Frame frame = {}, ColumnTable columns = {}) {
    return std::make_shared<const PointCloud>(PointCloud{frame, std::move(positions), std::move(columns)});
}

const PointCloud& cloud(const Value& value) { return *value.get<PointCloud>(); }

Vec3 world(const PointCloud& points, std::size_t row) { return points.frame.origin + points.positions[row]; }

/// x to y, y to -x, then along.
RigidTransform quarter_turn(const Vec3& translation = Vec3::Zero()) {
    RigidTransform pose;
    pose.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    pose.translation = translation;
    return pose;
}

Column normals(auto numbers) {
    using Number = typename decltype(numbers)::value_type;
    return Column("normal", 3, Buffer<Number>(std::move(numbers)));
}

TEST(Placed, ByTheIdentity_KeepsEveryBit) {
    const Frame frame{LengthUnit::millimetre, Vec3(-0.0, 1e6, 0.1), "lab"};
    const double nan = std::nan("");
    const Value before = points({{-0.0, 0.1, 1e-300}, {nan, -INFINITY, 3}}, frame);
    const Value after = placed(before, {});
    EXPECT_EQ(std::memcmp(cloud(before).positions.data(), cloud(after).positions.data(), 2 * sizeof(Vec3)), 0);
    EXPECT_EQ(cloud(after).frame, frame);
}

TEST(Placed, ByAQuarterTurn_PointsLieWhereTheHandPutsThem) {
    const Value value = placed(points({{1, 2, 3}, {-4, 0, 0.5}}, {LengthUnit::unknown, Vec3(10, 0, 0), "scanner"}),
                               quarter_turn(Vec3(100, 200, 300)));
    EXPECT_EQ(world(cloud(value), 0), Vec3(98, 211, 303));
    EXPECT_EQ(world(cloud(value), 1), Vec3(100, 206, 300.5));
    EXPECT_EQ(cloud(value).frame.name, "scanner") << "the pose names no frame";
}

TEST(Placed, PoseWithAFrame_NamesIt) {
    RigidTransform pose;
    pose.to = "part";
    EXPECT_EQ(cloud(placed(points({{1, 2, 3}}, {LengthUnit::unknown, Vec3::Zero(), "scanner"}), pose)).frame.name,
              "part");
}

TEST(Placed, FarFromZero_KeepsMicrometres) {
    RigidTransform pose;
    const double angle = 0.3;
    pose.rotation << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
    pose.translation = Vec3(-2e6, 5e6, 0);
    pose.unit = LengthUnit::metre;
    const Frame frame{LengthUnit::metre, Vec3(1e6, 2e6, 300), "grid"};
    const Value value = placed(points({{0, 0, 0}, {1e-6, 0, 0}, {0.25, -0.5, 0}}, frame), pose);
    const Buffer<Vec3>& moved = cloud(value).positions;
    EXPECT_NEAR((moved[1] - moved[0]).norm(), 1e-6, 1e-18);
    EXPECT_NEAR((moved[2] - moved[0]).norm(), std::sqrt(0.3125), 1e-15);
    EXPECT_LT((cloud(value).frame.origin - pose.apply(frame.origin)).norm(), 1e-9);
}

TEST(Placed, ByAPoseAndItsInverse_ComesBack) {
    RigidTransform pose;
    const double angle = 1.1;
    pose.rotation << 1, 0, 0, 0, std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle);
    pose.translation = Vec3(12, -7, 0.5);
    const Value before = points({{1, 2, 3}, {-4, 5, 6}, {0, 0, 10}}, {LengthUnit::unknown, Vec3(40, 50, 60), ""});
    const Value after = placed(placed(before, pose), inverse_of(pose));
    for (std::size_t row = 0; row < 3; ++row)
        EXPECT_LT((world(cloud(before), row) - world(cloud(after), row)).norm(), 1e-12 * 100);
}

TEST(Placed, Normals_TurnButDoNotMove) {
    ColumnTable columns;
    columns.add(normals(Array<float>{1, 0, 0, 0, 0, 1}));
    columns.add(Column("axis", 3, Buffer<double>{1, 0, 0, 0, 0, 1}));
    const Value value = placed(points({{1, 2, 3}, {0, 0, 0}}, {}, columns), quarter_turn(Vec3(5, 5, 5)));
    const Column& turned = *cloud(value).columns.find("normal");
    EXPECT_EQ(turned.type(), ScalarType::float32);
    EXPECT_THAT(turned.values<float>(), testing::ElementsAre(0, 1, 0, 0, 0, 1));
    EXPECT_EQ(*cloud(value).columns.find("axis"), *columns.find("axis")) << "only columns of directions are rotated";
}

TEST(Placed, ApproachesAndNormalsOfCorners_TurnLikeNormals) {
    ColumnTable columns;
    columns.add(Column("approach", 3, Buffer<double>{1, 0, 0}));
    columns.add(Column("corner-normals", 9, Buffer<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    columns.add(Column("corner-normals-of-another-shape", 3, Buffer<double>{1, 0, 0}));
    const Value value = placed(points({{1, 2, 3}}, {}, columns), quarter_turn(Vec3(5, 5, 5)));
    const auto numbers = [&](const char* name) {
        const auto values = cloud(value).columns.find(name)->values<double>();
        return std::vector<double>(values.begin(), values.end());
    };
    EXPECT_EQ(numbers("approach"), std::vector<double>({0, 1, 0}));
    EXPECT_EQ(numbers("corner-normals"), std::vector<double>({0, 1, 0, -1, 0, 0, 0, 0, 1}));
    EXPECT_EQ(numbers("corner-normals-of-another-shape"), std::vector<double>({1, 0, 0}));
}

TEST(Placed, NormalsOfIntegers_BecomeDoubles) {
    ColumnTable columns;
    columns.add(normals(Array<std::int8_t>{1, 0, 0}));
    const Column turned = *cloud(placed(points({{1, 2, 3}}, {}, columns), quarter_turn())).columns.find("normal");
    EXPECT_THAT(turned.values<double>(), testing::ElementsAre(0, 1, 0));
}

TEST(Placed, Mesh_MovesWithTheNormalsOfItsVerticesAndFaces) {
    TriangleMesh mesh;
    mesh.positions = Array<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = Array<Triangle>{{0, 1, 2}};
    mesh.sharp_edges = Array<Edge>{{0, 1}};
    mesh.vertex_columns.add(normals(Array<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    mesh.face_columns.add(normals(Array<double>{0, 1, 0}));
    const Value value = placed(std::make_shared<const TriangleMesh>(mesh), quarter_turn(Vec3(0, 0, 1)));
    const TriangleMesh& moved = *value.get<TriangleMesh>();
    EXPECT_EQ(moved.positions[1], Vec3(0, 1, 0));
    EXPECT_EQ(moved.positions[2], Vec3(-1, 0, 0));
    EXPECT_EQ(moved.frame.origin, Vec3(0, 0, 1));
    EXPECT_EQ(moved.triangles[0], mesh.triangles[0]);
    EXPECT_EQ(moved.sharp_edges.size(), 1u);
    EXPECT_THAT(moved.vertex_columns.find("normal")->values<double>(),
                testing::ElementsAre(0, 1, 0, -1, 0, 0, 0, 0, 1));
    EXPECT_THAT(moved.face_columns.find("normal")->values<double>(), testing::ElementsAre(-1, 0, 0));
}

TEST(Placed, PoseInAnotherUnit_IsConverted) {
    RigidTransform pose;
    pose.translation = Vec3(0.5, 0, 0);
    pose.unit = LengthUnit::metre;
    const Value value = placed(points({{1, 2, 3}}, {LengthUnit::millimetre, Vec3::Zero(), ""}), pose);
    EXPECT_EQ(world(cloud(value), 0), Vec3(501, 2, 3));
    EXPECT_EQ(cloud(value).frame.unit, LengthUnit::millimetre);
}

TEST(Placed, PoseInAUnitThatTheScanLacks_IsRefusedWithTheWayOut) {
    RigidTransform pose;
    pose.unit = LengthUnit::metre;
    const Error error = error_of([&] { placed(points({{1, 2, 3}}), pose); });
    EXPECT_EQ(error.sentence(), "the pose is in m; the unit of the scan is not declared");
    EXPECT_EQ(error.remedy(), Remedy::declare_unit);
}

TEST(Placed, PoseOutOfThisWorld_IsRefused) {
    RigidTransform pose;
    pose.translation = Vec3(1.5e308, 0, 0);
    EXPECT_THAT(sentence_of([&] {
                    placed(points({{1, 2, 3}}, {LengthUnit::unknown, Vec3(1.5e308, 0, 0), ""}), pose);
                }),
                HasSubstr("which is outside the range of a coordinate"));
}

TEST(Placed, OtherKinds_AreRefused) {
    EXPECT_EQ(sentence_of([] { placed(std::make_shared<const Metrics>(), {}); }),
              "a pose moves values with positions; this is metrics");
}

}  // namespace
}  // namespace scanmill::test
