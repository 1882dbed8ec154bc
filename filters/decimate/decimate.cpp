// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/decimate.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "decimate/corner_normals.hpp"
#include "decimate/decimator.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/distance/nearest_distances.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/mesh/creases.hpp"

namespace scanmill {

namespace {

using namespace decimating;

/// Features smaller than this many times the largest error are roughness. On scanned models, this value leaves few
/// corners that are due to noise. On CAD models, it loses no line of the model at errors up to 1 % of the diagonal.
constexpr double feature_reach = 4;
/// Sine of 5 degrees, the least angle of triangles in flat faces.
constexpr double flat_angle_sine = 0.08715574274765817;
/// Share of the largest error that removals may use. The rest lets the certificate prove the largest error with few
/// cuts.
constexpr double steering_share = 1 - 0x1p-10;
/// If the certificate still exceeds the largest error, decimation is repeated with a smaller error. That error is
/// scaled by the excess of the certificate, and by this factor for safety. `most_attempts` limits the number of
/// attempts.
constexpr double again_share = 0.98;
constexpr int most_attempts = 4;
/// Least error bound, as a share of the diagonal: the certificate cannot prove a smaller one.
constexpr double negligible = 1e-10;

void require_angle(const char* name, const Angle& angle, double least, double most) {
    if (!(angle.in_degrees() >= least && angle.in_degrees() <= most))
        throw Error("{} must be from {} to {} deg; it is {}", name, least, most, angle.text())
            .hint(fmt::format("leave {} out for the default, which suits most meshes", name));
}

double length_of(const char* name, const Length& length) {
    const double value = length.value();
    if (!(value >= 0 && std::isfinite(value)))
        throw Error("{} must be 0 or more; it is {} u", name, value)
            .hint("`0.1 %diag` is a thousandth of the mesh's diagonal");
    return value;
}

/// `share`: allowed share of the largest errors.
Limits limits_for(const DecimateParams& params, double share, double rounding) {
    if (params.noise) (void)length_of("noise", *params.noise);
    require_angle("sharp-angle", params.sharp_angle, 20, 75);
    require_angle("corner-angle", params.corner_angle, 0, 180);
    require_angle("normal-deviation", params.normal_deviation, 0, 89);
    require_angle("min-angle", params.min_angle, 0, 30);
    if (params.max_valence < 6 || params.max_valence > 64)
        throw Error("max-valence must be from 6 to 64; it is {}", params.max_valence)
            .hint("leave max-valence out for the default, which suits most meshes");
    Limits limits;
    limits.error.outside =
        params.outside ? length_of("outside", *params.outside) : length_of("max-error", params.max_error);
    limits.error.inside =
        params.inside ? length_of("inside", *params.inside) : length_of("max-error", params.max_error);
    for (double* error : {&limits.error.outside, &limits.error.inside}) *error = *error * share + rounding;
    limits.normal_cosine = elementary::turn_of(params.normal_deviation.in_radians()).cosine - 1e-9;
    limits.angle_sine = elementary::turn_of(params.min_angle.in_radians()).sine;
    limits.flat_angle_sine = std::min(limits.angle_sine, flat_angle_sine);
    limits.max_valence = params.max_valence;
    return limits;
}

void require_usable(const TriangleMesh& mesh) {
    if (mesh.triangles.empty())
        throw Error("needs a mesh with triangles; this one has {} and none",
                    count_text(mesh.positions.size(), "vertex", "vertices"))
            .hint("mesh the points first, with alpha-solid or region-grow");
    require_consistent(mesh);
    require_finite(mesh.positions.span(), "vertices");
}

/// Warns about data that the result loses, and about seams. `lowest`: lowest_at_position().
void warn_about(const TriangleMesh& mesh, std::span<const u32> lowest, Context& context) {
    std::size_t unused = mesh.positions.size();
    std::vector<bool> is_used(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle)
            if (!is_used[vertex]) is_used[vertex] = true, --unused;
    if (unused > 0)
        context.warn(fmt::format("{} in no triangle {} dropped", count_text(unused, "vertex", "vertices"),
                                 by_count(unused, "is", "are")));
    warn_of_dropped(mesh.face_columns, "face columns", "the triangles are new", context);
    warn_of_dropped(mesh.edge_columns, "edge columns", "the edges are new", context);
    if (mesh.vertex_columns.find("class"))
        context.warn("the vertex column 'class' is replaced by the classes of this filter");
    std::vector<bool> is_taken(mesh.positions.size(), false);
    std::size_t duplicates = 0;
    for (u32 vertex = 0; vertex < mesh.positions.size(); ++vertex)
        if (is_used[vertex]) {
            duplicates += is_taken[lowest[vertex]];
            is_taken[lowest[vertex]] = true;
        }
    if (duplicates > 0)
        context.warn(fmt::format("{} the position of another vertex; the mesh is open there and stays open",
                                 count_text(duplicates, "vertex has", "vertices have")));
}

/// Data points in the mesh's coordinates.
Buffer<Vec3> data_positions(const PointCloud& points, const Frame& frame) {
    require_finite(points.positions.span());
    require_same_frame(points.frame, "the points are", frame, "the mesh");
    return translated(points.positions, points.frame.origin - frame.origin);
}

/// The vertices of the result.
struct Kept {
    Array<u32> vertices;  ///< rows of the input's vertices, ascending
    Array<u32> numbers;  ///< by vertex of the input: its row in the result, or `none`
};

Kept kept_vertices(const EditableMesh& mesh) {
    Kept kept;
    kept.numbers.assign(mesh.vertices(), EditableMesh::none);
    for (u32 vertex = 0; vertex < mesh.vertices(); ++vertex) {
        if (!mesh.is_used(vertex)) continue;
        kept.numbers[vertex] = static_cast<u32>(kept.vertices.size());
        kept.vertices.push_back(vertex);
    }
    return kept;
}

Array<Edge> sharp_edges_of(const Surface& surface, const Array<u32>& numbers) {
    const EditableMesh& mesh = surface.mesh();
    Array<Edge> edges;
    for (u32 half_edge = 0; half_edge < 3 * mesh.rows(); ++half_edge) {
        if (mesh.is_empty(half_edge / 3) || mesh.is_boundary(half_edge) || mesh.opposite(half_edge) < half_edge)
            continue;
        if (surface.is_feature(half_edge))
            edges.push_back(make_edge(numbers[mesh.start(half_edge)], numbers[mesh.end(half_edge)]));
    }
    std::ranges::sort(edges);
    return edges;
}

/// Number of lines of sharp edges. A line ends at vertices whose class is not crease; a closed line has no end.
std::size_t count_lines(std::span<const Edge> edges, std::span<const u8> classes) {
    DisjointSets vertices(classes.size());
    std::vector<u32> degree(classes.size(), 0);
    std::size_t ends = 0;
    const auto is_inner = [&](u32 vertex) { return classes[vertex] == static_cast<u8>(VertexClass::crease); };
    for (const auto& [a, b] : edges) {
        ends += !is_inner(a);
        ends += !is_inner(b);
        if (is_inner(a) && is_inner(b)) vertices.unite(a, b);
    }
    // A closed line is a component of inner vertices without an edge to an end.
    std::vector<bool> is_open(classes.size(), false);
    for (const auto& [a, b] : edges) {
        if (is_inner(a) && !is_inner(b)) is_open[vertices.find(a)] = true;
        if (is_inner(b) && !is_inner(a)) is_open[vertices.find(b)] = true;
    }
    std::size_t closed = 0;
    for (u32 vertex = 0; vertex < classes.size(); ++vertex)
        closed += is_inner(vertex) && vertices.find(vertex) == vertex && !is_open[vertex];
    return ends / 2 + closed;
}

template <class T>
Column length_column(std::string name, Array<T> values) {
    return Column(std::move(name), 1, Buffer<T>(std::move(values))).with_length_exponent(1);
}

/// The result's mesh, with all columns.
TriangleMesh result_mesh(const TriangleMesh& mesh, const Surface& surface, std::span<const u32> opposite,
                         const Creases& creases) {
    const Kept kept = kept_vertices(surface.mesh());
    TriangleMesh result;
    result.frame = mesh.frame;
    result.positions = gather(mesh.positions, std::span<const u32>(kept.vertices));
    for (const Column& column : mesh.vertex_columns)
        if (column.name() != "class") result.vertex_columns.add(column.gather(kept.vertices));
    Array<Triangle> triangles = surface.mesh().compact_triangles();
    for (Triangle& triangle : triangles)
        for (u32& vertex : triangle) vertex = kept.numbers[vertex];
    result.triangles = std::move(triangles);
    result.sharp_edges = sharp_edges_of(surface, kept.numbers);

    Array<u8> classes;
    for (const u32 vertex : kept.vertices)
        classes.push_back(static_cast<u8>(surface.original.features().vertex_class(vertex)));
    result.vertex_columns.add(Column("class", 1, Buffer<u8>(std::move(classes))));
    const Array<CornerNormals> corners = corner_normals(surface, mesh, opposite, creases);
    Array<double> components(9 * corners.size()), outside, inside;
    for (std::size_t i = 0; i < corners.size(); ++i)
        std::ranges::copy(corners[i], components.begin() + static_cast<std::ptrdiff_t>(9 * i));
    for (u32 row = 0; row < surface.mesh().rows(); ++row) {
        if (surface.mesh().is_empty(row)) continue;
        outside.push_back(surface.errors(row).outside);
        inside.push_back(surface.errors(row).inside);
    }
    result.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(components))));
    result.face_columns.add(length_column("error-outside", std::move(outside)));
    result.face_columns.add(length_column("error-inside", std::move(inside)));
    return result;
}

[[noreturn]] void throw_exceeded(const CertifiedHausdorff& certificate, double bound, DecimateMode mode) {
    throw Error(
        "the distance between input and result is not proven to be within max-error ({:.6g} u); the distance is at "
        "least {:.6g} u and at most {:.6g} u",
        bound, certificate.lower, certificate.upper)
        .hint(mode == DecimateMode::accumulated ? "use mode: direct, which measures errors to the input"
                                                : "use a slightly different max-error");
}

void report(const DecimateResult& result, Context& context) {
    const auto count = [&](const char* name, std::size_t value) { context.metric(name, static_cast<double>(value)); };
    count("triangles", result.mesh.triangles.size());
    count("removed", result.removed);
    count("flips", result.flips);
    count("creases", result.creases);
    count("corners", result.corners);
    context.metric("hausdorff-lower", result.certificate.lower, Unit::length);
    context.metric("hausdorff-upper", result.certificate.upper, Unit::length);
    context.metric("certified", 1, Unit::boolean);
    if (!result.points_max) return;
    context.metric("points-max", *result.points_max, Unit::length);
    count("points-beyond", result.points_beyond);
}

/// The input, and the data derived from it that all attempts share.
struct Input {
    const TriangleMesh& mesh;
    const Array<u32>& opposite;
    const Creases& creases;
    const OriginalSurface& original;
    std::span<const Vec3> data;
    std::span<const u32> data_triangles;  ///< by data point; NearestTriangle::none if it is left out
};

DecimateResult attempt(const Input& input, const Limits& limits, const DecimateParams& params, Context& context) {
    Surface surface(input.original, EditableMesh(input.mesh, input.opposite), input.data);
    for (u32 i = 0; i < input.data.size(); ++i)
        if (input.data_triangles[i] != NearestTriangle::none)
            surface.assign(static_cast<u32>(input.mesh.positions.size()) + i, input.data_triangles[i]);
    Decimator decimator(surface, limits, params.mode, params.target_triangles, context);
    const DecimatorCounts counts = decimator.run(params.final_flips);
    DecimateResult result;
    result.removed = counts.removed;
    result.flips = counts.flips;
    result.mesh = result_mesh(input.mesh, surface, input.opposite, input.creases);
    const std::span<const u8> classes = result.mesh.vertex_columns.find("class")->values<u8>();
    result.creases = count_lines(result.mesh.sharp_edges.span(), classes);
    result.corners = static_cast<std::size_t>(std::ranges::count(classes, static_cast<u8>(VertexClass::corner)));
    return result;
}

}  // namespace

DecimateResult decimate(const TriangleMesh& mesh, const PointCloud* points, const DecimateParams& params,
                        Context& context) {
    require_usable(mesh);
    const BoundingBox box = surface_box(mesh);
    const double rounding = position_rounding(std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()));
    (void)limits_for(params, steering_share, rounding);  // refuses before any work
    const double max_error =
        std::max(params.outside.value_or(params.max_error).value(), params.inside.value_or(params.max_error).value());
    Buffer<Vec3> data;
    if (points != nullptr) data = data_positions(*points, mesh.frame);
    const Array<u32> opposite = half_edges::opposites(mesh);
    (void)EditableMesh(mesh, opposite);  // refuses repeated vertices and vertices with several fans
    const Array<u32> lowest = lowest_at_position(mesh.positions.span());
    warn_about(mesh, lowest, context);
    if (max_error >= box.diagonal())
        context.warn(fmt::format(
            "max-error is {:.6g} u and the mesh's diagonal is {:.6g} u: only the topology and the shapes of triangles "
            "limit the result",
            max_error, box.diagonal()));
    CreaseParams crease_params{
        .sharp_angle = params.sharp_angle.in_radians(), .noise = {}, .least_size = feature_reach * max_error};
    if (params.noise) crease_params.noise = params.noise->value();
    const Creases creases = find_creases(mesh, opposite, crease_params, context);
    const FeatureScale scale{params.corner_angle.in_radians(), std::max(creases.reach, feature_reach * max_error)};
    const FeatureNetwork features(mesh, opposite, creases.sharp, scale);
    if (features.ignored_declared() > 0)
        context.warn(
            fmt::format("{} of the {} sharp edges of the mesh {} treated as smooth: their lines have a free end and "
                        "are shorter than {} max-error, or they enclose faces that are as small",
                        features.ignored_declared(), mesh.sharp_edges.size(),
                        by_count(features.ignored_declared(), "is", "are"), feature_reach));
    const OriginalSurface original(mesh, opposite, lowest, features);
    context.progress(Decimator::progress_begin / 2);
    NearestDistances nearest;
    std::size_t left_out = 0;
    if (!data.empty()) {
        const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), context.threads());
        nearest = nearest_distances(data, tree, rounding, context);
        for (std::size_t i = 0; i < data.size(); ++i)
            if (nearest.distances[i] > max_error + rounding) nearest.triangles[i] = NearestTriangle::none, ++left_out;
    }
    context.progress(Decimator::progress_begin);

    const Input input{mesh, opposite, creases, original, data, nearest.triangles};
    const double bound = std::max(max_error + 2 * rounding, negligible * box.diagonal());
    double share = steering_share;
    DecimateResult result;
    for (int attempts = 1;; ++attempts) {
        result = attempt(input, limits_for(params, share, rounding), params, context);
        context.progress(Decimator::progress_end);
        result.certificate = certified_hausdorff(result.mesh, mesh, {0.01, 100'000'000, bound}, context);
        if (result.certificate.upper <= bound) break;
        if (attempts == most_attempts) throw_exceeded(result.certificate, bound, params.mode);
        share *= again_share * std::min(1.0, bound / result.certificate.lower);
    }
    result.points_left_out = left_out;
    if (left_out > 0 && params.mode == DecimateMode::direct)
        context.warn(fmt::format(
            "{} of the {} points {} farther than max-error from the input mesh; {} not limit the result", left_out,
            data.size(), by_count(left_out, "is", "are"), by_count(left_out, "it does", "they do")));
    if (params.target_triangles > 0 && result.mesh.triangles.size() > params.target_triangles)
        context.warn(fmt::format(
            "{} triangles are left, but target-triangles is {}: max-error or another limit forbids further removals",
            result.mesh.triangles.size(), params.target_triangles));
    if (points != nullptr) {
        result.points_max = 0;
        if (!data.empty()) {
            const TriangleTree tree(result.mesh.positions.span(), result.mesh.triangles.span(), context.threads());
            const NearestDistances to_result = nearest_distances(data, tree, rounding, context);
            result.points_max = std::ranges::max(to_result.distances);
            result.points_beyond = static_cast<std::size_t>(
                std::ranges::count_if(to_result.distances, [&](double distance) { return distance > bound; }));
        }
    }
    report(result, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
