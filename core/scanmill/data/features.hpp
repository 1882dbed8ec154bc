// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `features`: polylines and corners on a mesh, with the surface normals on both sides of every polyline segment.

#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

enum class FeatureType : u8 { outer_boundary, hole, crease };
constexpr std::array<std::string_view, 3> names_of(const FeatureType*) { return {"outer boundary", "hole", "crease"}; }

struct FeaturePolyline {
    FeatureType type;
    /// A closed polyline does not repeat its first vertex; its last segment returns to it.
    bool closed;
    /// The polyline is vertices[begin] … vertices[end - 1] of the graph.
    u32 begin, end;
};
constexpr auto fields(const FeaturePolyline*) {
    return std::tuple{field("type", &FeaturePolyline::type), field("closed", &FeaturePolyline::closed),
                      field("begin", &FeaturePolyline::begin), field("end", &FeaturePolyline::end)};
}

struct FeatureGraph {
    Frame frame;
    /// #vertices, relative to frame.origin.
    Buffer<Vec3> positions;
    std::vector<FeaturePolyline> polylines;
    /// Indices into positions, polyline after polyline.
    Buffer<u32> vertices;
    /// One row per entry of `vertices`: the unit normals left and right of the segment that starts at this vertex. Zero
    /// beyond a boundary, where no surface is, and at the last vertex of an open polyline, where no segment starts.
    Buffer<Vec3> left_normals, right_normals;
    /// Indices into positions, ascending.
    Buffer<u32> corners;
};
constexpr auto fields(const FeatureGraph*) {
    return std::tuple{field("frame", &FeatureGraph::frame),
                      field("positions", &FeatureGraph::positions).means(Meaning::position),
                      field("polylines", &FeatureGraph::polylines),
                      field("vertices", &FeatureGraph::vertices),
                      field("left-normals", &FeatureGraph::left_normals).means(Meaning::direction),
                      field("right-normals", &FeatureGraph::right_normals).means(Meaning::direction),
                      field("corners", &FeatureGraph::corners)};
}

}  // namespace scanmill
