// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/alpha_solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "alpha_solid/selection.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/mesh/doubtful_surface.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"

namespace scanmill {

namespace {

using namespace alpha;

void require_usable(const TetMesh& tets, const AlphaSolidParams& params) {
    if (tets.cells.empty()) throw Error("needs a tetrahedralisation with cells; this one has none");
    if (tets.neighbours.size() != tets.cells.size())
        throw Error("needs the neighbours of all {} cells; there are {}", tets.cells.size(), tets.neighbours.size())
            .hint("'delaunay' computes the neighbours");
    const double coverage = params.coverage.value();
    if (!(coverage > 0 && coverage <= 1))
        throw Error("coverage must be above 0 % and at most 100 %; it is {}", params.coverage.text());
    if (params.alpha && !(params.alpha->value() > 0 && std::isfinite(params.alpha->value())))
        throw Error("alpha must be a length above 0; it is {}", params.alpha->text());
    if (tets.weights.empty()) return;
    const auto [least, largest] = std::ranges::minmax(tets.weights);
    if (!(least >= 0 && std::isfinite(largest)))
        throw Error("needs finite weights of 0 or more; these go from {:.3g} to {:.3g}", least, largest)
            .hint("`delaunay: {weights: spacing}` computes them");
}

/// A radius whose square is not below `squared`. As a given alpha, it selects the same cells.
double radius(double squared) {
    const double root = std::sqrt(squared);
    return root * root < squared ? std::nextafter(root, std::numeric_limits<double>::infinity()) : root;
}

/// A short decimal number that is not below the radius, and only slightly above it.
std::string text_from(double squared) { return text_within({radius(squared), std::numeric_limits<double>::max()}, 0); }

[[noreturn]] void refuse_without_cells(const SweepResult& sweep, const Length& alpha, const Frame& frame) {
    const std::string_view unit = symbol(frame.unit);
    throw Error(
        "alpha {} leaves no cell inside; the first cell enters at {} {}, and from {} {} cells cover {} of {} points",
        alpha.text(), text_from(sweep.values.back()), unit, text_from(sweep.cover), unit, sweep.needed, sweep.points)
        .hint("'alpha: auto' finds the least alpha with a closed manifold boundary");
}

/// The largest radius whose square is below `squared`.
double radius_below(double squared) {
    double root = std::sqrt(squared);
    if (std::isinf(root)) return root;
    while (root * root >= squared) root = std::nextafter(root, 0.0);
    return root;
}

/// Sets the labels of the cells, and derives from them the counts and the interior, uncovered and hidden points.
void describe_cells(AlphaSolidResult& result, Selection& selection, unsigned threads) {
    const TetMesh& tets = result.tets;
    Array<u8> state = coverage(tets, selection.labels, threads);
    constexpr u8 on_boundary = 2, hidden = 3;
    Array<u32> hidden_by_weights = hidden_vertices(tets);
    for (u32 vertex : hidden_by_weights) state[vertex] = hidden;
    for (const Triangle& triangle : selection.triangles)
        for (u32 vertex : triangle) state[vertex] = on_boundary;
    Array<u32> interior, uncovered;
    for (u32 vertex = 0; vertex < state.size(); ++vertex)
        if (state[vertex] < on_boundary) (state[vertex] ? interior : uncovered).push_back(vertex);
    result.interior_points = std::move(interior);
    result.uncovered_points = std::move(uncovered);
    result.hidden_points = std::move(hidden_by_weights);

    result.cells_left_out = static_cast<std::size_t>(std::ranges::count(selection.labels, u8(left_out)));
    for (u8& label : selection.labels) label = label == solid;
    result.cells_inside = static_cast<std::size_t>(std::ranges::count(selection.labels, u8(1)));
    result.tets.inside = std::move(selection.labels);
}

/// The number of different solids that the sweep reaches at `value` and above.
std::size_t spectrum_from(const SweepResult& sweep, double value) {
    std::size_t count = 1;
    for (std::size_t i = 0; i < sweep.values.size() && sweep.values[i] > value; ++i)
        count += i == 0 || sweep.values[i] != sweep.values[i - 1];
    return count;
}

void set_metrics(const AlphaSolidResult& result, Context& context) {
    context.metric("alpha", result.alpha, Unit::length);
    context.metric("alpha-cover", result.alpha_cover, Unit::length);
    context.metric("spectrum", static_cast<double>(result.spectrum));
    context.metric("cells", static_cast<double>(result.cells_inside));
    context.metric("interior-points", static_cast<double>(result.interior_points.size()));
    context.metric("uncovered-points", static_cast<double>(result.uncovered_points.size()));
    context.metric("hidden-points", static_cast<double>(result.hidden_points.size()));
    context.metric("triangles", static_cast<double>(result.mesh.triangles.size()));
}

// Warnings.

/// Clean scans have a valid solid at alpha_cover itself. If alpha is larger by this factor, the solid has often closed
/// a hole.
constexpr double ambiguous_factor = 1.1;
/// On clean scans alpha is near the length of the boundary's edges. A ball larger by this factor spans a gap or
/// includes outliers.
constexpr double ambiguous_edges = 3;
/// Complete scans with grooves reach 5.3 (the merged bunny, across the holes of its base). Solids that have lost the
/// object's shape begin at 9.
constexpr double doubtful_edges = 7;

std::string_view unit_of(const AlphaSolidResult& result) { return symbol(result.tets.frame.unit); }

/// Reports that more points are outside than the share allows; empty otherwise.
std::string too_many_outside(const AlphaSolidResult& result, const AlphaSolidParams& params) {
    const std::size_t points = result.tets.positions.size() - result.hidden_points.size();
    const std::size_t outside = result.uncovered_points.size();
    const std::size_t allowed = points - needed_points(params.coverage.value(), points);
    if (outside <= allowed) return {};
    const std::string text = fmt::format("{} of {} points {} outside of it", outside, result.tets.positions.size(),
                                         by_count(outside, "is", "are"));
    if (params.coverage.value() == 1) return text;
    return text + fmt::format(", more than the {} that coverage {} allows", allowed, params.coverage.text());
}

/// Reports the defects of the solid at a given alpha, and the nearest valid alpha.
std::string wrong_alpha_text(const AlphaSolidResult& result, const AlphaSolidParams& params) {
    const std::string_view unit = unit_of(result);
    std::vector<std::string> faults;
    if (std::string text = too_many_outside(result, params); !text.empty()) faults.push_back(std::move(text));
    if (result.nonmanifold_vertices > 0)
        faults.push_back(
            fmt::format("its boundary has {} and {} with more than two triangles",
                        count_text(result.nonmanifold_vertices, "non-manifold vertex", "non-manifold vertices"),
                        count_text(result.nonmanifold_edges, "edge", "edges")));
    if (params.components == AlphaComponents::single && result.components > 1)
        faults.push_back(fmt::format("it has {} components", result.components));
    const double alpha = result.alpha, least = result.nearest_valid->least;
    return fmt::format(
        "at alpha {} the solid is not valid: {}; the nearest alpha that gives a valid one is {} {}{}",
        params.alpha->text(), enumerated(faults), text_within(*result.nearest_valid, alpha), unit,
        least > max_scan * result.alpha_cover && least > alpha
            ? ", far above the alpha that covers the points; 'alpha: auto' repairs a smaller solid instead"
            : "");
}

/// Per vertex of the boundary: alpha² minus the squared radius of the ball there. 0 without weights.
std::vector<double> weight_deficits(const AlphaSolidResult& result) {
    const Buffer<double>& weights = result.tets.weights;
    std::vector<double> deficits(result.mesh.positions.size(), 0.0);
    if (weights.empty()) return deficits;
    std::vector<bool> is_elsewhere(weights.size(), false);
    for (const Buffer<u32>* points : {&result.interior_points, &result.uncovered_points, &result.hidden_points})
        for (u32 vertex : *points) is_elsewhere[vertex] = true;
    const double largest = *std::ranges::max_element(weights);
    std::size_t at_boundary = 0;
    for (std::size_t vertex = 0; vertex < weights.size(); ++vertex)
        if (!is_elsewhere[vertex]) deficits[at_boundary++] = largest - weights[vertex];
    return deficits;
}

/// The median ratio of the ball's radius to the length of the boundary's edges, in a sample of evenly spread triangles.
/// Pre: there are triangles.
double radius_in_edges(const AlphaSolidResult& result) {
    const TriangleMesh& mesh = result.mesh;
    const std::vector<double> deficits = weight_deficits(result);
    constexpr std::size_t most = 1 << 16;
    const std::size_t step = 1 + (mesh.triangles.size() - 1) / most;
    std::vector<double> ratios;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += step)
        for (int i = 0; i < 3; ++i) {
            const u32 a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
            const double squared = result.alpha * result.alpha - (deficits[a] + deficits[b]) / 2;
            ratios.push_back(std::sqrt(std::max(0.0, squared)) / (mesh.positions[a] - mesh.positions[b]).norm());
        }
    return median(ratios);
}

/// Reports signs that a chosen alpha is too large. `edges` is the result of radius_in_edges().
std::vector<std::string> signs_of_large_alpha(const AlphaSolidResult& result, double edges) {
    const std::string_view unit = unit_of(result);
    std::vector<std::string> signs;
    if (result.alpha >= ambiguous_factor * result.alpha_cover)
        signs.push_back(
            fmt::format("alpha {:.4g} {} is {:.3g} times the {:.4g} {} that would cover the points, because the "
                        "smaller solids are not valid",
                        result.alpha, unit, result.alpha / result.alpha_cover, result.alpha_cover, unit));
    if (edges >= ambiguous_edges)
        signs.push_back(
            fmt::format("alpha {:.4g} {} is {:.3g} times the boundary's median edge{}, to span gaps or to reach "
                        "distant points",
                        result.alpha, unit, edges, result.tets.weights.empty() ? "" : ", weights taken into account"));
    return signs;
}

/// Reports that the points do not determine the solid; empty when they do.
std::string ambiguity_text(const AlphaSolidResult& result, double edges) {
    std::vector<std::string> signs;
    if (result.choice != AlphaChoice::given) signs = signs_of_large_alpha(result, edges);
    if (!result.interior_points.empty())
        signs.push_back(fmt::format("{} of {} points {} inside the solid instead of on its boundary",
                                    result.interior_points.size(), result.tets.positions.size(),
                                    by_count(result.interior_points.size(), "lies", "lie")));
    if (signs.empty()) return {};
    return enumerated(signs) +
           ": gaps and hollows narrower than 2 alpha may be filled, even between parts; sculpt reopens some of them; "
           "to allow a smaller alpha, remove outliers before, lower the coverage, or add points in gaps and thin parts";
}

/// Reports points and cells that are not in the solid; empty when none is missing.
std::string missing_text(const AlphaSolidResult& result) {
    const std::size_t points = result.uncovered_points.size(), cells = result.cells_left_out;
    const std::string of_others =
        count_text(cells, "cell of other solids was", "cells of other solids were") + " left out";
    if (points == 0) return cells == 0 ? "" : of_others;
    return fmt::format("{} of {} points {} not in or on the solid{}", points, result.tets.positions.size(),
                       by_count(points, "is", "are"), cells == 0 ? "" : "; " + of_others);
}

/// Reports that no alpha-solid was valid, and how one was repaired.
std::string repair_text(const AlphaSolidResult& result, const AlphaSolidParams& params) {
    const std::string_view unit = unit_of(result);
    // A solid that leaves points out may be valid at a slightly larger alpha. Only smaller values are excluded.
    const bool may_leave_out = params.components == AlphaComponents::single && params.coverage.value() < 1;
    const std::string none =
        may_leave_out
            ? fmt::format("no alpha below {:.4g} {} gives a manifold boundary around enough points", result.alpha, unit)
            : fmt::format("no alpha up to {:.4g} {} gives a solid with a manifold boundary",
                          max_scan * result.alpha_cover, unit);
    if (result.choice == AlphaChoice::hull)
        return fmt::format(
            "{}, and closing the solid at {:.4g} {} around its non-manifold vertices filled the convex hull; more "
            "points, or a coverage below 100 % that ignores outliers, allow a smaller alpha",
            none, result.alpha, unit);
    return fmt::format("{}; the solid at {:.4g} {} was closed around its non-manifold vertices", none, result.alpha,
                       unit);
}

void warn_about(const AlphaSolidResult& result, const AlphaSolidParams& params, Context& context) {
    if (result.nearest_valid) context.warn(wrong_alpha_text(result, params));
    const bool is_reported =
        result.nearest_valid && result.cells_left_out == 0 && !too_many_outside(result, params).empty();
    if (const std::string text = missing_text(result); !text.empty() && !is_reported) context.warn(text);
    if (result.nearest_valid) return;
    if (const auto& separate = result.separate)
        context.warn(fmt::format(
            "alpha {:.4g} {} joins {} solids that are separate at {:.4g} {}; 'components: many' keeps them separate",
            result.alpha, unit_of(result), separate->count, separate->alpha, unit_of(result)));
    if (result.choice == AlphaChoice::repaired || result.choice == AlphaChoice::hull)
        context.warn(repair_text(result, params));
    const double edges = radius_in_edges(result);
    const std::string text = ambiguity_text(result, edges);
    const bool is_far_too_large = edges >= doubtful_edges && result.choice != AlphaChoice::given;
    // sculpt may bring the surface to points inside, but it does not separate what a far too large alpha joined.
    if (is_far_too_large || 2 * result.interior_points.size() > result.tets.positions.size())
        context.doubt(text, is_far_too_large ? "" : "mesh");
    else if (!text.empty())
        context.warn(text);
    for (std::string& doubt : doubts_about_surface(result.mesh)) context.doubt(std::move(doubt), "mesh");
}

}  // namespace

AlphaSolidResult alpha_solid(const TetMesh& tets, const AlphaSolidParams& params, Context& context) {
    require_usable(tets, params);
    SweepLimits limits;
    limits.coverage = params.coverage.value();
    if (params.alpha) limits.value = params.alpha->value() * params.alpha->value();

    SweepResult sweep;
    {
        const Array<SweepCell> cells = sweep_cells(tets, context);
        context.progress(0.35);
        sweep = sweep_from_outside(cells, tets.positions.size(), limits, context);
    }
    context.progress(0.75);
    if (params.alpha && sweep.outside_above(limits.value) == tets.cells.size())
        refuse_without_cells(sweep, *params.alpha, tets.frame);

    const Selector selector(tets, sweep, params, context);
    Selection selection = params.alpha                           ? selector.given(limits.value)
                          : params.search == AlphaSearch::binary ? selector.bisect()
                                                                 : selector.scan();
    context.progress(0.9);

    AlphaSolidResult result;
    result.alpha_cover = radius(sweep.cover);
    result.alpha = params.alpha ? params.alpha->value() : radius(sweep.values[selection.outside]);
    result.spectrum = spectrum_from(sweep, std::min(sweep.cover, limits.value));
    result.choice = selection.choice;
    result.components = selection.components;
    result.nonmanifold_vertices = selection.defects.vertices.size();
    result.nonmanifold_edges = selection.defects.edges;
    if (params.alpha && !selector.is_valid(selection)) {
        const AlphaRange nearest = selector.nearest_valid(limits.value);
        result.nearest_valid = {radius(nearest.from), radius_below(nearest.to)};
    }
    const bool is_joined = params.components == AlphaComponents::single && params.coverage.value() == 1;
    if (!params.alpha && is_joined && selection.outside < sweep.outside_above(sweep.cover))
        if (const auto separate = selector.separate())
            result.separate = {separate->components, radius(sweep.values[separate->outside])};
    result.tets = tets;
    describe_cells(result, selection, context.threads());
    result.mesh = boundary_mesh(tets, std::move(selection.triangles));
    warn_about(result, params, context);
    set_metrics(result, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
