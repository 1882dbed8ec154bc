// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `features`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "frame": "part",
///      "polylines": [{"type": "crease", "closed": false, "points": [[0, 0, 0], [0, 1, 0]],
///                     "left-normals": [[0, 0, 1]], "right-normals": [[1, 0, 0]]}, …],
///      "corners": [[0, 0, 0], [0, 1, 0]]}
///
/// `type` is outer boundary, hole or crease, as in VTP. Points are world coordinates; a closed polyline does not repeat
/// its first point. Every segment has one normal on each side, in order; the last segment of a closed polyline returns
/// to its first point. A normal is null where there is no surface. `unit` and `frame` are null if unknown. Vertices
/// that are in no polyline and not a corner are not written.
#include "scanmill/data/features.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

using Normals = std::vector<std::optional<Vec3>>;

struct PolylineDocument {
    FeatureType type{};
    bool closed = false;
    std::vector<Vec3> points;
    Normals left_normals, right_normals;
};
constexpr auto fields(const PolylineDocument*) {
    using T = PolylineDocument;
    return std::tuple{
        field("type", &T::type), field("closed", &T::closed, "The last segment returns to the first point."),
        field("points", &T::points, "World coordinates."),
        field("left-normals", &T::left_normals, "The normal left of each segment; null if there is no surface."),
        field("right-normals", &T::right_normals, "The normal right of each segment; null if there is no surface.")};
}

struct FeaturesDocument {
    Frame frame;
    std::vector<PolylineDocument> polylines;
    std::vector<Vec3> corners;
};
constexpr auto fields(const FeaturesDocument*) {
    using T = FeaturesDocument;
    return std::tuple{field("frame", &T::frame).flat(), field("polylines", &T::polylines),
                      field("corners", &T::corners, "World coordinates.")};
}

PolylineDocument document_of(const FeatureGraph& graph, const FeaturePolyline& line) {
    PolylineDocument document{line.type, line.closed, {}, {}, {}};
    const auto normal = [](const Vec3& n) { return n == Vec3::Zero() ? std::nullopt : std::optional(n); };
    for (u32 row = line.begin; row < line.end; ++row) {
        document.points.push_back(graph.positions[graph.vertices[row]]);
        if (row + 1 == line.end && !line.closed) break;
        document.left_normals.push_back(normal(graph.left_normals[row]));
        document.right_normals.push_back(normal(graph.right_normals[row]));
    }
    return document;
}

/// Makes a graph from a document. Equal points become one vertex; vertices are numbered in order of their first use.
class GraphMaker {
public:
    FeatureGraph graph_of(const FeaturesDocument& document) {
        graph_.frame = document.frame;
        for (const PolylineDocument& line : document.polylines) add(line, graph_.polylines.size());
        Array<u32> corners;
        for (const Vec3& corner : document.corners) corners.push_back(vertex_at(corner));
        std::ranges::sort(corners);
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

    void add(const PolylineDocument& line, std::size_t index) {
        const std::size_t points = line.points.size(), least = line.closed ? 3 : 2;
        if (points < least)
            throw Error("the document: 'polylines[{}].points' has {}; {} polyline needs at least {}", index, points,
                        line.closed ? "a closed" : "an open", least);
        const auto begin = static_cast<u32>(vertices_.size());
        for (const Vec3& point : line.points) vertices_.push_back(vertex_at(point));
        const std::size_t segments = points - (line.closed ? 0 : 1);
        for (const auto& [key, given, normals] :
             {std::tuple("left", &line.left_normals, &left_), std::tuple("right", &line.right_normals, &right_)}) {
            if (given->size() != segments)
                throw Error("the document: 'polylines[{}].{}-normals' has {}; expected one for each of {} segments",
                            index, key, given->size(), segments);
            for (const std::optional<Vec3>& normal : *given) normals->push_back(normal.value_or(Vec3::Zero()));
            if (!line.closed) normals->push_back(Vec3::Zero());
        }
        graph_.polylines.push_back({line.type, line.closed, begin, static_cast<u32>(vertices_.size())});
    }

    FeatureGraph graph_;
    std::map<std::array<double, 3>, u32> vertex_at_;
    Array<Vec3> positions_, left_, right_;
    Array<u32> vertices_;
};

}  // namespace

template <>
struct KindTraits<FeatureGraph>
    : FromPositions<FeatureGraph>, NoProperties<FeatureGraph>, HasDocument<FeatureGraph, FeaturesDocument> {
    static constexpr std::string_view name = "features";
    static constexpr std::string_view json_member = "polylines";
    static FeaturesDocument document(const FeatureGraph& graph) {
        FeaturesDocument document{graph.frame, {}, {}};
        for (const FeaturePolyline& line : graph.polylines) document.polylines.push_back(document_of(graph, line));
        for (const u32 corner : graph.corners) document.corners.push_back(graph.positions[corner]);
        return document;
    }
    static FeatureGraph object(const FeaturesDocument& document) { return GraphMaker().graph_of(document); }
};

template Kind kind_of<FeatureGraph>();

}  // namespace scanmill
