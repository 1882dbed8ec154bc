// SPDX-License-Identifier: GPL-3.0-or-later
// Values as files: every bit comes back, equal values are equal bytes, and what is not whole is refused.

#include "scanmill/cache/value_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "scanmill/filter/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

const double nan = std::numeric_limits<double>::quiet_NaN();
const double infinity = std::numeric_limits<double>::infinity();

template <class T>
Value value(T object) {
    return std::make_shared<const T>(std::move(object));
}

Frame some_frame() { return {LengthUnit::millimetre, Vec3(1e6, -0.0, 0.1), "part \xff \"A\""}; }

PointCloud cloud() {
    PointCloud cloud;
    cloud.frame = some_frame();
    cloud.positions = {Vec3(0, -0.0, nan), Vec3(infinity, 1e-310, 0.1 + 0.2)};
    cloud.columns.add(Column("colour", 3, Buffer<u8>{1, 2, 3, 4, 5, 6}));
    cloud.columns.add(Column("numbers", Buffer<u64>{0, 0, 3}, Buffer<std::int16_t>{-1, 7, 8}));
    cloud.columns.add(Column("weight", 1, Buffer<float>{0.5f, std::numeric_limits<float>::quiet_NaN()}));
    return cloud;
}

TriangleMesh mesh() {
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

TetMesh tets() {
    TetMesh tets;
    tets.frame = some_frame();
    tets.positions = mesh().positions;
    tets.cells = {Tetrahedron{0, 1, 2, 3}};
    tets.neighbours = {std::array<u32, 4>{~0u, ~0u, ~0u, ~0u}};
    tets.inside = {1};
    tets.weights = {0, -0.0, 0.1 + 0.2, 1e-310};
    return tets;
}

FeatureGraph features() {
    FeatureGraph graph;
    graph.frame = some_frame();
    graph.positions = mesh().positions;
    graph.polylines = {{FeatureType::hole, true, 0, 3}, {FeatureType::crease, false, 3, 4}};
    graph.vertices = {0, 1, 2, 3};
    graph.left_normals = graph.right_normals = Buffer<Vec3>(Array<Vec3>(4, Vec3(0, 0, 1)));
    graph.corners = {3};
    return graph;
}

RigidTransform transform() {
    RigidTransform transform;
    transform.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    transform.translation = Vec3(0.1, 1e300, -0.0);
    transform.unit = LengthUnit::inch;
    transform.from = "a";
    return transform;
}

Metrics metrics() {
    return {{{"rms", nan, Unit::length}, {"faces", 1e17, Unit::count}, {"gap", -infinity, Unit::ratio}}};
}

std::vector<Value> one_of_each_kind() {
    return {value(cloud()), value(mesh()), value(tets()), value(features()), value(transform()), value(metrics())};
}

template <class T>
const T& as(const Value& value) {
    return *std::get<std::shared_ptr<const T>>(value);
}

template <class T>
bool same_bits(const Buffer<T>& a, const Buffer<T>& b) {
    return std::ranges::equal(std::as_bytes(a.span()), std::as_bytes(b.span()));
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

/// Of everything that the value holds.
std::string key_of(const Value& value) { return EncodedValue(value).content(); }

class ValueFile : public testing::Test {
protected:
    Value through_a_file(const Value& value) {
        EncodedValue(value).write(folder_ / "value");
        return read_value(folder_ / "value");
    }
    TemporaryFolder folder_;
};

TEST_F(ValueFile, EveryKind_ComesBackWithItsContent) {
    for (const Value& each : one_of_each_kind()) {
        const Value back = through_a_file(each);
        EXPECT_EQ(kind_of(back), kind_of(each));
        EXPECT_EQ(key_of(back), key_of(each)) << name_of(kind_of(each));
        EXPECT_EQ(std::filesystem::file_size(folder_ / "value"), EncodedValue(each).size());
    }
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

TEST_F(ValueFile, TransformAndMetrics_ComeBackBitByBit) {
    const Value transform_back = through_a_file(value(transform()));
    const auto& read = as<RigidTransform>(transform_back);
    EXPECT_EQ(read.rotation, transform().rotation);
    EXPECT_EQ(read.translation, transform().translation);
    EXPECT_TRUE(std::signbit(read.translation.z()));
    EXPECT_EQ(read.unit, LengthUnit::inch);
    EXPECT_EQ(read.from, "a");
    EXPECT_EQ(read.to, "");
    const Value metrics_back = through_a_file(value(metrics()));
    EXPECT_TRUE(std::isnan(as<Metrics>(metrics_back).find("rms")->value));
    EXPECT_EQ(as<Metrics>(metrics_back).find("gap")->value, -infinity);
    EXPECT_EQ(as<Metrics>(metrics_back).find("faces")->unit, Unit::count);
}

TEST_F(ValueFile, EqualValues_AreEqualBytes_WhereverTheirMemoryIs) {
    EncodedValue(value(mesh())).write(folder_ / "one");
    EncodedValue(through_a_file(value(mesh()))).write(folder_ / "other");
    EXPECT_EQ(content_of(folder_ / "one"), content_of(folder_ / "other"));
}

TEST(ValueContent, AnyChange_IsAnotherContent) {
    const auto changed = [](auto object, auto&& change) {
        const std::string before = key_of(value(object));
        change(object);
        return key_of(value(object)) != before;
    };
    EXPECT_TRUE(changed(cloud(), [](PointCloud& c) { c.frame.name += "!"; }));
    EXPECT_TRUE(changed(cloud(), [](PointCloud& c) { c.frame.unit = LengthUnit::metre; }));
    EXPECT_TRUE(changed(cloud(), [](PointCloud& c) { c.frame.origin.x() = std::nextafter(1e6, 0); }));
    EXPECT_TRUE(changed(cloud(), [](PointCloud& c) { c.positions = {c.positions[1], c.positions[0]}; }));
    EXPECT_TRUE(changed(cloud(), [](PointCloud& c) { c.columns = {}; }));
    EXPECT_TRUE(changed(tets(), [](TetMesh& t) { t.inside = {0}; }));
    EXPECT_TRUE(changed(tets(), [](TetMesh& t) { t.inside = {}; }));
    EXPECT_TRUE(changed(tets(), [](TetMesh& t) { t.weights = {}; }));
    EXPECT_TRUE(changed(tets(), [](TetMesh& t) { t.weights = {0, 0, 0.1 + 0.2, 1e-310}; }));
    // The same numbers in another shape.
    EXPECT_TRUE(changed(mesh(), [](TriangleMesh& m) { std::swap(m.edges, m.sharp_edges); }));
    EXPECT_TRUE(changed(metrics(), [](Metrics& m) { m.values[0].unit = Unit::number; }));
}

TEST(ValueContent, OfTheSameArrayInTwoKinds_Differs) {
    PointCloud points;
    points.positions = mesh().positions;
    TriangleMesh bare;
    bare.positions = points.positions;
    EXPECT_NE(key_of(value(points)), key_of(value(bare)));
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

TEST_F(ValueFile, AnyByteThatChanged_IsNoticed) {
    for (const Value& each : one_of_each_kind()) {
        EncodedValue(each).write(folder_ / "value");
        const std::string whole = content_of(folder_ / "value");
        for (std::size_t at = 0; at < whole.size(); ++at) {
            // The last eight bytes of the preamble and the zeros behind the header say nothing.
            std::string spoilt = whole;
            spoilt[at] = static_cast<char>(spoilt[at] ^ 0x20);
            folder_.write("spoilt", spoilt);
            try {
                const Value read = read_value(folder_ / "spoilt");
                EXPECT_EQ(key_of(read), key_of(each)) << "byte " << at;
            } catch (const Error& error) {
                EXPECT_THAT(error.sentence(), HasSubstr("spoilt")) << "byte " << at;
            }
        }
    }
}

TEST_F(ValueFile, CutShortAnywhere_IsRefused) {
    EncodedValue(value(mesh())).write(folder_ / "value");
    const std::string whole = content_of(folder_ / "value");
    for (std::size_t size = 0; size < whole.size(); ++size) {
        folder_.write("cut", whole.substr(0, size));
        EXPECT_THROW(read_value(folder_ / "cut"), Error) << size;
    }
}

TEST_F(ValueFile, WhatIsNone_IsRefused) {
    folder_.write("scan.ply", "ply\nformat ascii 1.0\n" + std::string(100, ' '));
    EXPECT_THAT(sentence_of([&] { read_value(folder_ / "scan.ply"); }), HasSubstr("is no value file"));
    EXPECT_THAT(sentence_of([&] { read_value(folder_ / "absent"); }), HasSubstr("there is no such file"));
}

}  // namespace
}  // namespace scanmill::test
