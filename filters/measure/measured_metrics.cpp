// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/measured_metrics.hpp"

#include <fmt/format.h>

namespace scanmill {

namespace {

/// `side`: "", "-to-truth" …
void add_distances(Metrics& metrics, const DistanceNumbers& numbers, std::string_view side) {
    const auto add = [&](std::string_view name, double value) {
        metrics.set(fmt::format("{}{}", name, side), value, Unit::length);
    };
    add("mean", numbers.mean);
    if (numbers.mean_spread) add("mean-spread", *numbers.mean_spread);
    add("rms", numbers.rms);
    add("p50", numbers.p50);
    add("p90", numbers.p90);
    add("p95", numbers.p95);
    add("p99", numbers.p99);
    add("max", numbers.max);
}

void add_shares(Metrics& metrics, const NearShares& shares, std::string_view suffix) {
    const auto add = [&](std::string_view name, double value) {
        metrics.set(fmt::format("{}{}", name, suffix), value, Unit::ratio);
    };
    metrics.set(fmt::format("threshold{}", suffix), shares.threshold, Unit::length);
    if (shares.f_score) add("f-score", *shares.f_score);
    if (shares.precision) add("precision", *shares.precision);
    add("recall", shares.recall);
}

void add_topology(Metrics& metrics, const MeshTopology& facts, std::string_view prefix) {
    const auto add = [&](std::string_view name, auto value, Unit unit = Unit::count) {
        metrics.set(fmt::format("{}{}", prefix, name), static_cast<double>(value), unit);
    };
    add("vertices", facts.vertices);
    add("unused-vertices", facts.unused_vertices);
    add("triangles", facts.triangles);
    add("components", facts.components);
    if (facts.genus) add("genus", *facts.genus);
    add("euler", facts.euler);
    add("closed", facts.closed, Unit::boolean);
    add("boundary-loops", facts.boundary_loops);
    add("boundary-edges", facts.boundary_edges);
    add("nonmanifold-edges", facts.nonmanifold_edges);
    add("nonmanifold-vertices", facts.nonmanifold_vertices);
    add("misoriented-edges", facts.misoriented_edges);
}

/// `prefix`: "" or "truth-".
void add_mesh(Metrics& metrics, const MeshNumbers& numbers, std::string_view prefix) {
    const auto add = [&](std::string_view name, double value, Unit unit) {
        metrics.set(fmt::format("{}{}", prefix, name), value, unit);
    };
    add("area", numbers.area, Unit::area);
    if (numbers.volume) add("volume", *numbers.volume, Unit::volume);
    add_topology(metrics, numbers.topology, prefix);
    add("collinear-triangles", static_cast<double>(numbers.collinear_triangles), Unit::count);
    add("min-angle", numbers.least_angle, Unit::angle);
    add("min-angle-p5", numbers.angle_p5, Unit::angle);
    add("min-angle-p50", numbers.angle_p50, Unit::angle);
    add("aspect-ratio-p50", numbers.aspect_p50, Unit::number);
    add("aspect-ratio-p95", numbers.aspect_p95, Unit::number);
    add("aspect-ratio-max", numbers.largest_aspect, Unit::number);
}

}  // namespace

Metrics metrics_of(const Measurement& measured) {
    Metrics metrics;
    add_distances(metrics, measured.both, "");
    if (measured.to_truth) add_distances(metrics, *measured.to_truth, "-to-truth");
    if (measured.to_points) add_distances(metrics, *measured.to_points, "-to-points");
    add_distances(metrics, measured.from_truth, "-from-truth");
    if (measured.beyond_borders)
        metrics.set("beyond-borders", static_cast<double>(*measured.beyond_borders), Unit::count);
    if (measured.hausdorff) metrics.set("hausdorff", *measured.hausdorff, Unit::length);
    if (measured.chamfer) metrics.set("chamfer", *measured.chamfer, Unit::length);
    for (std::size_t i = 0; i < measured.near.size(); ++i)
        add_shares(metrics, measured.near[i], i == 0 ? "" : fmt::format("@{}", i + 1));
    if (measured.normal_consistency) {
        metrics.set("normal-consistency", *measured.normal_consistency, Unit::number);
        metrics.set("normal-consistency-unsigned", *measured.normal_consistency_unsigned, Unit::number);
        metrics.set("without-normal", static_cast<double>(measured.without_normal), Unit::count);
    }
    if (measured.certified) {
        metrics.set("hausdorff-lower", measured.certified->lower, Unit::length);
        metrics.set("hausdorff-upper", measured.certified->upper, Unit::length);
        metrics.set("certified", measured.certified->reached, Unit::boolean);
        metrics.set("cuts", static_cast<double>(measured.certified->cuts), Unit::count);
    }
    metrics.unit = measured.unit;
    metrics.set("diagonal", measured.diagonal, Unit::length);
    add_mesh(metrics, measured.mesh, "");
    if (measured.self_intersections)
        metrics.set("self-intersections", static_cast<double>(*measured.self_intersections), Unit::count);
    if (measured.truth) add_mesh(metrics, *measured.truth, "truth-");
    return metrics;
}

}  // namespace scanmill
