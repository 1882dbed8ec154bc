// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "scanmill/formats/files.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;

/// An open crease 0-1-2 that ends in the corner 2, and a closed hole 2-3-1.
FeatureGraph crease_and_hole() {
    FeatureGraph graph;
    graph.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0.1, 0), Vec3(3, 1, 0)};
    graph.polylines = {{FeatureType::crease, false, 0, 3}, {FeatureType::hole, true, 3, 6}};
    graph.vertices = {0, 1, 2, 2, 3, 1};
    const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ(), none = Vec3::Zero();
    graph.left_normals = {x, y, none, z, z, x};
    graph.right_normals = {y, z, none, none, none, none};
    graph.corners = {2};
    return graph;
}

std::string text_of(const FeatureGraph& graph) {
    return write_bytes("lines.json", std::make_shared<const FeatureGraph>(graph));
}

TEST(FeaturesJson, PolylinesAndCorners_StandInWorldCoordinates_ANormalForEachSegment) {
    FeatureGraph graph = crease_and_hole();
    graph.frame = {LengthUnit::inch, Vec3(0, 0, 8), "part"};
    EXPECT_EQ(json::parse(text_of(graph)), json::parse(R"({
        "scanmill": 1, "unit": "in", "frame": "part",
        "polylines": [
            {"type": "crease", "closed": false, "points": [[0, 0, 8], [1, 0, 8], [2, 0.1, 8]],
             "left-normals": [[1, 0, 0], [0, 1, 0]], "right-normals": [[0, 1, 0], [0, 0, 1]]},
            {"type": "hole", "closed": true, "points": [[2, 0.1, 8], [3, 1, 8], [1, 0, 8]],
             "left-normals": [[0, 0, 1], [0, 0, 1], [1, 0, 0]], "right-normals": [null, null, null]}],
        "corners": [[2, 0.1, 8]]})"));
}

TEST(FeaturesJson, WithoutUnitAndFrame_HasNullThere) {
    const json document = json::parse(text_of(crease_and_hole()));
    EXPECT_TRUE(document.at("unit").is_null());
    EXPECT_TRUE(document.at("frame").is_null());
}

TEST(FeaturesJson, WithoutALine_SayThatThereIsNone) {
    const json document = json::parse(text_of(FeatureGraph()));
    EXPECT_EQ(document.at("polylines"), json::array());
    EXPECT_EQ(document.at("corners"), json::array());
}

TEST(FeaturesJson, FrameNameThatIsNoUtf8_IsStillJson) {
    FeatureGraph graph = crease_and_hole();
    graph.frame.name = "a\xff";
    EXPECT_TRUE(json::parse(text_of(graph)).at("frame").is_string());
}

}  // namespace
}  // namespace scanmill::test
