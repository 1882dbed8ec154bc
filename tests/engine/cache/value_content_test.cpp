// SPDX-License-Identifier: GPL-3.0-or-later
// What a value is known by: equal values are equal bytes, and any change is another content.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/cache/value_samples.hpp"

namespace scanmill::test {
namespace {

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

}  // namespace
}  // namespace scanmill::test
