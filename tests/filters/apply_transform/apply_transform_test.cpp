// SPDX-License-Identifier: GPL-3.0-or-later
/// apply-transform on every kind, and the frames that it refuses. How positions move is tested in
/// tests/core/kinds/placed_test.cpp.

#include "apply_transform/apply_transform.hpp"

#include <gmock/gmock.h>

#include "filters/align/cases.hpp"
#include "support/poses.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// x to y, y to -x, then 10 along x.
RigidTransform to_machine() {
    RigidTransform motion;
    motion.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    motion.translation = Vec3(10, 0, 0);
    motion.from = "scanner";
    motion.to = "machine";
    return motion;
}

Value applied(const Value& value, const Transforms& motion, std::vector<std::string>* warnings = nullptr) {
    Context context;
    Value result = apply_transform(value, motion, context);
    if (warnings) *warnings = context.warnings();
    return result;
}

template <class T>
Value in_frame(T object, std::string name, LengthUnit unit = LengthUnit::unknown) {
    object.frame.name = std::move(name);
    object.frame.unit = unit;
    return std::make_shared<const T>(std::move(object));
}

Vec3 world(const Value& value, std::size_t row) { return frame_of(value)->origin + positions_of(value)[row]; }

Error refusal(const Value& value, const Transforms& motion) {
    const Error error = error_of([&] { applied(value, motion); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error;
}

std::vector<double> numbers(const Column& column) {
    const auto values = column.values<double>();
    return {values.begin(), values.end()};
}

TEST(ApplyTransform, Points_AndTheirDirectionsTurn_OtherColumnsStay) {
    PointCloud points = cloud({{1, 2, 3}});
    points.columns.add(Column("normal", 3, Buffer<double>{1, 0, 0}));
    points.columns.add(Column("approach", 3, Buffer<double>{0, 1, 0}));
    points.columns.add(Column("speed", 3, Buffer<double>{1, 0, 0}));
    const Value value = applied(in_frame(points, "scanner"), to_machine());
    EXPECT_EQ(world(value, 0), Vec3(8, 1, 3));
    EXPECT_EQ(frame_of(value)->name, "machine");
    const ColumnTable& columns = value.get<PointCloud>()->columns;
    EXPECT_THAT(numbers(*columns.find("normal")), ElementsAre(0, 1, 0));
    EXPECT_THAT(numbers(*columns.find("approach")), ElementsAre(-1, 0, 0));
    EXPECT_THAT(numbers(*columns.find("speed")), ElementsAre(1, 0, 0));
}

TEST(ApplyTransform, AMesh_MovesWithTheNormalsOfItsCorners) {
    TriangleMesh mesh = without_triangles(cube(), {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
    mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    const Value value = applied(in_frame(mesh, "scanner"), to_machine());
    for (std::size_t row = 0; row < mesh.positions.size(); ++row)
        EXPECT_EQ(world(value, row), to_machine().apply(mesh.positions[row]));
    EXPECT_EQ(value.get<TriangleMesh>()->triangles.size(), 1u);
    EXPECT_THAT(numbers(*value.get<TriangleMesh>()->face_columns.find("corner-normals")),
                ElementsAre(0, 1, 0, -1, 0, 0, 0, 0, 1));
}

TEST(ApplyTransform, Features_MoveWithTheirNormals) {
    FeatureGraph graph;
    graph.positions = {{0, 0, 0}, {1, 0, 0}};
    graph.polylines = {{FeatureType::crease, false, 0, 2}};
    graph.vertices = {0, 1};
    graph.left_normals = {{0, 1, 0}, {0, 0, 0}};
    graph.right_normals = {{1, 0, 0}, {0, 0, 0}};
    const Value value = applied(in_frame(graph, "scanner"), to_machine());
    const auto moved = value.get<FeatureGraph>();
    EXPECT_EQ(world(value, 1), Vec3(10, 1, 0));
    EXPECT_EQ(moved->left_normals[0], Vec3(-1, 0, 0));
    EXPECT_EQ(moved->right_normals[0], Vec3(0, 1, 0));
    EXPECT_EQ(moved->right_normals[1], Vec3::Zero());
}

TEST(ApplyTransform, PatchesAndTets_KeepTheirNumbers) {
    PatchComplex patches;
    patches.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const Value moved_patches = applied(in_frame(patches, "scanner"), to_machine());
    TetMesh tets;
    tets.positions = patches.positions;
    const Value moved_tets = applied(in_frame(tets, "scanner"), to_machine());
    for (std::size_t row = 0; row < 4; ++row) {
        EXPECT_EQ(world(moved_patches, row), to_machine().apply(patches.positions[row]));
        EXPECT_EQ(world(moved_tets, row), to_machine().apply(patches.positions[row]));
    }
    EXPECT_EQ(frame_of(moved_tets)->name, "machine");
}

TEST(ApplyTransform, Probes_MoveWithTheirDirections) {
    ProbePlan plan;
    ProbeTouch touch;
    touch.position = Vec3(1, 2, 3);
    touch.tangent = touch.approach = Vec3(1, 0, 0);
    touch.start = Vec3(5, 2, 3);
    touch.phi = 0.25;
    plan.touches = {touch};
    plan.moves = {{ProbeMoveType::approach, 0, {{5, 2, 3}, {2, 2, 3}}}};
    plan.machine_axis = Vec3(1, 0, 0);
    plan.radius = 2;
    const Value value = applied(in_frame(plan, "scanner"), to_machine());
    const auto moved = value.get<ProbePlan>();
    EXPECT_EQ(moved->frame.origin + moved->touches[0].position, Vec3(8, 1, 3));
    EXPECT_EQ(moved->frame.origin + moved->touches[0].start, Vec3(8, 5, 3));
    EXPECT_EQ(moved->frame.origin + moved->moves[0].points[1], Vec3(8, 2, 3));
    EXPECT_EQ(moved->touches[0].approach, Vec3(0, 1, 0));
    EXPECT_EQ(moved->touches[0].tangent, Vec3(0, 1, 0));
    EXPECT_EQ(moved->machine_axis, Vec3(0, 1, 0));
    EXPECT_EQ(moved->touches[0].phi, 0.25);
    EXPECT_EQ(moved->radius, 2);
}

TEST(ApplyTransform, ThereAndBack_IsTheSameWithinRounding) {
    Random random(1);
    RigidTransform motion = random_motion(random);
    motion.from = "scanner";
    motion.to = "machine";
    const Value before = in_frame(cloud(plate()), "scanner");
    const Value after = applied(applied(before, motion), inverse_of(motion));
    for (std::size_t row = 0; row < 4; ++row) EXPECT_LT((world(after, row) - world(before, row)).norm(), 1e-12);
    EXPECT_EQ(frame_of(after)->name, "scanner");
}

TEST(ApplyTransform, WhatAlignFound_CarriesTheSourceOntoTheTarget) {
    Random random(2);
    const PointCloud target = cloud(moved(plate(), random_motion(random)), "machine");
    const Aligned found = aligned(cloud(plate(), "scanner"), target);
    const Value value = applied(in_frame(cloud(plate()), "scanner"), found.transform);
    for (std::size_t row = 0; row < 4; ++row) EXPECT_LT((world(value, row) - target.positions[row]).norm(), 1e-11);
}

TEST(ApplyTransform, Twice_IsRefused) {
    const Value once = applied(in_frame(cloud(plate()), "scanner"), to_machine());
    EXPECT_EQ(refusal(once, to_machine()).sentence(),
              "the value is already in the frame 'machine', the target frame of the transform");
    // Also where the transform does not name the frame that it starts from.
    RigidTransform from_anywhere = to_machine();
    from_anywhere.from.clear();
    EXPECT_THAT(refusal(once, from_anywhere).sentence(), HasSubstr("already in the frame 'machine'"));
}

TEST(ApplyTransform, AnotherFrame_IsRefused) {
    EXPECT_EQ(refusal(in_frame(cloud(plate()), "part"), to_machine()).sentence(),
              "the value is in the frame 'part'; the transform starts from 'scanner'");
    RigidTransform within = to_machine();
    within.to = "scanner";
    EXPECT_EQ(refusal(in_frame(cloud(plate()), "part"), within).sentence(),
              "the value is in the frame 'part'; the transform starts from 'scanner'");
}

TEST(ApplyTransform, AListOfMotions_MovesByThatOfTheFrame) {
    Transforms list(to_machine());
    list.motions.push_back(to_machine());
    list.motions[1].from = "second";
    list.motions[1].translation = Vec3(0, 0, 5);
    list.refused = {{"third", "no-overlap"}};
    const PointCloud points = cloud({{1, 2, 3}});
    EXPECT_EQ(world(applied(in_frame(points, "scanner"), list), 0), Vec3(8, 1, 3));
    EXPECT_EQ(world(applied(in_frame(points, "second"), list), 0), Vec3(-2, 1, 8));
    EXPECT_THAT(refusal(in_frame(points, "third"), list).sentence(), HasSubstr("refused: no-overlap"));
    EXPECT_THAT(refusal(in_frame(points, "part"), list).sentence(), HasSubstr("scanner and second"));
    EXPECT_THAT(refusal(in_frame(points, ""), list).sentence(), HasSubstr("no name"));
    EXPECT_EQ(refusal(in_frame(points, "machine"), list).sentence(),
              "the value is already in the frame 'machine', the target frame of the transform");
    // The first view's own frame may be the frame of all.
    list.motions[0].from = "machine";
    EXPECT_EQ(world(applied(in_frame(points, "machine"), list), 0), Vec3(8, 1, 3));
}

TEST(ApplyTransform, AMotionWithinOneFrame_MayBeRepeated) {
    RigidTransform within = to_machine();
    within.to = "scanner";
    const Value twice = applied(applied(in_frame(cloud({{1, 2, 3}}), "scanner"), within), within);
    EXPECT_EQ(world(twice, 0), Vec3(9, 8, 3));
}

TEST(ApplyTransform, WithoutNames_MovesAndNamesTheResult) {
    EXPECT_EQ(frame_of(applied(in_frame(cloud(plate()), ""), to_machine()))->name, "machine");
    RigidTransform to_nowhere = to_machine();
    to_nowhere.to.clear();
    std::vector<std::string> warnings;
    EXPECT_EQ(frame_of(applied(in_frame(cloud(plate()), "scanner"), to_nowhere, &warnings))->name, "");
    EXPECT_THAT(warnings, ElementsAre(AllOf(HasSubstr("does not name"), HasSubstr("'scanner'"))));
}

TEST(ApplyTransform, Units_AreConvertedOrRefused) {
    RigidTransform in_metres = to_machine();
    in_metres.unit = LengthUnit::metre;
    EXPECT_EQ(world(applied(in_frame(cloud({{1, 2, 3}}), "scanner", LengthUnit::millimetre), in_metres), 0),
              Vec3(9998, 1, 3));
    EXPECT_EQ(refusal(in_frame(cloud(plate()), "scanner"), in_metres).sentence(),
              "the pose is in m; the unit of the scan is not declared");
    std::vector<std::string> warnings;
    applied(in_frame(cloud(plate()), "scanner", LengthUnit::millimetre), to_machine(), &warnings);
    EXPECT_THAT(warnings,
                ElementsAre("the transform has no unit; its translation is read in mm, the unit of the value"));
}

TEST(ApplyTransform, MatricesThatAreNotMotions_AreRefused) {
    RigidTransform mirror = to_machine(), endless = to_machine();
    mirror.rotation.row(2) *= -1;
    endless.translation.x() = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal(in_frame(cloud(plate()), "scanner"), mirror).sentence(), HasSubstr("determinant is -1"));
    EXPECT_EQ(refusal(in_frame(cloud(plate()), "scanner"), endless).sentence(),
              "the translation is (inf, 0, 0); it must be finite");
}

TEST(ApplyTransform, KindsWithoutPositions_AreRefused) {
    EXPECT_EQ(refusal(std::make_shared<const Metrics>(), to_machine()).sentence(),
              "the value is metrics, which has no positions");
}

}  // namespace
}  // namespace scanmill::test
