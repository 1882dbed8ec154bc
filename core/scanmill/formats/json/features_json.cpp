// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/json/features_json.hpp"

#include "scanmill/formats/common/writing.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

using Json = nlohmann::ordered_json;

namespace {

Json numbers(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

std::string_view name_of(FeatureType type) {
    switch (type) {
        case FeatureType::outer_boundary: return "outer boundary";
        case FeatureType::hole: return "hole";
        case FeatureType::crease: break;
    }
    return "crease";
}

Json polyline_json(const FeatureGraph& graph, const FeaturePolyline& line) {
    Json points = Json::array(), left = Json::array(), right = Json::array();
    for (u32 row = line.begin; row < line.end; ++row) {
        points.push_back(numbers(world(graph.frame, graph.positions[graph.vertices[row]])));
        if (row + 1 == line.end && !line.closed) break;
        const auto normal = [](const Vec3& n) { return n == Vec3::Zero() ? Json(nullptr) : numbers(n); };
        left.push_back(normal(graph.left_normals[row]));
        right.push_back(normal(graph.right_normals[row]));
    }
    return {{"type", name_of(line.type)},
            {"closed", line.closed},
            {"points", std::move(points)},
            {"left-normals", std::move(left)},
            {"right-normals", std::move(right)}};
}

}  // namespace

Json features_document(const FeatureGraph& graph) {
    const bool is_known = graph.frame.unit != LengthUnit::unknown;
    Json json{{"scanmill", 1},
              {"unit", is_known ? Json(symbol(graph.frame.unit)) : Json(nullptr)},
              {"frame", graph.frame.name.empty() ? Json(nullptr) : Json(graph.frame.name)},
              {"polylines", Json::array()},
              {"corners", Json::array()}};
    for (const FeaturePolyline& line : graph.polylines) json["polylines"].push_back(polyline_json(graph, line));
    for (const u32 corner : graph.corners)
        json["corners"].push_back(numbers(world(graph.frame, graph.positions[corner])));
    return json;
}

void write_features_json(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const FeatureGraph& graph = *std::get<std::shared_ptr<const FeatureGraph>>(value);
    tell_lost_precision(graph.frame, graph.positions.span(), false, "JSON", options);
    // A frame's name may be any bytes; what is no UTF-8 is replaced.
    out.text(features_document(graph).dump(2, ' ', false, Json::error_handler_t::replace));
    out.text("\n");
}

}  // namespace scanmill
