// SPDX-License-Identifier: GPL-3.0-or-later
#include "tight_cocone/tight_cocone.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "cocone/pinholes.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/mesh/boundary_loops.hpp"
#include "scanmill/geometry/mesh/doubtful_surface.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/handles.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/geometry/tets/incremental_solid.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"
#include "tight_cocone/big_balls.hpp"

namespace scanmill {

using namespace cocones;

namespace {

/// Above this share of the area, a surface that no point shows is worth a warning, and above the second one a doubt.
constexpr double remarkable_share = 0.001, doubtful_share = 0.1;
/// Above this share of unused points, a result is doubtful. Clean dense models leave none; models with grooves, noise
/// and outliers leave more.
constexpr double doubtful_unused = 0.02;

void require_noise(const TightCoconeParams& params) {
    if (params.noise_neighbours < 1 || params.noise_neighbours > 1000)
        throw Error("noise-neighbours must be from 1 to 1000; it is {}", params.noise_neighbours)
            .hint("12 suits most scans");
    if (!(params.noise_factor > 0))
        throw Error("noise-factor must be above 0; it is {}", params.noise_factor).hint("1 suits most scans");
}

/// Adds cells around the vertices where the boundary is not a manifold, those with the smallest circumspheres first,
/// and fills the cavities that they enclose. Returns the number of these vertices.
std::size_t mend(const Diagram& diagram, Array<u8>& labels, Context& context) {
    const TetMesh& tets = diagram.tets;
    const Array<u32> vertices =
        boundary_defects(boundary_triangles(tets, labels, context.threads()), tets.positions.size(), context.threads())
            .vertices;
    if (vertices.empty()) return 0;
    Array<double> squared(tets.cells.size());
    for (std::size_t cell = 0; cell < squared.size(); ++cell)
        squared[cell] = (diagram.centres[cell] - tets.positions[tets.cells[cell][0]]).squaredNorm();
    IncrementalSolid solid(tets, std::move(labels), vertices);
    solid.repair(squared, context);
    labels = solid.labels();
    fill_cavities(tets, labels);
    return vertices.size();
}

/// The loops of an open surface whose edges are all edges of the closed one.
std::size_t spanned_loops(const SurfaceMesh& open, const SpatialTets& spatial, std::span<const Triangle> closed) {
    const TriangleMesh& mesh = open.mesh;
    const std::vector<Array<u32>> loops = boundary_loops(mesh, open.opposite);
    if (loops.empty()) return 0;
    const auto start = [&](u32 h) { return spatial.vertices[half_edges::start(mesh, h)]; };
    const auto edge_of = [&](u32 h) { return make_edge(start(h), start(half_edges::after(h))); };
    std::vector<bool> is_on_loop(mesh.positions.size());
    for (const Array<u32>& loop : loops)
        for (const u32 h : loop) is_on_loop[start(h)] = true;
    std::vector<Edge> edges;
    for (const Triangle& t : closed)
        for (std::size_t k = 0; k < 3; ++k)
            if (is_on_loop[t[k]] && is_on_loop[t[(k + 1) % 3]]) edges.push_back(make_edge(t[k], t[(k + 1) % 3]));
    std::ranges::sort(edges);
    return static_cast<std::size_t>(std::ranges::count_if(loops, [&](const Array<u32>& loop) {
        return std::ranges::all_of(loop, [&](u32 h) { return std::ranges::binary_search(edges, edge_of(h)); });
    }));
}

/// Sums the area of the boundary, and of its facets that are not in the surface. Returns the given vertices of the
/// latter.
std::vector<bool> measure_invented(const SpatialTets& spatial, const Surface& surface, std::span<const u8> labels,
                                   TightCoconeResult& result) {
    const TetMesh& tets = spatial.tets;
    std::vector<bool> is_invented(tets.positions.size());
    for (u32 cell = 0; cell < labels.size(); ++cell)
        for (int i = 0; i < 4 && labels[cell] == 1; ++i) {
            const u32 across = tets.neighbours[cell][static_cast<std::size_t>(i)];
            if (across != TetMesh::outside_hull && labels[across] == 1) continue;
            const Triangle corners = corners_of(tets, {cell, i});
            const double area = area_vector(tets.positions.span(), corners).norm() / 2;
            result.area += area;
            if (surface.facets.contains(cell, i)) continue;
            result.invented_area += area;
            for (const u32 vertex : corners) is_invented[spatial.vertices[vertex]] = true;
        }
    return is_invented;
}

/// `drops_points`: whether the noise mode leaves points out by design.
void warn_about(const TightCoconeResult& result, std::size_t points, bool drops_points,
                const std::function<bool(u32)>& is_invented, Context& context) {
    const double share = result.invented_area / result.area;
    const std::string text = fmt::format(
        "{:.2g} % of the area ({:.4g} of {:.4g} {}²) is not in cocone's surface: it closes {}sharp or sparse parts",
        100 * share, result.invented_area, result.area, symbol(result.tets.frame.unit),
        result.holes_filled > 0 ? count_text(result.holes_filled, "hole", "holes") + " and " : "");
    if (share > doubtful_share)
        context.doubt(text + "; check the result before using it");
    else if (share > remarkable_share)
        context.warn(text);
    if (result.removed_blobs > 0)
        context.warn(fmt::format("{} of good points {} inside the solid and {} left out",
                                 count_text(result.removed_blobs, "connected set", "connected sets"),
                                 by_count(result.removed_blobs, "lies", "lie"),
                                 by_count(result.removed_blobs, "is", "are")));
    const std::string left_out = fmt::format("{} of {} points {} not on the surface", result.unused, points,
                                             by_count(result.unused, "is", "are"));
    if (!drops_points && static_cast<double>(result.unused) > doubtful_unused * static_cast<double>(points))
        context.doubt(left_out + "; thin the scan, or remove its noise and outliers first");
    else if (result.unused > 0)
        context.warn(left_out);
    for (std::string& doubt : doubts_about_surface(result.mesh)) context.doubt(std::move(doubt), "mesh");
    // Handles through good points alone are shown by the sample.
    if (result.poor == 0) return;
    for (std::string& doubt : doubts_about_handles(result.mesh, context, is_invented))
        context.doubt(std::move(doubt), "mesh");
}

void report(const TightCoconeResult& result, Context& context) {
    const auto count = [&](std::string_view name, std::size_t number) {
        context.metric(name, static_cast<double>(number));
    };
    count("good", result.good);
    count("poor", result.poor);
    count("boundary-points", result.boundary_points);
    count("unused-points", result.unused);
    count("triangles", result.mesh.triangles.size());
    count("holes-filled", result.holes_filled);
    context.metric("invented-area", result.invented_area, Unit::area);
    count("removed-blobs", result.removed_blobs);
    count("mended-vertices", result.mended_vertices);
}

}  // namespace

TightCoconeResult tight_cocone(const TetMesh& given, const TightCoconeParams& params, Context& context) {
    require_usable(given, params);
    require_noise(params);
    TightCoconeResult result;
    result.tets = given;
    if (params.noise == TightCoconeParams::Noise::big_balls) {
        const SpatialTets all = in_spatial_order(given, context);
        Array<u32> kept = outer_points(all.tets, params.noise_neighbours, params.noise_factor, context);
        for (u32& vertex : kept) vertex = all.vertices[vertex];
        std::ranges::sort(kept);
        result.tets = tets_of(given, kept, context);
    } else if (params.noise_neighbours != TightCoconeParams().noise_neighbours ||
               params.noise_factor != TightCoconeParams().noise_factor) {
        context.warn("noise-neighbours and noise-factor have no effect while `noise` is none");
    }
    Reconstruction found(result.tets, params, context);
    const SpatialTets& spatial = found.spatial;
    const TetMesh& tets = spatial.tets;
    const Diagram& diagram = found.diagram;
    const Sampling& samples = found.samples;
    const Surface& surface = found.surface;
    Peeling& peeling = found.solid.peeling;
    Array<u8>& labels = peeling.labels;
    result.good = peeling.good;
    result.poor = tets.positions.size() - peeling.good;
    result.boundary_points = samples.boundary_points;
    result.removed_blobs = peeling.enclosed;
    if (std::ranges::count(labels, u8(1)) == 0)
        refuse_empty(tets, samples, surface,
                     fmt::format("; {} points are good and {} poor, and the outside spreads everywhere", result.good,
                                 result.poor),
                     params.noise == TightCoconeParams::Noise::none);
    result.mended_vertices = mend(diagram, labels, context);
    const std::vector<bool> is_invented = measure_invented(spatial, surface, labels, result);
    Array<u8> inside(labels.size());
    for (std::size_t cell = 0; cell < inside.size(); ++cell) inside[cell] = labels[spatial.cells[cell]];
    Array<Triangle> boundary = boundary_triangles(result.tets, inside, context.threads());
    result.tets.inside = std::move(inside);
    result.holes_filled = spanned_loops(found.solid.mesh, spatial, boundary);
    context.check_cancelled();
    std::vector<u32> vertex_of;  // by vertex of the mesh, its vertex in the tetrahedralisation
    {
        std::vector<bool> is_used(tets.positions.size());
        for (const Triangle& triangle : boundary)
            for (const u32 vertex : triangle) is_used[vertex] = true;
        for (u32 vertex = 0; vertex < is_used.size(); ++vertex)
            if (is_used[vertex]) vertex_of.push_back(vertex);
    }
    {
        TriangleMesh whole;
        whole.positions = result.tets.positions;
        whole.triangles = boundary;
        result.tets.vertex_columns =
            with_sampling(result.tets.vertex_columns, spatial, diagram, samples, vertex_area_vectors(whole), context);
    }
    result.mesh = boundary_mesh(result.tets, std::move(boundary));
    result.unused = given.positions.size() - result.mesh.positions.size();

    warn_about(
        result, given.positions.size(), params.noise != TightCoconeParams::Noise::none,
        [&](u32 vertex) { return bool(is_invented[vertex_of[vertex]]); }, context);
    report(result, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
