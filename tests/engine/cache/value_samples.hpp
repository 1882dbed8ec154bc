// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A value of each kind, with numbers that are easily lost, and a file for them.

#include <gtest/gtest.h>

#include <limits>

#include "scanmill/cache/value_file.hpp"
#include "support/numbers.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

template <class T>
Value value(T object) {
    return std::make_shared<const T>(std::move(object));
}

inline Frame some_frame() { return {LengthUnit::millimetre, Vec3(1e6, -0.0, 0.1), "part \xff \"A\""}; }

inline PointCloud cloud() {
    PointCloud cloud;
    cloud.frame = some_frame();
    cloud.positions = {Vec3(0, -0.0, nan), Vec3(infinity, 1e-310, 0.1 + 0.2)};
    cloud.columns.add(Column("colour", 3, Buffer<u8>{1, 2, 3, 4, 5, 6}));
    cloud.columns.add(Column("numbers", Buffer<u64>{0, 0, 3}, Buffer<std::int16_t>{-1, 7, 8}));
    cloud.columns.add(Column("weight", 1, Buffer<float>{0.5f, std::numeric_limits<float>::quiet_NaN()}));
    return cloud;
}

inline TriangleMesh mesh() {
    TriangleMesh mesh;
    mesh.frame = some_frame();
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    mesh.triangles = {Triangle{0, 2, 1}, Triangle{0, 1, 3}};
    mesh.vertex_columns.add(Column("normal", 3, Buffer<double>(Array<double>(12, 0.25))));
    mesh.face_columns.add(Column("solid", 1, Buffer<u32>{7, 8}));
    mesh.edges = {Edge{0, 1}};
    mesh.edge_columns.add(Column("confidence", 1, Buffer<std::int64_t>{std::int64_t(-9007199254740993)}));
    mesh.sharp_edges = {Edge{0, 1}, Edge{1, 2}};
    return mesh;
}

inline TetMesh tets() {
    TetMesh tets;
    tets.frame = some_frame();
    tets.positions = mesh().positions;
    tets.cells = {Tetrahedron{0, 1, 2, 3}};
    tets.neighbours = {std::array<u32, 4>{~0u, ~0u, ~0u, ~0u}};
    tets.inside = {1};
    tets.weights = {0, -0.0, 0.1 + 0.2, 1e-310};
    return tets;
}

inline PatchComplex patches() {
    PatchComplex patches;
    patches.frame = some_frame();
    patches.positions = mesh().positions;
    patches.tets = {std::array<u32, 4>{0, 1, 2, 3}};
    PatchWeights weights{};
    weights[1] = 0.1 + 0.2;
    weights[2] = -0.0;
    weights[19] = 1e-310;
    patches.weights = {weights};
    patches.kinds = {PatchKind::edge};
    patches.sides = {1};
    patches.triangles = {7};
    patches.edges = {PatchComplex::no_edge};
    patches.combine = {Combine::none};
    patches.partners = {PatchComplex::no_partner};
    return patches;
}

inline FeatureGraph features() {
    FeatureGraph graph;
    graph.frame = some_frame();
    graph.positions = mesh().positions;
    graph.polylines = {{FeatureType::hole, true, 0, 3}, {FeatureType::crease, false, 3, 4}};
    graph.vertices = {0, 1, 2, 3};
    graph.left_normals = graph.right_normals = Buffer<Vec3>(Array<Vec3>(4, Vec3(0, 0, 1)));
    graph.corners = {3};
    return graph;
}

inline ProbePlan probes() {
    ProbePlan plan;
    plan.frame = some_frame();
    plan.touches.resize(2);
    plan.touches[0].position = Vec3(-0.0, 0.1 + 0.2, 1e-310);
    plan.touches[0].start = Vec3(1, 2, 3);
    plan.touches[0].assumed = true;
    plan.touches[0].phi_min = -0.5;
    plan.touches[0].phi_max = 0.1 + 0.2;
    plan.touches[1].touch = 7;
    plan.touches[1].reason = ProbeReason::obstructed;
    plan.moves = {{ProbeMoveType::retract, 1, {Vec3(4, 5, 6), Vec3(7, -0.0, 9)}},
                  {ProbeMoveType::approach, 0, {}},
                  {ProbeMoveType::clearance, 0, {Vec3(1, 2, 3)}}};
    plan.radius = 0.1 + 0.2;
    plan.machine_axis = Vec3(0, -0.0, -1);
    return plan;
}

inline RigidTransform motion() {
    RigidTransform transform;
    transform.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    transform.translation = Vec3(0.1, 1e300, -0.0);
    transform.unit = LengthUnit::inch;
    transform.from = "a";
    transform.rms = 0.1 + 0.2;
    return transform;
}

inline Transforms transforms() {
    Transforms transforms(motion());
    RigidTransform second = motion();
    second.from = "b \xff";
    second.rms.reset();
    second.translation = Vec3(-0.0, 1e-310, 1. / 3);
    transforms.motions.push_back(second);
    transforms.refused = {{"c", "no-overlap: at most 12 %"}};
    transforms.edges = {{second, 0.1 + 0.2, 5e-324, -0.0, 1. / 3, 0.7}, {motion(), 1, 0, 0, 0, 1}};
    transforms.edges[0].pose.to = "a";
    return transforms;
}

inline Metrics metrics() {
    return {{{"rms", nan, Unit::length}, {"faces", 1e17, Unit::count}, {"gap", -infinity, Unit::ratio}}};
}

inline Picture picture() { return {3, 2, Array<Colour>(6, Colour{0, 255, 7}), "A \xff caption\n\"of\" two lines"}; }

inline std::vector<Value> one_of_each_kind() {
    return {value(cloud()),  value(mesh()),       value(tets()),    value(features()), value(patches()),
            value(probes()), value(transforms()), value(metrics()), value(picture())};
}

/// The hash of everything that the value holds.
inline std::string key_of(const Value& value) { return EncodedValue(value).content(); }

class ValueFile : public testing::Test {
protected:
    Value through_a_file(const Value& value) {
        EncodedValue(value).write(folder_ / "value");
        return read_value(folder_ / "value");
    }
    TemporaryFolder folder_;
};

}  // namespace scanmill::test
