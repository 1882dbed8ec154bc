// SPDX-License-Identifier: GPL-3.0-or-later
#include "sculpt/sculpt.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/mesh/doubtful_surface.hpp"
#include "scanmill/geometry/mesh/handles.hpp"
#include "scanmill/geometry/mesh/noisy_normals.hpp"
#include "sculpt/sculptor.hpp"

namespace scanmill {

namespace {

using namespace sculpting;

/// Removing more than this share of the cells is not a local improvement.
constexpr double most_removed = 0.5;

void require_usable(const TetMesh& tets, const SculptParams& params) {
    if (tets.cells.empty()) throw Error("needs a tetrahedralisation with cells; this one has none");
    if (tets.neighbours.size() != tets.cells.size())
        throw Error("needs the neighbours of all {} cells; there are {}", tets.cells.size(), tets.neighbours.size())
            .hint("'delaunay' computes them");
    if (tets.inside.empty())
        throw Error("needs cells labelled inside or outside; none of the {} is labelled", tets.cells.size())
            .hint("put 'alpha-solid' or 'tight-cocone' between 'delaunay' and 'sculpt'");
    if (tets.inside.size() != tets.cells.size())
        throw Error("needs the labels of all {} cells; there are {}", tets.cells.size(), tets.inside.size());
    const double gain = params.min_gain.in_radians();
    if (!(gain >= 0 && std::isfinite(gain)))
        throw Error("min-gain must be an angle of at least 0; it is {}", params.min_gain.text());
}

void require_manifold(const BoundaryDefects& defects, std::size_t triangles) {
    if (defects.vertices.empty()) return;
    throw Error(
        "needs a solid whose boundary is a 2-manifold; among its {} triangles, {} more than two of them, and at {} "
        "(first {}) they do not form one closed fan",
        triangles, count_text(defects.edges, "edge has", "edges have"),
        count_text(defects.vertices.size(), "vertex", "vertices"), defects.vertices.front())
        .hint("'alpha-solid: {alpha: auto}' and 'tight-cocone' give a manifold boundary");
}

/// Number of vertices in cells labelled 1.
std::size_t covered_vertices(const TetMesh& tets, std::span<const u8> labels) {
    Array<u8> covered(tets.positions.size());
    std::ranges::fill(covered, u8(0));
    for (std::size_t cell = 0; cell < labels.size(); ++cell)
        if (labels[cell] == 1)
            for (u32 vertex : tets.cells[cell]) covered[vertex] = 1;
    return static_cast<std::size_t>(std::ranges::count(covered, u8(1)));
}

void run_all(Sculptor& sculptor, Context& context) {
    const std::size_t at_start = sculptor.interior_points();
    for (std::size_t steps = 1; sculptor.step(); ++steps) {
        if (steps % 1024 != 0) continue;
        context.check_cancelled();
        if (at_start > 0)
            context.progress(0.9 -
                             0.6 * static_cast<double>(sculptor.interior_points()) / static_cast<double>(at_start));
    }
}

void sort_by_reason(SculptResult& result, Openings& openings) {
    for (u32 vertex : openings.interior_points())
        (openings.reason(vertex) == Openings::Reason::blocked ? result.blocked_points : result.deep_points)
            .push_back(vertex);
}

void count_steps(SculptResult& result, const Gains& gains) {
    for (const SculptRemoval& removal : result.removals) {
        ++(removal.step == SculptStep::exposing    ? result.exposing
           : removal.step == SculptStep::smoothing ? result.smoothing
                                                   : result.opening);
        result.volume_removed += gains.volume(removal.cell);
    }
}

/// Returns a text such as "(1, 2, 3), (4, 5, 6) …" in world coordinates, the lowest indices first.
std::string positions_of_first(const TetMesh& tets, const Array<u32>& vertices) {
    constexpr std::size_t most = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(most, vertices.size()); ++i) {
        const Vec3 p = tets.frame.origin + tets.positions[vertices[i]];
        text += fmt::format("{}({:.6g}, {:.6g}, {:.6g})", i > 0 ? ", " : "", p.x(), p.y(), p.z());
    }
    return text + (vertices.size() > most ? " …" : "");
}

void warn_about(const SculptResult& result, std::size_t cells_before, Context& context) {
    const TetMesh& tets = result.tets;
    if (!result.blocked_points.empty())
        context.warn(fmt::format(
            "{} of {} points {} inside the solid at {}: if a cell over such a point were removed, the boundary would "
            "touch itself or a point would be outside; the sampling is too sparse or too noisy there",
            result.blocked_points.size(), tets.positions.size(),
            by_count(result.blocked_points.size(), "stays", "stay"), positions_of_first(tets, result.blocked_points)));
    if (!result.deep_points.empty())
        context.warn(fmt::format(
            "{} of {} points {} inside the solid, more than two cells below its boundary: at {}; a smaller alpha "
            "may reach {}",
            result.deep_points.size(), tets.positions.size(), by_count(result.deep_points.size(), "stays", "stay"),
            positions_of_first(tets, result.deep_points), by_count(result.deep_points.size(), "it", "them")));
    if (static_cast<double>(result.removals.size()) > most_removed * static_cast<double>(cells_before))
        context.doubt(fmt::format(
            "{} of {} cells had to be removed: the points fill the solid rather than sample its surface, or the "
            "solid is far too large for them; check the result before using it",
            result.removals.size(), cells_before));
    for (std::string& doubt : doubts_about_surface(result.mesh, result.noise)) context.doubt(std::move(doubt), "mesh");
    for (std::string& doubt : doubts_about_handles(result.mesh, context)) context.doubt(std::move(doubt), "mesh");
}

void report(const SculptResult& result, std::size_t cells_before, Context& context) {
    const auto count = [&](std::string_view name, std::size_t number) {
        context.metric(name, static_cast<double>(number));
    };
    count("removed", result.removals.size());
    count("removed-exposing", result.exposing);
    count("removed-smoothing", result.smoothing);
    count("removed-opening", result.opening);
    context.metric("removed-share", static_cast<double>(result.removals.size()) / static_cast<double>(cells_before),
                   Unit::ratio);
    context.metric("volume-removed", result.volume_removed, Unit::volume);
    context.metric("bending-before", result.bending_before, Unit::angle);
    context.metric("bending-after", result.bending_after, Unit::angle);
    count("interior-points", result.blocked_points.size() + result.deep_points.size());
    count("interior-blocked", result.blocked_points.size());
    count("interior-deep", result.deep_points.size());
    count("outside-points", result.outside_points);
    count("triangles", result.mesh.triangles.size());
    context.metric("noise", result.noise, Unit::length);
}

}  // namespace

SculptResult sculpt(const TetMesh& tets, const SculptParams& params, Context& context) {
    require_usable(tets, params);
    const unsigned threads = context.threads();
    const std::size_t points = tets.positions.size();
    Array<u8> labels(tets.cells.size());
    std::ranges::transform(tets.inside, labels.begin(), [](u8 label) { return u8(label != 0); });
    const std::size_t cells_before = static_cast<std::size_t>(std::ranges::count(labels, u8(1)));
    if (cells_before == 0) throw Error("needs a cell inside the solid; all {} are outside", tets.cells.size());

    SculptResult result;
    result.tets = tets;
    Array<Triangle> triangles = boundary_triangles(tets, labels, threads);
    std::size_t on_boundary = 0;
    {
        BoundaryLinks links(triangles, points, threads);
        require_manifold(boundary_defects(links, threads), triangles.size());
        for (std::size_t vertex = 0; vertex < points; ++vertex) on_boundary += !links.of(vertex).empty();
        result.bending_before = total_bending(links, tets.positions.span(), threads);
    }
    const std::size_t covered = covered_vertices(tets, labels);
    result.outside_points = points - covered;
    context.progress(0.2);
    context.check_cancelled();

    CarvedSolid solid(tets, std::move(labels), triangles);
    Sculptor sculptor(solid, params, covered - on_boundary, threads);
    context.progress(0.3);
    run_all(sculptor, context);
    if (sculptor.interior_points() > 0) sort_by_reason(result, sculptor.openings());
    result.removals = sculptor.take_removals();
    count_steps(result, sculptor.criteria().gains());

    labels = solid.take_labels();
    triangles = boundary_triangles(tets, labels, threads);
    {
        BoundaryLinks links(triangles, points, threads);
        result.bending_after = total_bending(links, tets.positions.span(), threads);
    }
    result.mesh = boundary_mesh(tets, std::move(triangles));
    result.tets.inside = std::move(labels);
    result.noise = vertex_noise(result.mesh, half_edges::opposites(result.mesh), context);
    warn_about(result, cells_before, context);
    report(result, cells_before, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
