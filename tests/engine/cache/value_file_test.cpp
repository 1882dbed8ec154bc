// SPDX-License-Identifier: GPL-3.0-or-later
// Values as files: every bit comes back.

#include "scanmill/cache/value_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "engine/cache/value_samples.hpp"
#include "support/same_bits.hpp"

namespace scanmill::test {
namespace {

template <class T>
const T& as(const Value& value) {
    return *value.get<T>();
}

void expect_same(const ColumnTable& a, const ColumnTable& b) {
    ASSERT_EQ(a.size(), b.size());
    auto other = b.begin();
    for (const Column& column : a) {
        EXPECT_EQ(column.name(), other->name());
        EXPECT_EQ(column.type(), other->type());
        EXPECT_EQ(column.components(), other->components());
        EXPECT_TRUE(same_bits(column.bytes(), other->bytes()));
        EXPECT_TRUE(same_bits(column.offsets(), other->offsets()));
        ++other;
    }
}

TEST_F(ValueFile, EveryKind_ComesBackWithItsContent) {
    for (const Value& each : one_of_each_kind()) {
        const Value back = through_a_file(each);
        EXPECT_EQ(kind_of(back), kind_of(each));
        EXPECT_EQ(key_of(back), key_of(each)) << name_of(kind_of(each));
        EXPECT_EQ(std::filesystem::file_size(folder_ / "value"), EncodedValue(each).size());
    }
}

TEST_F(ValueFile, Picture_ComesBackWithPixelsAndCaption) {
    const Picture original = picture();
    const Value back = through_a_file(value(original));
    const auto& read = as<Picture>(back);
    EXPECT_EQ(read.width, 3u);
    EXPECT_EQ(read.height, 2u);
    EXPECT_TRUE(same_bits(read.pixels, original.pixels));
    EXPECT_EQ(read.caption, original.caption);
}

TEST_F(ValueFile, MotionWithoutRms_ComesBackWithoutIt) {
    Transforms original(motion());
    EXPECT_EQ(as<Transforms>(through_a_file(value(original))).motions.at(0).rms, 0.1 + 0.2);
    const std::string with = key_of(value(original));
    original.motions[0].rms.reset();
    EXPECT_EQ(as<Transforms>(through_a_file(value(original))).motions.at(0).rms, std::nullopt);
    EXPECT_NE(key_of(value(original)), with);
}

void expect_same(const RigidTransform& a, const RigidTransform& b) {
    EXPECT_EQ(std::memcmp(a.rotation.data(), b.rotation.data(), sizeof a.rotation), 0);
    EXPECT_EQ(std::memcmp(a.translation.data(), b.translation.data(), sizeof a.translation), 0);
    EXPECT_EQ(a.unit, b.unit);
    EXPECT_EQ(a.from, b.from);
    EXPECT_EQ(a.to, b.to);
    EXPECT_EQ(a.rms, b.rms);
}

TEST_F(ValueFile, Transforms_ComeBackBitByBit) {
    const Transforms original = transforms();
    const Value back = through_a_file(value(original));
    const auto& read = as<Transforms>(back);
    ASSERT_EQ(read.motions.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) expect_same(read.motions[i], original.motions[i]);
    ASSERT_EQ(read.refused.size(), 1u);
    EXPECT_EQ(read.refused[0].from, "c");
    EXPECT_EQ(read.refused[0].reason, "no-overlap: at most 12 %");
    ASSERT_EQ(read.edges.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const PoseEdge &a = read.edges[i], &b = original.edges[i];
        expect_same(a.pose, b.pose);
        const auto numbers = [](const PoseEdge& edge) {
            return std::array{edge.overlap, edge.front, edge.missing, edge.slide, edge.score};
        };
        EXPECT_EQ(numbers(a), numbers(b));
        EXPECT_EQ(std::signbit(a.missing), std::signbit(b.missing));
    }
}

TEST_F(ValueFile, TransformsThatDiffer_HaveDifferentKeys) {
    const std::string key = key_of(value(transforms()));
    Transforms other = transforms();
    other.refused[0].reason += " or less";
    EXPECT_NE(key_of(value(other)), key);
    other = transforms();
    other.edges[1].score = 0.5;
    EXPECT_NE(key_of(value(other)), key);
    other = transforms();
    other.motions[1].from = "b";
    EXPECT_NE(key_of(value(other)), key);
}

TEST_F(ValueFile, Points_ComeBackBitByBit) {
    const PointCloud original = cloud();
    const Value back = through_a_file(value(original));
    const auto& read = as<PointCloud>(back);
    EXPECT_EQ(read.frame, original.frame);
    EXPECT_TRUE(std::signbit(read.frame.origin.y()));
    EXPECT_TRUE(same_bits(read.positions, original.positions));
    expect_same(read.columns, original.columns);
    EXPECT_EQ(read.columns.find("numbers")->rows(), 2u);
}

TEST_F(ValueFile, Mesh_ComesBackBitByBit) {
    const TriangleMesh original = mesh();
    const Value back = through_a_file(value(original));
    const auto& read = as<TriangleMesh>(back);
    EXPECT_TRUE(same_bits(read.positions, original.positions));
    EXPECT_TRUE(same_bits(read.triangles, original.triangles));
    EXPECT_TRUE(same_bits(read.edges, original.edges));
    EXPECT_TRUE(same_bits(read.sharp_edges, original.sharp_edges));
    expect_same(read.vertex_columns, original.vertex_columns);
    expect_same(read.face_columns, original.face_columns);
    expect_same(read.edge_columns, original.edge_columns);
}

TEST_F(ValueFile, TetsAndFeatures_ComeBackBitByBit) {
    const Value tets_back = through_a_file(value(tets()));
    EXPECT_EQ(as<TetMesh>(tets_back).cells[0], (Tetrahedron{0, 1, 2, 3}));
    EXPECT_EQ(as<TetMesh>(tets_back).neighbours[0][3], TetMesh::outside_hull);
    EXPECT_EQ(as<TetMesh>(tets_back).inside[0], 1);
    EXPECT_TRUE(same_bits(as<TetMesh>(tets_back).weights, tets().weights));
    const Value graph_back = through_a_file(value(features()));
    const auto& graph = as<FeatureGraph>(graph_back);
    ASSERT_EQ(graph.polylines.size(), 2u);
    EXPECT_EQ(graph.polylines[0].type, FeatureType::hole);
    EXPECT_TRUE(graph.polylines[0].closed);
    EXPECT_EQ(graph.polylines[1].begin, 3u);
    EXPECT_EQ(graph.polylines[1].end, 4u);
    EXPECT_EQ(graph.vertices[3], 3u);
    EXPECT_EQ(graph.left_normals[3], Vec3(0, 0, 1));
}

TEST_F(ValueFile, Metrics_ComeBackBitByBit) {
    const Value metrics_back = through_a_file(value(metrics()));
    EXPECT_TRUE(std::isnan(as<Metrics>(metrics_back).find("rms")->value));
    EXPECT_EQ(as<Metrics>(metrics_back).find("gap")->value, -infinity);
    EXPECT_EQ(as<Metrics>(metrics_back).find("faces")->unit, Unit::count);
}

TEST_F(ValueFile, EmptyArrays_ComeBackEmpty) {
    const Value back = through_a_file(value(PointCloud{}));
    EXPECT_EQ(as<PointCloud>(back).size(), 0u);
    EXPECT_TRUE(as<PointCloud>(back).columns.empty());
}

TEST_F(ValueFile, Arrays_AreAlignedAndOutliveTheFilesName) {
    Value back = through_a_file(value(mesh()));
    std::filesystem::remove(folder_ / "value");
    const Buffer<Triangle> triangles = as<TriangleMesh>(back).triangles;
    back = {};
    EXPECT_EQ(std::bit_cast<std::uintptr_t>(triangles.data()) % 64, 0u);
    EXPECT_EQ(triangles[1], (Triangle{0, 1, 3}));
}

}  // namespace
}  // namespace scanmill::test
