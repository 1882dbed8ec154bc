// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `features`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "frame": "part",
///      "polylines": [{"type": "crease", "closed": false, "points": [[0, 0, 0], [0, 1, 0]],
///                     "left-normals": [[0, 0, 1]], "right-normals": [[1, 0, 0]]}, …],
///      "corners": [[0, 0, 0], [0, 1, 0]]}
///
/// `type` is outer boundary, hole or crease, as in VTP. Points are world coordinates; a closed polyline does not repeat
/// its first point. Normals belong to segments, one each, in order; the last segment of a closed polyline returns to
/// its first point. A normal is null where there is no surface. `unit` and `frame` are null if unknown. Vertices that
/// are in no polyline and not a corner are not written.
#include "scanmill/data/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind_traits.hpp"

namespace scanmill {

/// For the cache: a row of type, closed, begin, end.
static void to_json(nlohmann::json& json, const FeaturePolyline& line) {
    json = {static_cast<int>(line.type), line.closed, line.begin, line.end};
}
static void from_json(const nlohmann::json& json, FeaturePolyline& line) {
    line = {static_cast<FeatureType>(json.at(0).get<int>()), json.at(1).get<bool>(), json.at(2).get<u32>(),
            json.at(3).get<u32>()};
}

namespace {

constexpr std::array<std::string_view, 3> type_names{"outer boundary", "hole", "crease"};  // by FeatureType

Vec3 world(const FeatureGraph& graph, u32 vertex) { return graph.frame.origin + graph.positions[vertex]; }

Json polyline_json(const FeatureGraph& graph, const FeaturePolyline& line) {
    Json points = Json::array(), left = Json::array(), right = Json::array();
    for (u32 row = line.begin; row < line.end; ++row) {
        points.push_back(json_of(world(graph, graph.vertices[row])));
        if (row + 1 == line.end && !line.closed) break;
        const auto normal = [](const Vec3& n) { return n == Vec3::Zero() ? Json(nullptr) : json_of(n); };
        left.push_back(normal(graph.left_normals[row]));
        right.push_back(normal(graph.right_normals[row]));
    }
    return {{"type", type_names[static_cast<std::size_t>(line.type)]},
            {"closed", line.closed},
            {"points", std::move(points)},
            {"left-normals", std::move(left)},
            {"right-normals", std::move(right)}};
}

/// Reads a document into a graph. Equal points become one vertex; vertices are numbered in order of their first use.
class GraphReader {
public:
    FeatureGraph read(const Json& document) {
        require_document(document, {"scanmill", "unit", "frame", "polylines", "corners"});
        graph_.frame.unit = unit_member(document);
        graph_.frame.name = text_member(document, "frame", "the document");
        for (const Json& json : list_member(document, "polylines", "the document"))
            read_polyline(json, fmt::format("polyline {}", graph_.polylines.size() + 1));
        Array<u32> corners;
        for (const Json& corner : list_member(document, "corners", "the document"))
            corners.push_back(vertex_at(vector_of(corner, "a corner")));
        std::ranges::sort(corners);
        graph_.frame.origin = distant_origin(bounding_box(positions_));
        for (Vec3& p : positions_) p -= graph_.frame.origin;
        graph_.positions = std::move(positions_);
        graph_.vertices = std::move(vertices_);
        graph_.left_normals = std::move(left_);
        graph_.right_normals = std::move(right_);
        graph_.corners = std::move(corners);
        return std::move(graph_);
    }

private:
    u32 vertex_at(const Vec3& p) {
        const auto next = static_cast<u32>(positions_.size());
        const auto [found, is_new] = vertex_at_.emplace(std::array{p.x(), p.y(), p.z()}, next);
        if (is_new) positions_.push_back(p);
        return found->second;
    }

    void read_polyline(const Json& json, const std::string& place) {
        if (!json.is_object()) throw Error("{} is not an object", place);
        require_keys(json, place, {"type", "closed", "points", "left-normals", "right-normals"});
        const std::string type = text_member(json, "type", place);
        const auto found = std::ranges::find(type_names, type);
        if (found == type_names.end())
            throw Error("{}: unknown type '{}'; expected outer boundary, hole or crease", place, type);
        if (!member(json, "closed").is_boolean()) throw Error("{}: 'closed' is not true or false", place);
        FeaturePolyline line{static_cast<FeatureType>(found - type_names.begin()), member(json, "closed").get<bool>(),
                             static_cast<u32>(vertices_.size()), 0};
        const Json& points = list_member(json, "points", place);
        const std::size_t least = line.closed ? 3 : 2;
        if (points.size() < least)
            throw Error("{} has {} points; a {} polyline needs at least {}", place, points.size(),
                        line.closed ? "closed" : "open", least);
        const std::size_t segments = points.size() - (line.closed ? 0 : 1);
        for (const Json& point : points) vertices_.push_back(vertex_at(vector_of(point, place + ": a point")));
        for (const auto& [key, normals] : {std::pair("left-normals", &left_), std::pair("right-normals", &right_)}) {
            const Json& list = list_member(json, key, place);
            if (list.size() != segments)
                throw Error("{} has {} '{}'; expected one for each of its {} segments", place, list.size(), key,
                            segments);
            for (const Json& normal : list)
                normals->push_back(normal.is_null() ? Vec3::Zero() : vector_of(normal, place + ": a normal"));
            if (!line.closed) normals->push_back(Vec3::Zero());
        }
        line.end = static_cast<u32>(vertices_.size());
        graph_.polylines.push_back(line);
    }

    FeatureGraph graph_;
    std::map<std::array<double, 3>, u32> vertex_at_;
    Array<Vec3> positions_, left_, right_;
    Array<u32> vertices_;
};

}  // namespace

template <>
struct KindTraits<FeatureGraph> : FromPositions<FeatureGraph>, NoProperties<FeatureGraph> {
    static constexpr std::string_view name = "features";
    static void visit(FieldVisitor& visitor, FeatureGraph& graph) {
        visitor.frame("frame", graph.frame);
        visitor.positions("positions", graph.positions);
        visitor.small("polylines", graph.polylines);
        visitor.plain("vertices", graph.vertices);
        visitor.directions("left-normals", graph.left_normals);
        visitor.directions("right-normals", graph.right_normals);
        visitor.plain("corners", graph.corners);
    }
    static constexpr std::string_view json_member = "polylines";
    static void to_json(const FeatureGraph& graph, Json& document) {
        document = {{"scanmill", 1},
                    {"unit", unit_json(graph.frame.unit)},
                    {"frame", graph.frame.name.empty() ? Json(nullptr) : Json(graph.frame.name)},
                    {"polylines", Json::array()},
                    {"corners", Json::array()}};
        for (const FeaturePolyline& line : graph.polylines) document["polylines"].push_back(polyline_json(graph, line));
        for (const u32 corner : graph.corners) document["corners"].push_back(json_of(world(graph, corner)));
    }
    static FeatureGraph from_json(const Json& document, const OnWarning&) { return GraphReader().read(document); }
};

template Kind kind_of<FeatureGraph>();

}  // namespace scanmill
