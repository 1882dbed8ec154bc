// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill_holes/fill_holes.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>
#include <vector>

#include "fill_holes/closing_solid.hpp"
#include "fill_holes/filled_mesh.hpp"
#include "fill_holes/fillings.hpp"
#include "fill_holes/mesh_loops.hpp"
#include "fill_holes/outer_boundaries.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/distance/sides.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/mesh/handles.hpp"

namespace scanmill {

namespace {

constexpr double doubtful_share = 0.05;  // a larger filled share of the whole area is doubtful
constexpr double most_filled = 0.5;  // with a larger filled share, the mesh does not determine a solid

void require_usable(const TriangleMesh& mesh, const FillHolesParams& params) {
    if (params.max_edges && *params.max_edges < 3)
        throw Error("max-edges must be at least 3, because every loop has at least 3 edges; it is {}",
                    *params.max_edges)
            .hint("leave max-edges out to fill loops of any number of edges");
    if (params.max_length && !(params.max_length->value() > 0))
        throw Error("max-length must be above 0; it is {:g} u", params.max_length->value())
            .hint("leave max-length out to fill loops of any length");
    if (params.must_close && (params.max_edges || params.max_length || params.outer == FillHolesParams::Outer::keep))
        throw Error("`closed: required` fills every loop, but {} leaves loops open", params.max_edges ? "max-edges"
                                                                                     : params.max_length
                                                                                         ? "max-length"
                                                                                         : "`outer: keep`")
            .hint("give one of them");
    require_triangles(mesh, "fill-holes needs at least one");
    std::size_t repeats = 0, first = 0;
    for (std::size_t t = mesh.triangles.size(); t-- > 0;)
        if (half_edges::has_repeated_vertex(mesh.triangles[t])) ++repeats, first = t;
    if (repeats > 0)
        throw Error("{} a repeated vertex; the first is triangle {}, with the vertices {}, {} and {}",
                    count_text(repeats, "triangle has", "triangles have"), first, mesh.triangles[first][0],
                    mesh.triangles[first][1], mesh.triangles[first][2])
            .hint("repair drops such triangles");
}

/// Triangulates the loops. No triangulation intersects anything; a hole without a triangulation is open.
Assembly fillings_of(const TriangleMesh& mesh, const MeshLoops& boundary, std::vector<Hole>& holes, Context& context) {
    Assembly all(mesh, {});
    if (holes.empty()) return all;
    const Conflicts conflicts(mesh, holes);
    // The first round takes the most time. The few further rounds each get a part of the remaining progress.
    for (double from = 0, to = 0.7;; from = std::exchange(to, to + (0.8 - to) / 2)) {
        context.check_cancelled();
        std::atomic<std::size_t> done = 0;
        for_each_chunk(context.threads(), holes.size(), 1, [&](std::size_t i, std::size_t) {
            context.check_cancelled();
            if (!holes[i].open && holes[i].triangles.empty()) fill(holes[i], mesh, boundary, context);
            context.progress(from + (to - from) * static_cast<double>(++done) / static_cast<double>(holes.size()));
        });
        conflicts.avoid(holes, context);
        all = Assembly(mesh, holes);
        if (!conflicts.resolve(all, holes, context)) break;
    }
    return all;
}

struct Closed {
    FilledMesh mesh;
    std::size_t replaced;
};

/// The mesh closed as a whole; empty if that is not possible, or if most of the surface would be new.
std::optional<Closed> closed_together(const TriangleMesh& mesh, const FilledMesh& filled, Context& context) {
    const ClosingSolid solid =
        closing_solid(filled.positions, filled.triangles, filled.kept, mesh.frame.origin, context);
    if (solid.triangles.empty()) return std::nullopt;
    Closed closed{filled, 0};
    closed.replaced = replace_triangles(closed.mesh, solid, mesh.positions.size());
    if (closed.mesh.filled_area() > most_filled * closed.mesh.area()) return std::nullopt;
    return closed;
}

void report_doubts(const FillHolesResult& result, double diagonal, std::size_t too_long, double share,
                   Context& context) {
    if (too_long > 0) {
        const std::string_view unit = symbol(result.mesh.frame.unit);
        context.doubt(fmt::format(
            "{} longer than the diagonal of the mesh ({:.6g} {}), but filled; the longest has {:.6g} {}. The "
            "new triangles invent {} as large as the object; `outer: keep` leaves such loops open",
            count_text(too_long, "loop is", "loops are"), diagonal, unit, result.longest, unit,
            by_count(too_long, "a surface", "surfaces")));
    }
    if (share > doubtful_share)
        context.doubt(
            fmt::format("{:.1f} % of the surface is new, more than {:.0f} %; `outer: keep` leaves large loops open",
                        100 * share, 100 * doubtful_share));
    if (result.together > 0)
        context.doubt(fmt::format(
            "{} no triangulation of {} own without intersections: the surface was closed as a whole, which replaced {}",
            count_text(result.together, "loop has", "loops have"), by_count(result.together, "its", "their"),
            count_text(result.replaced, "triangle", "triangles")));
    if (result.failed > 0)
        context.doubt(fmt::format("{} open: no triangulation without intersections was found",
                                  count_text(result.failed, "loop stays", "loops stay")));
}

}  // namespace

FillHolesResult fill_holes(const TriangleMesh& mesh, const FillHolesParams& params, Context& context) {
    require_usable(mesh, params);
    context.check_cancelled();
    const MeshLoops boundary(mesh);
    if (const std::size_t seams = coincident_edges(mesh, boundary.half_edges()).size(); seams > 0)
        context.warn(
            fmt::format("{} at the position of another boundary edge: the surface is cut there, but complete; repair "
                        "joins such edges",
                        count_text(seams, "boundary edge is", "boundary edges are")));
    const FillingStage first_stage = params.fair ? FillingStage::faired : FillingStage::refined;
    FillHolesResult result;
    std::vector<Hole> holes;
    const OuterBoundaries outer = outer_boundaries(mesh, boundary, params);
    for (std::size_t i = 0; i < outer.is_outer.size(); ++i) {
        const std::vector<u32>& loop = boundary.loops()[i];
        if (outer.is_outer[i]) {
            ++result.outer;
            continue;
        }
        const bool fits = (!params.max_edges || loop.size() <= *params.max_edges) &&
                          (!params.max_length || length_of(mesh, loop) <= params.max_length->value());
        if (fits)
            holes.push_back({loop, first_stage, false, {}, {}});
        else
            ++result.beyond_limits;
    }
    FilledMesh filled = filled_mesh(mesh, fillings_of(mesh, boundary, holes, context), holes);
    result.failed = static_cast<std::size_t>(std::ranges::count_if(holes, &Hole::open));
    if (params.together && result.failed > 0 && result.beyond_limits == 0 && result.outer == 0) {
        if (std::optional<Closed> closed = closed_together(mesh, filled, context)) {
            filled = std::move(closed->mesh);
            result.replaced = closed->replaced;
            result.together = std::exchange(result.failed, 0);
        }
    }

    if (params.must_close && result.failed > 0)
        throw Error("{} open: no triangulation without intersections was found",
                    count_text(result.failed, "loop stays", "loops stay"))
            .hint("clean the scan, or accept open loops with `closed: auto`");
    if (result.outer > 0 && params.outer == FillHolesParams::Outer::automatic)
        context.warn(fmt::format(
            "the surface stays open at {}: closed flat, {} would add {:.0f} % to its area; `outer: fill` closes all",
            count_text(result.outer, "outer boundary", "outer boundaries"), by_count(result.outer, "it", "they"),
            100 * outer.share));

    const double diagonal = surface_box(mesh).diagonal();
    std::size_t too_long = 0;
    for (const Hole& hole : holes) {
        if (hole.open && result.together == 0) continue;
        ++result.filled;
        result.plain += !hole.open && hole.stage != first_stage;
        const double length = length_of(mesh, hole.loop);
        result.longest = std::max(result.longest, length);
        too_long += length > diagonal;
    }
    const double whole = filled.area();
    result.area = filled.filled_area();
    const std::size_t added_triangles = filled.triangles.size() - filled.kept,
                      added_points = filled.positions.size() - mesh.positions.size();
    result.mesh = with_columns(mesh, std::move(filled), context);
    if (const std::size_t turned = params.outwards ? face_outwards(result.mesh, context) : 0; turned > 0)
        context.warn(fmt::format("{} turned: the closed surface faced inwards",
                                 count_text(turned, "triangle was", "triangles were")));
    const double share = whole > 0 ? result.area / whole : 0;
    report_doubts(result, diagonal, too_long, share, context);
    for (std::string& doubt : doubts_about_handles(result.mesh, context)) context.doubt(std::move(doubt));

    context.metric("filled", static_cast<double>(result.filled));
    context.metric("left", static_cast<double>(result.beyond_limits + result.failed + result.outer));
    context.metric("outer", static_cast<double>(result.outer));
    context.metric("largest-share", outer.largest_share, Unit::ratio);
    context.metric("added-triangles", static_cast<double>(added_triangles));
    context.metric("added-points", static_cast<double>(added_points));
    context.metric("area", result.area, Unit::area);
    context.metric("share", share, Unit::ratio);
    context.metric("longest", result.longest, Unit::length);
    context.metric("plain", static_cast<double>(result.plain));
    context.metric("together", static_cast<double>(result.together));
    context.metric("replaced-triangles", static_cast<double>(result.replaced));
    context.metric("failed", static_cast<double>(result.failed));
    context.progress(1);
    return result;
}

}  // namespace scanmill
