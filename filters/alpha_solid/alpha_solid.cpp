// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/alpha_solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "alpha_solid/pieces.hpp"
#include "alpha_solid/remarks.hpp"
#include "alpha_solid/selection.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/size_limits.hpp"
#include "scanmill/geometry/tets/hidden_vertices.hpp"

namespace scanmill {

namespace {

using namespace alpha;

void require_usable(const TetMesh& tets, const AlphaSolidParams& params) {
    if (tets.cells.empty()) throw Error("needs a tetrahedralisation with cells; this one has none");
    if (tets.neighbours.size() != tets.cells.size())
        throw Error("needs the neighbours of all {} cells; there are {}", tets.cells.size(), tets.neighbours.size())
            .hint("'delaunay' makes them");
    const double coverage = params.coverage.value();
    if (!(coverage > 0 && coverage <= 1))
        throw Error("coverage must be above 0 % and at most 100 %; it is {}", params.coverage.text());
    if (params.alpha && !(params.alpha->value() > 0 && std::isfinite(params.alpha->value())))
        throw Error("alpha must be a length above 0; it is {}", params.alpha->text());
    require_squares(bounding_box(tets.positions.span()).diagonal(), "needs a scan");
    if (tets.weights.empty()) return;
    const auto [least, largest] = std::ranges::minmax(tets.weights);
    if (!(least >= 0 && largest <= 1e200))
        throw Error("needs weights from 0 to 1e200; these go from {:.3g} to {:.3g}", least, largest)
            .hint("`delaunay: {weights: spacing}` computes them");
}

/// A radius whose square is not below `squared`, so that giving it as alpha selects the same cells.
double radius(double squared) {
    const double root = std::sqrt(squared);
    return root * root < squared ? std::nextafter(root, std::numeric_limits<double>::infinity()) : root;
}

/// The shortest decimal that is no smaller and, unless that takes many digits, little larger: told, it works.
std::string text_from(double squared) {
    return alpha::text_within({radius(squared), std::numeric_limits<double>::max()}, 0);
}

[[noreturn]] void refuse_without_cells(const Flood& flood, const Length& alpha, const Frame& frame) {
    const std::string_view unit = symbol(frame.unit);
    throw Error("alpha {} leaves no cell inside; from {} {} there is one, from {} {} cells reach {} of {} points",
                alpha.text(), text_from(flood.values.back()), unit, text_from(flood.cover), unit, flood.needed,
                flood.points)
        .hint("'alpha: auto' finds the least alpha with a closed manifold boundary");
}

/// The largest radius whose square is below `squared`.
double radius_below(double squared) {
    double root = std::sqrt(squared);
    if (std::isinf(root)) return root;
    while (root * root >= squared) root = std::nextafter(root, 0.0);
    return root;
}

/// Throws Error when no number is the square of a radius that is needed.
void require_number(double squared, const TetMesh& tets) {
    if (squared < std::numeric_limits<double>::max()) return;
    const std::string_view unit = symbol(tets.frame.unit);
    std::string text = fmt::format("the solid needs an alpha above 1e154 {}; the scan is only {:.3g} {} in size", unit,
                                   bounding_box(tets.positions.span()).diagonal(), unit);
    if (tets.weights.empty()) throw Error(text).hint("all points but hairs lie in one plane; region-grow accepts that");
    const auto [least, largest] = std::ranges::minmax(tets.weights);
    throw Error(text + fmt::format(", and its weights go from {:.3g} to {:.3g} {}²", least, largest, unit))
        .hint(
            "weights should not differ by more than squares of distances between points: a smaller factor brings them "
            "nearer to each other, `weights: spacing` fits them to the points");
}

/// Fills what follows from the labels: inside, counts, interior and uncovered points.
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

/// Different values among the flood's above `value`, and the solid at it.
std::size_t spectrum_from(const Flood& flood, double value) {
    std::size_t count = 1;
    for (std::size_t i = 0; i < flood.values.size() && flood.values[i] > value; ++i)
        count += i == 0 || flood.values[i] != flood.values[i - 1];
    return count;
}

void report(const AlphaSolidResult& result, Context& context) {
    context.metric("alpha", result.alpha, Unit::length);
    context.metric("alpha-cover", result.alpha_cover, Unit::length);
    context.metric("spectrum", static_cast<double>(result.spectrum));
    context.metric("cells", static_cast<double>(result.cells_inside));
    context.metric("interior-points", static_cast<double>(result.interior_points.size()));
    context.metric("uncovered-points", static_cast<double>(result.uncovered_points.size()));
    context.metric("hidden-points", static_cast<double>(result.hidden_points.size()));
    context.metric("triangles", static_cast<double>(result.mesh.triangles.size()));
}

}  // namespace

AlphaSolidResult alpha_solid(const TetMesh& tets, const AlphaSolidParams& params, Context& context) {
    require_usable(tets, params);
    FloodLimits limits;
    limits.coverage = params.coverage.value();
    if (params.alpha) limits.value = params.alpha->value() * params.alpha->value();

    Flood flood;
    {
        const Array<SweepCell> cells = sweep_cells(tets, context);
        context.progress(0.35);
        flood = flood_from_outside(cells, tets.positions.size(), limits, context);
    }
    context.progress(0.75);
    if (params.alpha && flood.outside_above(limits.value) == tets.cells.size())
        refuse_without_cells(flood, *params.alpha, tets.frame);

    const Selector selector(tets, flood, params, context);
    Selection selection = params.alpha                           ? selector.given(limits.value)
                          : params.search == AlphaSearch::binary ? selector.bisect()
                                                                 : selector.scan();
    context.progress(0.9);

    AlphaSolidResult result;
    if (!params.alpha) require_number(flood.values[selection.outside], tets);
    require_number(flood.cover, tets);
    result.alpha_cover = radius(flood.cover);
    result.alpha = params.alpha ? params.alpha->value() : radius(flood.values[selection.outside]);
    result.spectrum = spectrum_from(flood, std::min(flood.cover, limits.value));
    result.choice = selection.choice;
    result.components = selection.components;
    result.nonmanifold_vertices = selection.defects.vertices.size();
    result.nonmanifold_edges = selection.defects.edges;
    if (params.alpha && !selector.is_valid(selection)) {
        const AlphaRange nearest = selector.nearest_valid(limits.value);
        result.nearest_valid = {radius(nearest.from), radius_below(nearest.to)};
    }
    const bool is_joined = params.components == AlphaComponents::single && params.coverage.value() == 1;
    if (!params.alpha && is_joined && selection.outside < flood.outside_above(flood.cover))
        if (const auto apart = selector.apart())
            result.separate = {apart->components, radius(flood.values[apart->outside])};
    result.tets = tets;
    describe_cells(result, selection, context.threads());
    result.mesh = boundary_mesh(tets, std::move(selection.triangles));
    remark(result, params, context);
    report(result, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
