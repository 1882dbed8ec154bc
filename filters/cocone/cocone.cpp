// SPDX-License-Identifier: GPL-3.0-or-later
#include "cocone/cocone.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cocone/pinholes.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/geometry/distance/sides.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill {

using namespace cocones;

namespace {

/// A loop shorter than this many median edges is a gap in the surface rather than the end of the scan.
constexpr double short_loop = 12;
/// A surface is doubtful above one short loop per this many vertices, and above this many at all.
constexpr std::size_t vertices_per_short_loop = 1000, few_short_loops = 3;
/// Above one unused point per this many points, a surface is doubtful.
constexpr std::size_t points_per_unused = 50;

std::size_t short_loops(const CoconeResult& result) {
    const double limit = short_loop * edge_spacing(result.mesh);
    const FeatureGraph& graph = result.features;
    return static_cast<std::size_t>(std::ranges::count_if(graph.polylines, [&](const FeaturePolyline& loop) {
        if (!loop.closed) return false;
        double length = 0;
        for (u32 i = loop.begin; i < loop.end; ++i) {
            const u32 next = i + 1 < loop.end ? i + 1 : loop.begin;
            length += (graph.positions[graph.vertices[i]] - graph.positions[graph.vertices[next]]).norm();
        }
        return length < limit;
    }));
}

void report_gaps(const CoconeResult& result, std::size_t points, Context& context) {
    const std::size_t gaps = short_loops(result);
    if (gaps > few_short_loops && gaps * vertices_per_short_loop > result.mesh.positions.size())
        context.doubt(
            fmt::format("the surface has {} gaps with a boundary shorter than {} median edges: the scan is too noisy "
                        "or too sparse there",
                        gaps, short_loop));
    const std::string text =
        fmt::format("{} of {} points {} in no triangle", result.unused, points, by_count(result.unused, "is", "are"));
    if (points_per_unused * result.unused > points)
        context.doubt(text + "; thin the scan, or remove its noise first");
    else if (result.unused > 0)
        context.warn(text);
}

}  // namespace

CoconeResult cocone(const TetMesh& given, const CoconeParams& params, Context& context) {
    require_usable(given, params);
    Reconstruction found(given, params, context);
    const SpatialTets& spatial = found.spatial;
    const TetMesh& tets = spatial.tets;
    const Sampling& samples = found.samples;
    CoconeResult result;
    result.mesh = std::move(found.solid.mesh.mesh);
    if (result.mesh.triangles.empty()) refuse_empty(tets, samples, found.surface, "");
    context.progress(0.9);
    face_outwards(result.mesh, context);
    Array<Triangle> triangles(result.mesh.triangles.begin(), result.mesh.triangles.end());
    for (Triangle& triangle : triangles)
        for (u32& vertex : triangle) vertex = spatial.vertices[vertex];
    result.mesh.positions = given.positions;
    result.mesh.triangles = std::move(triangles);
    result.mesh.vertex_columns =
        with_sampling(given.vertex_columns, spatial, found.diagram, samples, vertex_area_vectors(result.mesh), context);
    result.mesh = without_unused_vertices(result.mesh);
    result.unused = tets.positions.size() - result.mesh.positions.size();
    result.boundary_points = samples.boundary_points;
    result.pole_flat = samples.pole_flat;
    FeatureLines lines = find_features(
        result.mesh, {.sharp_angle = Angle::degrees(180), .min_length = {}, .noise = Length(0.0)}, context);
    result.loops = lines.counts.boundaries + lines.counts.holes;
    result.features = std::move(lines.graph);
    context.progress(1);

    report_gaps(result, tets.positions.size(), context);
    context.metric("triangles", static_cast<double>(result.mesh.triangles.size()));
    context.metric("boundary-points", static_cast<double>(result.boundary_points));
    context.metric("loops", static_cast<double>(result.loops));
    context.metric("unused-points", static_cast<double>(result.unused));
    context.metric("pole-flat", static_cast<double>(result.pole_flat));
    return result;
}

}  // namespace scanmill
