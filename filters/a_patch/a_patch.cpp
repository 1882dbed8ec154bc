// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/a_patch.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "a_patch/construction.hpp"
#include "a_patch/fit.hpp"
#include "a_patch/joint_fit.hpp"
#include "a_patch/normal_fit.hpp"
#include "a_patch/normals.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill {

namespace {

using namespace a_patches;

constexpr double thinnest = 1e-9;  // smallest ratio of height to longest edge of a triangle with area
constexpr std::size_t chunk = 1024;
constexpr double least_factor = 1.05, most_factor = 3;
// Limits beyond which the result is doubtful: a share of the vertices, a multiple of the points' rms distance from the
// mesh, and a share of the points.
constexpr double most_loosened = 0.1;
constexpr double most_worse = 1.01;
constexpr double most_left_out = 0.5;
constexpr double most_unseen = 0.1;  // share of the vertices without points
constexpr double rounding = 1e-12;  // share of the diagonal
constexpr double least_regularisation = 1e-6;
constexpr int most_rounds = 6;  // of bisections for max-error
constexpr unsigned segments_for_bulge = 4;  // that divide a sharp edge to measure `crease-max`

std::string position_text(const TriangleMesh& mesh, const Vec3& position) {
    const Vec3 p = mesh.frame.origin + position;
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

std::string position_text(const TriangleMesh& mesh, u32 vertex) { return position_text(mesh, mesh.positions[vertex]); }

// Refusals.

void require_areas(const TriangleMesh& mesh) {
    std::size_t count = 0, first = 0;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const Triangle& t = mesh.triangles[f];
        const Vec3 u = mesh.positions[t[1]] - mesh.positions[t[0]], v = mesh.positions[t[2]] - mesh.positions[t[0]];
        const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()});
        if (!(u.cross(v).norm() > thinnest * longest) && count++ == 0) first = f;
    }
    if (count > 0)
        throw Error("{} of {} triangles {} no area; the first is triangle {} at {}", count, mesh.triangles.size(),
                    by_count(count, "has", "have"), first, position_text(mesh, mesh.triangles[first][0]))
            .hint("`repair` replaces them; `decimate` makes well-shaped triangles");
}

/// Throws Error if boundary edges coincide, as in a mesh from an STL file.
void require_joined(const TriangleMesh& mesh, const Array<u32>& opposites) {
    std::vector<u32> boundary;
    for (u32 half = 0; half < opposites.size(); ++half)
        if (opposites[half] == half_edges::boundary) boundary.push_back(half);
    const std::vector<u32> cut = coincident_edges(mesh, boundary);
    if (cut.empty()) return;
    const u32 first = half_edges::start(mesh, cut[0]);
    throw Error("{} of {} boundary edges coincide with another boundary edge; the first begins at vertex {} at {}",
                cut.size(), boundary.size(), first, position_text(mesh, first))
        .hint("`repair` joins them");
}

MeshTopology require_usable(const TriangleMesh& mesh, const APatchParams& params) {
    if (!(params.apex_factor >= least_factor && params.apex_factor <= most_factor))
        throw Error("apex-factor must be from {} to {}; it is {}", least_factor, most_factor, params.apex_factor)
            .hint(fmt::format("the default is {}", APatchParams().apex_factor));
    if (!(params.fairing >= 0 && std::isfinite(params.fairing)))
        throw Error("fairing must be at least 0; it is {}", params.fairing)
            .hint("1 takes the weight that predicts the points best; 10 makes the surface smoother");
    if (!(params.regularisation >= least_regularisation && params.regularisation <= 1))
        throw Error("regularisation must be from {} to 1; it is {}", least_regularisation, params.regularisation)
            .hint(fmt::format("the default is {}; larger values are used where they predict the points better",
                              APatchParams().regularisation));
    if (params.max_error && !(params.max_error->value() > 0))
        throw Error("max-error must be above 0; it is {:g}", params.max_error->value())
            .hint("leave it out to accept any distance");
    require_finite(mesh.positions.span(), "vertices");
    const Array<u32> opposites = half_edges::opposites(mesh);
    require_areas(mesh);
    require_joined(mesh, opposites);
    const MeshTopology counts = topology(mesh);
    if (counts.nonmanifold_vertices > 0)
        throw Error("at {} of {} vertices the triangles do not form one fan", counts.nonmanifold_vertices,
                    counts.vertices)
            .hint("`repair` separates the fans");
    return counts;
}

// Normals.

/// Throws if most given normals point inwards.
void require_outward(std::span<const Vec3> normals, std::span<const Vec3> of_mesh) {
    std::size_t inward = 0, count = 0;
    for (std::size_t v = 0; v < normals.size(); ++v) {
        count += normals[v] != Vec3::Zero();
        inward += normals[v].dot(of_mesh[v]) < 0;
    }
    if (2 * inward > count)
        throw Error("{} of {} normals point against the triangles at their vertices", inward, count)
            .hint("the mesh or its normals are inside out; 'normals: mesh' computes the normals from the triangles");
}

CornerNormals corner_normals(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params,
                             Context& context) {
    using Normals = APatchParams::Normals;
    Normals source = params.normals;
    const bool has_points = points && points->size() > 0;
    if (source == Normals::automatic)
        source = mesh.face_columns.find("corner-normals") ? Normals::given
                 : has_points                             ? Normals::points
                                                          : Normals::mesh;
    if (source == Normals::points && !points)
        throw Error("`normals: points` needs points, and the input `points` is not wired")
            .hint("wire the scan: 'in: {points: scan}', or choose 'normals: mesh'");
    if (source == Normals::points && !has_points)
        throw Error("`normals: points` needs points; the input `points` is empty")
            .hint("'normals: mesh' needs no points");
    const Sectors sectors = sectors_of(mesh);
    std::vector<Vec3> normals = mesh_normals(mesh, sectors);
    if (source == Normals::points) {
        normals = point_normals(mesh, sectors, points->positions.span(), normals, context);
    } else if (source == Normals::given) {
        GivenNormals given = given_normals(mesh, sectors);
        require_outward(given.normals, normals);
        if (given.several > 0)
            context.warn(
                fmt::format("at {} the corner normals differ although no sharp edge separates them; the filter uses "
                            "their mean",
                            count_text(given.several, "vertex", "vertices")));
        // A corner without a normal is the tip of a cone, unless the triangles are folded there.
        const std::vector<std::vector<u32>> corners = corners_of(sectors);
        const std::vector<Vec3> of_triangles = triangle_normals(mesh);
        for (std::size_t s = 0; s < sectors.size(); ++s) {
            if (given.normals[s] != Vec3::Zero()) continue;
            const std::vector<Vec3> around = normals_at(corners[s], of_triangles);
            if (!opposes(normals[s], around)) continue;
            const Vec3 direction = most_normal(around);
            if (opposes(direction, around)) given.normals[s] = direction;
        }
        normals = std::move(given.normals);
    }
    return at_corners(sectors, normals);
}

// The surface.

/// The mesh's sharp edges without those on the boundary.
Array<Edge> inner_edges(const TriangleMesh& mesh) {
    const Array<u32> opposites = half_edges::opposites(mesh);
    Array<Edge> inner;
    for (u32 half = 0; half < opposites.size(); ++half) {
        if (opposites[half] == half_edges::boundary || opposites[half] < half) continue;
        const Edge edge = make_edge(half_edges::start(mesh, half), half_edges::end(mesh, half));
        if (std::ranges::binary_search(mesh.sharp_edges, edge)) inner.push_back(edge);
    }
    std::ranges::sort(inner);
    return inner;
}

/// Fits the slopes of the construction's hull, and measures the distances of the points. Returns the new weights. Pre:
/// the construction's weights are those of its hull, without violations at creases.
Weights fit_and_measure(Construction& construction, const PointCloud* points, const APatchParams& params,
                        APatchResult& result, Context& context) {
    Hull& hull = construction.hull;
    Weights weights = std::move(construction.weights);
    const std::span<const Vec3> positions = points ? points->positions.span() : std::span<const Vec3>();
    const LocatedPoints located = locate(weights.patches, positions, context);
    result.left_out = located.left_out;
    if (params.fit && !result.joint_fit) {
        const auto violating_triangles = [&](const PatchComplex& patches) {
            return construction.violating_triangles(patches);
        };
        FitResult fitted = fit(hull, std::move(weights), located, params.curvature, {params.regularisation},
                               violating_triangles, context);
        weights = std::move(fitted.weights);
        result.regularisation = fitted.regularisation;
    }
    result.fit.reset();
    if (located.points.empty()) return weights;
    PointDistances found = distances(hull, weights.patches, positions, located, context);
    const auto count = static_cast<double>(located.points.size());
    const auto rms = [&](const std::vector<double>& each) {
        double squares = 0;
        for (const double d : each) squares += d * d;
        return std::sqrt(squares / count);
    };
    const double to_surface = rms(found.to_surface);
    result.fit = {to_surface, quantile(found.to_surface, 0.95), *std::ranges::max_element(found.to_surface),
                  rms(found.to_mesh)};
    return weights;
}

/// Raises a doubt if the surface and the points are farther apart than max-error.
void doubt_distances(const Certificate& certificate, double max_error, const TriangleMesh& mesh,
                     const PointCloud& points, Context& context) {
    const std::string unit(symbol(mesh.frame.unit));
    if (certificate.beyond > 0)
        context.doubt(fmt::format(
            "{} of {} {} farther from the surface than max-error, {:.3g} {}; the farthest is {:.3g} "
            "{} away, at {}",
            certificate.beyond, count_text(points.size(), "point", "points"), by_count(certificate.beyond, "is", "are"),
            max_error, unit, certificate.point.distance, unit, position_text(mesh, certificate.point.position)));
    if (certificate.surface.distance > max_error)
        context.doubt(fmt::format(
            "at {} the surface is {:.3g} {} farther from the nearest point than the points from "
            "each other; max-error is {:.3g} {}",
            position_text(mesh, certificate.surface.position), certificate.surface.distance, unit, max_error, unit));
}

void warn_about(const APatchResult& result, std::span<const u32> crossing, const TriangleMesh& mesh,
                const PointCloud* points, const MeshTopology& counts, const APatchParams& params, Context& context) {
    if (counts.boundary_edges > 0)
        context.warn(fmt::format("the mesh is open: the surface ends at {}",
                                 count_text(counts.boundary_edges, "boundary edge", "boundary edges")));
    const Repairs& repairs = result.repairs;
    if (repairs.replaced > 0)
        context.warn(fmt::format("{} turned because of an opposing triangle",
                                 count_text(repairs.replaced, "normal is", "normals are")));
    if (repairs.bisected > 0)
        context.warn(
            fmt::format("{} bisected, because tetrahedra were inside out or too large there, or a crease left its edge",
                        count_text(repairs.bisected, "edge is", "edges are")));
    if (repairs.creased > 0)
        context.warn(fmt::format("{} sharp, because the mesh is folded there",
                                 count_text(repairs.creased, "edge becomes", "edges become")));
    if (repairs.smoothed > 0)
        context.warn(fmt::format("{} smooth, because the surface has nearly one normal on both sides",
                                 count_text(repairs.smoothed, "sharp edge becomes", "sharp edges become")));
    if (repairs.opened > 0)
        context.warn(
            fmt::format("at {} a narrow straight strip joins the surfaces of the two triangles, because no "
                        "tetrahedra fit between them",
                        count_text(repairs.opened, "edge", "edges")));
    if (result.loosened > 0) {
        const std::string text = fmt::format(
            "no smooth surface fits at {} of {} vertices: the surface follows the mesh at {} there", result.loosened,
            result.mesh.positions.size(), count_text(repairs.flattened, "triangle", "triangles"));
        if (static_cast<double>(result.loosened) > most_loosened * static_cast<double>(result.mesh.positions.size()))
            context.doubt(text);
        else
            context.warn(text);
    }
    if (points && points->size() == 0)
        context.warn(fmt::format("the input `points` is empty: {}",
                                 params.fit ? "the surface is not fitted" : "no distance is measured"));
    else if (points && static_cast<double>(result.left_out) > most_left_out * static_cast<double>(points->size()))
        context.doubt(fmt::format(
            "{} of {} in no tetrahedron near the surface and {} not {}; check that the mesh and the points show the "
            "same object in the same position",
            result.left_out, count_text(points->size(), "point is", "points are"),
            by_count(result.left_out, "does", "do"), params.fit ? "count in the fit" : "count"));
    if (result.joint_fit && result.left_out < points->size() &&
        static_cast<double>(result.joint_fit->unseen) > most_unseen * static_cast<double>(result.mesh.positions.size()))
        context.doubt(fmt::format(
            "no point is near {} of {} vertices: the surface there only continues its surroundings; scan the rest, or "
            "cut it off",
            result.joint_fit->unseen, result.mesh.positions.size()));
    if (result.certificate) doubt_distances(*result.certificate, params.max_error->value(), mesh, *points, context);
    if (!crossing.empty())
        context.doubt(fmt::format("parts of the surface intersect at {}, because the mesh intersects itself there",
                                  count_text(crossing.size(), "triangle", "triangles")));
    if (result.fit && result.fit->rms > most_worse * result.fit->rms_to_mesh + rounding * surface_box(mesh).diagonal())
        context.doubt(fmt::format(
            "the points are farther from the surface (rms {0:.3g} {2}) than from the mesh (rms {1:.3g} {2})",
            result.fit->rms, result.fit->rms_to_mesh, symbol(mesh.frame.unit)));
    if (result.sign_violations > 0)
        context.doubt(fmt::format("the surface may have several sheets at {} with a wrong sign",
                                  count_text(result.sign_violations, "edge or weight", "edges or weights")));
    if (!counts.closed) return;
    if (signed_volume(mesh.positions.span(), mesh.triangles.span()) < 0)
        context.doubt("the mesh is inside out: the result exchanges inside and outside");
}

void report(const APatchResult& result, Context& context) {
    const auto count = [&](std::string_view name, std::size_t number) {
        context.metric(name, static_cast<double>(number));
    };
    count("tetrahedra", result.patches.tets.size());
    count("inverted", result.inverted);
    context.metric("c1-jump", result.c1_jump, Unit::number);
    count("sign-violations", result.sign_violations);
    count("refined", result.repairs.bisected + (result.joint_fit ? result.joint_fit->bisected : 0));
    count("split-faces", result.divided);
    count("raised", result.raised);
    count("creased-edges", result.repairs.creased);
    count("smoothed-edges", result.repairs.smoothed);
    count("pointed-vertices", result.loosened);
    count("flat-triangles", result.repairs.flattened);
    count("straight-edges", result.repairs.opened);
    if (result.fit) {
        context.metric("fit-rms", result.fit->rms, Unit::length);
        context.metric("fit-p95", result.fit->p95, Unit::length);
        context.metric("fit-max", result.fit->max, Unit::length);
    }
    if (result.certificate) {
        context.metric("error", std::max(result.certificate->point.distance, result.certificate->surface.distance),
                       Unit::length);
        count("beyond", result.certificate->beyond);
    }
    count("left-out", result.left_out);
    context.metric("crease-max", result.crease_max, Unit::length);
    if (result.regularisation) context.metric("regularisation", *result.regularisation, Unit::number);
    count("turned", result.repairs.replaced);
    if (!result.joint_fit) return;
    context.metric("weight", result.joint_fit->weight, Unit::number);
    context.metric("offset-rms", result.joint_fit->offset_rms, Unit::length);
    context.metric("offset-max", result.joint_fit->offset_max, Unit::length);
    count("flips", result.joint_fit->flips);
}

/// Gives vertices without sharp edges these normals.
void restore_whole_sectors(PatchMesh& mesh, const CornerNormals& normals) {
    const Sectors sectors = sectors_of(mesh.mesh);
    for (std::size_t f = 0; f < normals.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i)
            if (sectors.is_whole[sectors.of_corner[f][i]]) mesh.normals[f][i] = normals[f][i];
}

bool interpolates(const APatchParams& params) {
    using Interpolate = APatchParams::Interpolate;
    return params.interpolate == Interpolate::yes ||
           (params.interpolate == Interpolate::automatic && params.normals != APatchParams::Normals::automatic);
}

}  // namespace

APatchResult a_patch(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params, Context& context) {
    if (mesh.triangles.empty())
        throw Error("needs a mesh with triangles; it has {} vertices and no triangles", mesh.positions.size());
    const MeshTopology counts = require_usable(mesh, params);
    if (params.max_error && (!points || points->size() == 0))
        throw Error("max-error needs points, and {}",
                    points ? "the input `points` is empty" : "the input `points` is not wired")
            .hint("wire the scan: 'in: {points: scan}', or leave max-error out");
    if (points) {
        require_finite(points->positions.span());
        require_same_frame(points->frame, "the points are", mesh.frame, "the mesh");
    }
    APatchResult result;
    PatchMesh work;
    work.mesh.frame = mesh.frame;
    work.mesh.positions = mesh.positions;
    work.mesh.triangles = mesh.triangles;
    work.mesh.sharp_edges = inner_edges(mesh);
    TriangleMesh with_columns = work.mesh;
    with_columns.face_columns = mesh.face_columns;
    work.normals = corner_normals(with_columns, points, params, context);
    context.progress(0.2);

    const ConstructionParams of_construction{params.apex_factor, params.split, params.curvature};
    Construction prepared(work, of_construction, context);
    prepared.prepare();
    const std::size_t turned_before = prepared.repairs.replaced;
    const bool is_automatic = params.normals == APatchParams::Normals::automatic;
    if (points && points->size() > 0 && params.fit) {
        const CornerNormals given = work.normals;
        if (is_automatic && (interpolates(params) || !work.mesh.sharp_edges.empty()))
            fit_normals(work, points->positions.span(), context);
        if (!interpolates(params)) {
            restore_whole_sectors(work, given);
            result.joint_fit = fit_jointly(work, points->positions.span(), params.fairing, context);
            prepared.prepare_normals();
        }
    }
    std::optional<Construction> constructed;
    Weights weights;
    std::optional<PointTree> tree;
    if (params.max_error) tree.emplace(points->positions.span(), context.threads());
    for (int round = 0;; ++round) {
        const PatchMesh fitted = work;
        constructed.emplace(work, of_construction, context);
        constructed->repairs = prepared.repairs;
        constructed->run();
        assert(constructed->hull.faults.inverted.empty());
        if (round == 0) context.progress(0.5);
        weights = fit_and_measure(*constructed, points, params, result, context);
        if (!params.max_error) break;
        const std::span<const Vec3> positions = points->positions.span();
        const double max_error = params.max_error->value();
        const PatchDistances distances = distances_to_patches(weights.patches, positions, context);
        const std::optional<Certificate> before = result.certificate;
        result.certificate =
            certify(weights.patches, distances, positions, *tree, counts.boundary_edges == 0, max_error, context);
        const bool is_nearer = !before || result.certificate->beyond < before->beyond ||
                               result.certificate->point.distance < before->point.distance;
        if (!result.joint_fit || round == most_rounds || !is_nearer) break;
        const std::vector<u32> far = far_triangles(fitted.mesh, distances, *tree, max_error, context);
        if (far.empty()) break;
        work = fitted;
        result.joint_fit = fit_refined(work, far, positions, *result.joint_fit, context);
        prepared.repairs.replaced = turned_before;
        prepared.prepare_normals();
    }
    Construction& construction = *constructed;
    const Hull& hull = construction.hull;
    result.repairs = construction.repairs;
    result.raised = weights.raised;
    result.divided = static_cast<std::size_t>(std::ranges::count(hull.faces, true, &HullFace::is_divided));
    result.patches = std::move(weights.patches);
    result.patches.frame = mesh.frame;
    context.progress(0.9);
    result.inverted = inverted_tets(result.patches);
    result.sign_violations = sign_violations(result.patches, construction.verdicts, context);
    result.c1_jump = c1_jump(result.patches, context);
    result.flat = std::move(work.flat);
    result.flat.resize(work.mesh.triangles.size(), false);
    std::vector<bool> is_loosened(work.mesh.positions.size(), false);
    for (std::size_t f = 0; f < result.flat.size(); ++f)
        if (result.flat[f])
            for (const u32 v : work.mesh.triangles[f]) is_loosened[v] = true;
    for (u32 e = 0; e < hull.edges.size(); ++e)
        if (hull.is_open_within_smooth(e)) is_loosened[hull.edges[e].a] = is_loosened[hull.edges[e].b] = true;
    result.loosened = static_cast<std::size_t>(std::ranges::count(is_loosened, true));
    result.mesh = std::move(work.mesh);
    Array<double> components;
    for (const auto& of_triangle : work.normals)
        for (const Vec3& n : of_triangle) components.insert(components.end(), n.data(), n.data() + 3);
    result.mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(components))));
    result.crease_max = largest_bulge(result.patches, segments_for_bulge, context);
    warn_about(result, construction.crossing, mesh, points, counts, params, context);
    report(result, context);
    return result;
}

}  // namespace scanmill
