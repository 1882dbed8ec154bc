// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/remarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "alpha_solid/selection.hpp"

#include "scanmill/base/text.hpp"

namespace scanmill::alpha {

namespace {

/// Clean scans have a valid solid at alpha_cover itself; the first valid one this far above it has often closed a hole.
constexpr double ambiguous_factor = 1.1;
/// And their alpha is near the length of the boundary's edges; this much more spans a gap, or reaches for outliers.
constexpr double ambiguous_edges = 3;

double number(std::string_view text) {
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

std::string_view unit_of(const AlphaSolidResult& result) { return symbol(result.tets.frame.unit); }

std::string joined(const std::vector<std::string>& parts) {
    std::string text;
    for (std::size_t i = 0; i < parts.size(); ++i)
        text += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
    return text;
}

/// That more points are outside than the share allows, or nothing.
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

/// What is wrong at a given alpha, and the nearest that works.
std::string wrong_alpha(const AlphaSolidResult& result, const AlphaSolidParams& params) {
    const std::string_view unit = unit_of(result);
    std::vector<std::string> faults;
    if (std::string text = too_many_outside(result, params); !text.empty()) faults.push_back(std::move(text));
    if (result.nonmanifold_vertices > 0)
        faults.push_back(
            fmt::format("its boundary has {} and {} with more than two triangles",
                        counted(result.nonmanifold_vertices, "non-manifold vertex", "non-manifold vertices"),
                        counted(result.nonmanifold_edges, "edge", "edges")));
    if (params.components == AlphaComponents::single && result.components > 1)
        faults.push_back(fmt::format("it is in {} pieces", result.components));
    const double alpha = result.alpha, least = result.nearest_valid->least;
    return fmt::format("at alpha {} the solid is not valid: {}; the nearest alpha that gives a valid one is {} {}{}",
                       params.alpha->text(), joined(faults), text_within(*result.nearest_valid, alpha), unit,
                       least > max_scan * result.alpha_cover && least > alpha
                           ? ", far above what covers the points: 'alpha: auto' repairs a smaller solid instead"
                           : "");
}

/// What the ball's radius at each vertex of the boundary is less than alpha, squared: 0 without weights.
std::vector<double> weights_missing(const AlphaSolidResult& result) {
    const Buffer<double>& weights = result.tets.weights;
    std::vector<double> missing(result.mesh.positions.size(), 0.0);
    if (weights.empty()) return missing;
    std::vector<bool> is_elsewhere(weights.size(), false);
    for (const Buffer<u32>* points : {&result.interior_points, &result.uncovered_points, &result.hidden_points})
        for (u32 vertex : *points) is_elsewhere[vertex] = true;
    const double largest = *std::ranges::max_element(weights);
    std::size_t at_boundary = 0;
    for (std::size_t vertex = 0; vertex < weights.size(); ++vertex)
        if (!is_elsewhere[vertex]) missing[at_boundary++] = largest - weights[vertex];
    return missing;
}

/// How often the boundary's edges go into the ball's radius there: the median over those of evenly spread triangles,
/// some ten thousands at most. Pre: there are triangles.
double radius_in_edges(const AlphaSolidResult& result) {
    const TriangleMesh& mesh = result.mesh;
    const std::vector<double> missing = weights_missing(result);
    constexpr std::size_t most = 1 << 16;
    const std::size_t step = 1 + (mesh.triangles.size() - 1) / most;
    std::vector<double> ratios;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += step)
        for (int i = 0; i < 3; ++i) {
            const u32 a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
            const double squared = result.alpha * result.alpha - (missing[a] + missing[b]) / 2;
            ratios.push_back(std::sqrt(std::max(0.0, squared)) / (mesh.positions[a] - mesh.positions[b]).norm());
        }
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::ranges::nth_element(ratios, middle);
    return *middle;
}

/// What speaks against an alpha that was chosen.
std::vector<std::string> doubts(const AlphaSolidResult& result) {
    const std::string_view unit = unit_of(result);
    std::vector<std::string> signs;
    if (result.alpha >= ambiguous_factor * result.alpha_cover)
        signs.push_back(
            fmt::format("alpha {:.4g} {} is {:.3g} times the {:.4g} {} that would cover the points, because the "
                        "smaller solids are not valid",
                        result.alpha, unit, result.alpha / result.alpha_cover, result.alpha_cover, unit));
    if (const double edges = radius_in_edges(result); edges >= ambiguous_edges)
        signs.push_back(
            fmt::format("alpha {:.4g} {} is {:.3g} times the boundary's median edge{}, to span gaps or to reach far "
                        "points",
                        result.alpha, unit, edges, result.tets.weights.empty() ? "" : ", with the weights there"));
    return signs;
}

/// That the points do not make the solid clear, or nothing.
std::string ambiguity(const AlphaSolidResult& result) {
    std::vector<std::string> signs;
    if (result.choice != AlphaChoice::given) signs = doubts(result);
    if (!result.interior_points.empty())
        signs.push_back(fmt::format("{} of {} points {} inside the solid instead of on its boundary",
                                    result.interior_points.size(), result.tets.positions.size(),
                                    by_count(result.interior_points.size(), "lies", "lie")));
    if (signs.empty()) return {};
    return joined(signs) +
           ": what is narrower than 2 alpha may be filled, gaps between parts too; sculpt opens what it can, and more "
           "points in gaps and thin "
           "parts, or a lower coverage against outliers, allow a smaller alpha";
}

/// What is not in the solid, or nothing.
std::string missing_from(const AlphaSolidResult& result) {
    const std::size_t points = result.uncovered_points.size(), cells = result.cells_left_out;
    const std::string of_others =
        counted(cells, "cell of other solids was", "cells of other solids were") + " left out";
    if (points == 0) return cells == 0 ? "" : of_others;
    return fmt::format("{} of {} points {} not in or on the solid{}", points, result.tets.positions.size(),
                       by_count(points, "is", "are"), cells == 0 ? "" : "; " + of_others);
}

/// That no alpha-solid was valid as it is, and what was made of one instead.
std::string repair(const AlphaSolidResult& result, const AlphaSolidParams& params) {
    const std::string_view unit = unit_of(result);
    // One that leaves points out may be valid soon above it.
    const bool may_leave_out = params.components == AlphaComponents::single && params.coverage.value() < 1;
    const std::string none =
        may_leave_out
            ? fmt::format("no alpha below {:.4g} {} gives a manifold boundary round enough points", result.alpha, unit)
            : fmt::format("no alpha up to {:.4g} {} gives a solid with a manifold boundary",
                          max_scan * result.alpha_cover, unit);
    if (result.choice == AlphaChoice::hull)
        return fmt::format(
            "{}, and closing the solid at {:.4g} {} round its non-manifold vertices filled the convex hull; more "
            "points, "
            "or a coverage below 100 % against outliers, allow a smaller alpha",
            none, result.alpha, unit);
    return fmt::format("{}; the solid at {:.4g} {} was closed round its non-manifold vertices", none, result.alpha,
                       unit);
}

}  // namespace

std::string text_within(const AlphaInterval& interval, double alpha) {
    const bool is_above = interval.least > alpha;
    const double end = is_above ? interval.least : interval.largest;
    std::string text;
    for (int digits = 4; digits <= 17; ++digits) {
        const double last_place = std::pow(10.0, std::floor(std::log10(end)) + 1 - digits);
        for (double candidate : {end, is_above ? end + last_place : end - last_place}) {
            text = fmt::format("{:.{}g}", candidate, digits);
            if (const double value = number(text); value >= interval.least && value <= interval.largest) return text;
        }
    }
    return text;
}

void remark(const AlphaSolidResult& result, const AlphaSolidParams& params, Context& context) {
    if (result.nearest_valid) context.warn(wrong_alpha(result, params));
    const bool is_told =
        result.nearest_valid && result.cells_left_out == 0 && !too_many_outside(result, params).empty();
    if (const std::string text = missing_from(result); !text.empty() && !is_told) context.warn(text);
    if (result.nearest_valid) return;
    if (const auto& apart = result.separate)
        context.warn(fmt::format(
            "alpha {:.4g} {} joins {} solids that stand apart at {:.4g} {}; 'components: many' keeps them apart",
            result.alpha, unit_of(result), apart->count, apart->alpha, unit_of(result)));
    if (result.choice == AlphaChoice::repaired || result.choice == AlphaChoice::hull)
        context.warn(repair(result, params));
    if (const std::string text = ambiguity(result); !text.empty()) context.warn(text);
}

}  // namespace scanmill::alpha
