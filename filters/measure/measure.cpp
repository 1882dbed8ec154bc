// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/measure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "measure/measurable.hpp"
#include "measure/sampled_distances.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/robust_box.hpp"
#include "scanmill/geometry/distance/enclosed.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"

namespace scanmill {

namespace {

using namespace measuring;

double rounding_within(const BoundingBox& one, const BoundingBox& other) {
    double largest = 0;
    for (const BoundingBox& box : {one, other})
        largest = std::max({largest, box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()});
    return position_rounding(largest);
}

/// Distances from one surface's samples and vertices to the other.
struct Direction {
    SurfaceSamples samples;
    NearestDistances nearest;   ///< distances of the samples
    NearestDistances vertices;  ///< by vertex
    DistanceNumbers numbers;
};

Direction measured_direction(const TriangleMesh& mesh, const TriangleTree& other, const MeasureParams& params,
                             u64 stream, double rounding, Context& context) {
    Direction result;
    result.samples = sample_surface(mesh, params.samples, context.random().stream(stream), context.threads());
    result.nearest = nearest_distances(result.samples.positions, other, rounding, context);
    result.vertices = nearest_of_vertices(mesh.positions.span(), mesh.triangles.span(), other, rounding, context);
    result.numbers = numbers_of(result.nearest.distances, result.vertices.distances);
    return result;
}

/// The positions of some vertices.
Array<Vec3> positions_at(const TriangleMesh& mesh, const Array<u32>& vertices) {
    Array<Vec3> positions;
    positions.reserve(vertices.size());
    for (const u32 vertex : vertices) positions.push_back(mesh.positions[vertex]);
    return positions;
}

/// Distances of all vertices: those in `found`, and those of vertices in no triangle, which `found` does not contain.
Array<double> distances_of_all(const TriangleMesh& mesh, const NearestDistances& found, const TriangleTree& truth,
                               double rounding, Context& context) {
    Array<double> distances = found.distances;
    Array<u32> unused;
    for (u32 vertex = 0; vertex < distances.size(); ++vertex)
        if (found.triangles[vertex] == NearestTriangle::none) unused.push_back(vertex);
    const Array<Vec3> positions = positions_at(mesh, unused);
    const NearestDistances further = nearest_distances(positions, truth, rounding, context);
    for (std::size_t i = 0; i < unused.size(); ++i) distances[unused[i]] = further.distances[i];
    return distances;
}

/// Negates the distances of vertices that the truth encloses. Pre: the truth is closed.
void sign_inside(Array<double>& distances, const TriangleMesh& mesh, const TriangleMesh& truth,
                 const TriangleTree& tree, Context& context) {
    Array<u32> apart;
    for (u32 vertex = 0; vertex < distances.size(); ++vertex)
        if (distances[vertex] > 0) apart.push_back(vertex);
    const Array<u8> is_inside =
        enclosed(positions_at(mesh, apart), truth.positions.span(), truth.triangles.span(), tree, context);
    for (std::size_t i = 0; i < apart.size(); ++i)
        if (is_inside[i]) distances[apart[i]] = -distances[apart[i]];
}

/// Cosines between the normals of samples and of the triangles nearest to them.
struct Cosines {
    CompensatedSum with_sign, without_sign;
    std::size_t pairs = 0, without_normal = 0;

    void add(const TriangleMesh& mesh, const Direction& direction, const TriangleMesh& other) {
        for (std::size_t i = 0; i < direction.samples.triangles.size(); ++i) {
            const Vec3 here = area_vector(mesh, direction.samples.triangles[i]);
            const Vec3 there = area_vector(other, direction.nearest.triangles[i]);
            const double lengths = here.norm() * there.norm();
            if (!(lengths > 0)) {
                ++without_normal;
                continue;
            }
            const double cosine = std::clamp(here.dot(there) / lengths, -1.0, 1.0);
            with_sign.add(cosine);
            without_sign.add(std::abs(cosine));
            ++pairs;
        }
    }

private:
    static Vec3 area_vector(const TriangleMesh& mesh, u32 row) {
        const auto& [a, b, c] = mesh.triangles[row];
        return (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
    }
};

void compare_normals(Measurement& result, const TriangleMesh& mesh, const Direction& to, const TriangleMesh& truth,
                     const Direction& from) {
    Cosines cosines;
    cosines.add(mesh, to, truth);
    cosines.add(truth, from, mesh);
    result.without_normal = cosines.without_normal;
    if (cosines.pairs == 0) return;
    result.normal_consistency = cosines.with_sign.value() / static_cast<double>(cosines.pairs);
    result.normal_consistency_unsigned = cosines.without_sign.value() / static_cast<double>(cosines.pairs);
}

NearShares shares_at(double threshold, const Direction& to, const Direction& from) {
    NearShares shares{threshold, share_within(to.nearest.distances, threshold),
                      share_within(from.nearest.distances, threshold), 0.0};
    const double sum = *shares.precision + shares.recall;
    if (sum > 0) shares.f_score = 2 * *shares.precision * shares.recall / sum;
    return shares;
}

void measure_mesh_alone(Measurement& result, const TriangleMesh& mesh, const TriangleTree& tree,
                        const MeasureParams& params, Context& context) {
    result.unit = mesh.frame.unit;
    result.diagonal = surface_box(mesh).diagonal();
    result.mesh = mesh_numbers(mesh, context.threads());
    context.progress(0.6);
    if (params.self_intersections)
        result.self_intersections =
            self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, context, 0).count;
    context.progress(0.8);
}

/// Throws Error, or warns with same_frame, if sizes and positions show that unit or frame differ.
void compare_extents(const TriangleMesh& mesh, const BoundingBox& truth, bool truth_may_be_part,
                     const MeasureParams& params, Context& context) {
    try {
        for (const std::string& warning :
             require_comparable(surface_box(mesh), truth, truth_may_be_part, mesh.frame.unit))
            context.warn(warning);
    } catch (const Error& error) {
        if (!params.same_frame) throw;
        context.warn(fmt::format("{}; measured anyway because of same-frame: true", error.sentence()));
    }
}

/// `direction`: "", "-to-truth" …
void add_distances(Metrics& metrics, const DistanceNumbers& numbers, std::string_view direction) {
    const auto add = [&](std::string_view name, double value) {
        metrics.set(fmt::format("{}{}", name, direction), value, Unit::length);
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

void add_topology(Metrics& metrics, const MeshTopology& topology, std::string_view prefix) {
    const auto add = [&](std::string_view name, auto value, Unit unit = Unit::count) {
        metrics.set(fmt::format("{}{}", prefix, name), static_cast<double>(value), unit);
    };
    add("vertices", topology.vertices);
    add("unused-vertices", topology.unused_vertices);
    add("triangles", topology.triangles);
    add("components", topology.components);
    if (topology.genus) add("genus", *topology.genus);
    add("euler", topology.euler);
    add("closed", topology.closed, Unit::boolean);
    add("boundary-loops", topology.boundary_loops);
    add("boundary-edges", topology.boundary_edges);
    add("nonmanifold-edges", topology.nonmanifold_edges);
    add("nonmanifold-vertices", topology.nonmanifold_vertices);
    add("misoriented-edges", topology.misoriented_edges);
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

Measurement measure(const TriangleMesh& mesh, const TriangleMesh& given_truth, const MeasureParams& params,
                    Context& context) {
    require_sound(params);
    require_surface(mesh, "mesh");
    require_surface(given_truth, "truth");
    if (params.borders == MeasureParams::Borders::exclude)
        throw Error("borders: exclude needs points as truth; the truth is a mesh of {}",
                    count_text(given_truth.triangles.size(), "triangle", "triangles"))
            .hint("set borders: include, or give the scan as truth");
    const std::vector<double> thresholds = thresholds_for(mesh, params);
    TriangleMesh truth = given_truth;
    truth.positions = in_frame_of(mesh.frame, given_truth.frame, given_truth.positions);
    truth.frame = mesh.frame;
    compare_extents(mesh, surface_box(truth), false, params, context);

    const double rounding = rounding_within(surface_box(mesh), surface_box(truth));
    const TriangleTree mesh_tree(mesh.positions.span(), mesh.triangles.span(), context.threads());
    const TriangleTree truth_tree(truth.positions.span(), truth.triangles.span(), context.threads());
    context.progress(0.1);
    const Direction to = measured_direction(mesh, truth_tree, params, 0, rounding, context);
    context.progress(0.3);
    const Direction from = measured_direction(truth, mesh_tree, params, 1, rounding, context);
    context.progress(0.5);

    Measurement result;
    result.to_truth = to.numbers;
    result.from_truth = from.numbers;
    result.both = numbers_of_both(to.numbers, to.nearest.distances, from.numbers, from.nearest.distances);
    result.chamfer = (to.numbers.mean + from.numbers.mean) / 2;
    for (const double threshold : thresholds) result.near.push_back(shares_at(threshold, to, from));
    compare_normals(result, mesh, to, truth, from);
    result.truth = mesh_numbers(truth, context.threads());
    result.vertex_distances = distances_of_all(mesh, to.vertices, truth_tree, rounding, context);
    if (result.truth->topology.closed) sign_inside(result.vertex_distances, mesh, truth, truth_tree, context);
    measure_mesh_alone(result, mesh, mesh_tree, params, context);
    const CertifiedSurface of_mesh{mesh.positions.span(), mesh.triangles.span(), mesh_tree,
                                   to.vertices,           to.samples.triangles,  to.nearest.distances};
    const CertifiedSurface of_truth{truth.positions.span(), truth.triangles.span(), truth_tree,
                                    from.vertices,          from.samples.triangles, from.nearest.distances};
    result.hausdorff = largest_distance(of_mesh, of_truth, params.gap.value(), context);
    if (params.certify) {
        const CertifyLimits limits{params.gap.value(), params.most_cuts};
        result.certified = certified_hausdorff(of_mesh, of_truth, *result.hausdorff, limits, context);
        result.hausdorff = result.certified->found;
    }
    context.progress(1);
    return result;
}

Measurement measure(const TriangleMesh& mesh, const PointCloud& truth, const MeasureParams& params, Context& context) {
    require_sound(params);
    require_surface(mesh, "mesh");
    const std::vector<double> thresholds = thresholds_for(mesh, params);
    if (truth.size() == 0)
        throw Error("the truth has no points; there is nothing to measure the mesh against")
            .hint("`scanmill info` shows what a file contains");
    require_finite(truth.positions.span(), "points of the truth");
    if (params.certify)
        throw Error("certify needs a mesh as truth; the truth is {}", count_text(truth.size(), "point", "points"))
            .hint("leave certify out, or give a mesh as truth");
    const Buffer<Vec3> points = in_frame_of(mesh.frame, truth.frame, truth.positions);
    const BoundingBox box = bounding_box(points.span());
    compare_extents(mesh, robust_box(points.span(), box).robust, true, params, context);

    const double rounding = rounding_within(surface_box(mesh), box);
    const TriangleTree mesh_tree(mesh.positions.span(), mesh.triangles.span(), context.threads());
    context.progress(0.1);
    NearestDistances from = nearest_distances(points.span(), mesh_tree, rounding, context);
    Measurement result;
    if (params.borders == MeasureParams::Borders::exclude)
        result.beyond_borders = leave_out_borders(from, points.span(), mesh, rounding);
    context.progress(0.3);
    const TriangleTree truth_tree = tree_of_points(points.span(), context.threads());
    const Direction to = measured_direction(mesh, truth_tree, params, 0, rounding, context);
    context.progress(0.5);

    result.to_points = to.numbers;
    result.from_truth = numbers_of(from.distances, {});
    result.from_truth.mean_spread.reset();
    result.both = result.from_truth;
    result.vertex_distances = distances_of_all(mesh, to.vertices, truth_tree, rounding, context);
    for (const double threshold : thresholds)
        result.near.push_back({threshold, {}, share_within(from.distances, threshold), {}});
    measure_mesh_alone(result, mesh, mesh_tree, params, context);
    context.progress(1);
    return result;
}

TriangleMesh deviation_of(const TriangleMesh& mesh, const Measurement& measured) {
    const Buffer<double> values = measured.vertex_distances;
    const Column distances = Column("distance-to-truth", 1, values).with_length_exponent(1);
    TriangleMesh result = mesh;
    result.vertex_columns = {};
    for (const Column& column : mesh.vertex_columns)
        if (column.name() != distances.name()) result.vertex_columns.add(column);
    result.vertex_columns.add(distances);
    return result;
}

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
