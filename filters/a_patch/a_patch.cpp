// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/a_patch.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "a_patch/checks.hpp"
#include "a_patch/fit.hpp"
#include "a_patch/normal_fit.hpp"
#include "a_patch/normals.hpp"
#include "a_patch/refinement.hpp"
#include "a_patch/repair.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

using namespace a_patches;

constexpr double thinnest = 1e-9;  // smallest ratio of height to longest edge of a triangle with area
constexpr std::size_t most_bisections = 7;  // rounds
constexpr std::size_t most_crease_rounds = 2;
constexpr std::size_t chunk = 1024;
constexpr double least_factor = 1.05, most_factor = 3;
// Limits beyond which the result is doubtful: a share of the vertices, a multiple of the points' rms distance from the
// mesh, and a share of the points.
constexpr double most_loosened = 0.1;
constexpr double most_worse = 1.01;
constexpr double most_left_out = 0.5;
constexpr double rounding = 1e-12;  // share of the diagonal
constexpr double least_regularisation = 1e-6;

std::string position_text(const TriangleMesh& mesh, u32 vertex) {
    const Vec3 p = mesh.frame.origin + mesh.positions[vertex];
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

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
            .hint("0 disables fairing; at 1 fairness weighs about as much as the points");
    if (!(params.regularisation >= least_regularisation && params.regularisation <= 1))
        throw Error("regularisation must be from {} to 1; it is {}", least_regularisation, params.regularisation)
            .hint(fmt::format("the default is {}; larger values are used where they predict the points better",
                              APatchParams().regularisation));
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

/// The triangles that are too near to the next sheet, and the triangles beside `edges`; ascending.
std::vector<u32> triangles_at(const Hull& hull, std::span<const u32> edges) {
    std::vector<u32> triangles = hull.faults.thin;
    for (const u32 e : edges) {
        triangles.push_back(hull.edges[e].first);
        triangles.push_back(hull.edges[e].second);
    }
    std::ranges::sort(triangles);
    triangles.erase(std::ranges::unique(triangles).begin(), triangles.end());
    return triangles;
}

/// Repairs the mesh until its hull carries a surface. In the end, every edge beside which tetrahedra do not fit is
/// straight and needs none.
class Construction {
public:
    Construction(PatchMesh& mesh, const APatchParams& params, Context& context)
        : mesh_(mesh),
          params_(params),
          context_(context) {}

    Hull hull;  ///< refers to the mesh
    Weights weights;
    Repairs repairs;
    std::vector<u32> crossing;  ///< triangles whose parts of the surface intersect other parts; ascending

    void run() {
        do {
            context_.check_cancelled();
            replace_opposing(mesh_, repairs);
            hull = make_hull(mesh_, params_.apex_factor, params_.split, context_);
        } while (repair_hull() || repair_creases() || loosen_rest());
    }

private:
    /// Repairs triangles that are too near to the next sheet, and tetrahedra inside out beside smooth edges. Returns
    /// whether the mesh has changed.
    bool repair_hull() {
        std::vector<u32> smooth;
        for (const u32 e : hull.faults.inverted)
            if (!hull.edges[e].is_sharp) smooth.push_back(e);
        const std::vector<u32> triangles = triangles_at(hull, smooth);
        if (is_loosening_) return false;
        if (triangles.empty()) before_.reset();
        if (triangles.empty() || is_done_) return false;
        if (!is_turned_) {
            turn_normals(mesh_, triangles, repairs);
            is_turned_ = true;
        } else if (rounds_ < most_bisections && (!before_ || triangles.size() <= 2 * faults_before_)) {
            if (!before_) {
                before_ = mesh_;
                repairs_before_ = repairs;
                faults_before_ = triangles.size();
            }
            repairs.bisected += bisect(mesh_, triangles);
            ++rounds_;
        } else {
            is_done_ = true;
            if (!before_ || 2 * triangles.size() <= faults_before_) return false;
            mesh_ = std::move(*before_);  // bisection did not help
            repairs = repairs_before_;
        }
        return true;
    }

    /// Computes the weights of the hull. Repairs sharp edges whose creases leave the tetrahedra beside them. Returns
    /// whether the mesh has changed.
    bool repair_creases() {
        weights = make_weights(hull, params_.curvature, context_);
        doubtful_ = doubtful_edges(weights.patches, context_);
        if (is_loosening_) return false;
        std::vector<Edge> creases;
        for (const auto& edges : {doubtful_, hull.faults.inverted})
            for (const u32 e : edges)
                if (hull.edges[e].is_sharp && !hull.edges[e].is_straight)
                    creases.push_back(make_edge(hull.edges[e].a, hull.edges[e].b));
        if (bisect_creases(creases)) return true;
        if (!creases.empty() && !is_aligned_) {
            is_aligned_ = true;
            align_normals(mesh_, creases, repairs);
            return true;
        }
        return smooth_edges(mesh_, creases, repairs) > 0;
    }

    /// Bisects the edges of these creases, because the crease of a shorter edge deviates less from it. Undoes all
    /// bisections unless they repair at least half of the creases. Returns whether the mesh has changed.
    bool bisect_creases(std::span<const Edge> creases) {
        if (is_aligned_ || are_creases_bisected_) return false;
        if (crease_rounds_ == 0) {
            if (creases.empty()) return false;
            before_creases_ = mesh_;
            repairs_before_creases_ = repairs;
            creases_before_ = creases.size();
        } else if (creases.empty() || crease_rounds_ == most_crease_rounds) {
            are_creases_bisected_ = true;
            if (2 * creases.size() <= creases_before_) return false;
            mesh_ = std::move(*before_creases_);
            repairs = repairs_before_creases_;
            return true;
        }
        ++crease_rounds_;
        repairs.bisected += bisect_edges(mesh_, creases, Middle::of_curve);
        level_normals(mesh_);
        return true;
    }

    /// Gives the vertices at the remaining defects tips, or makes the surface follow the mesh there. Returns whether
    /// the mesh has changed.
    bool loosen_rest() {
        is_loosening_ = true;
        std::vector<Edge> edges, half_pointed;
        for (const auto& numbers : {doubtful_, hull.faults.inverted})
            for (const u32 e : numbers) {
                const HullEdge& edge = hull.edges[e];
                if (edge.is_straight) continue;
                const bool is_half_pointed = edge.is_sharp && mesh_.is_pointed(edge.a) != mesh_.is_pointed(edge.b);
                (is_half_pointed ? half_pointed : edges).push_back(make_edge(edge.a, edge.b));
            }
        if (loosen(mesh_, edges, hull.faults.thin, repairs)) return true;
        // A crease that begins at a tip becomes straight up to the middle of its edge. The other end of the edge then
        // needs no tip.
        if (!half_pointed.empty()) {
            repairs.bisected += bisect_edges(mesh_, half_pointed, Middle::of_segment);
            return true;
        }
        open_doubtful();
        if (repairs.pointed == 0) return false;
        crossing = crossing_triangles(weights.patches, context_);
        return loosen(mesh_, {}, crossing, repairs);
    }

    void open_doubtful() {
        while (!doubtful_.empty()) {
            for (const u32 e : doubtful_) hull.edges[e].is_filled = {false, false};
            weights = make_weights(hull, params_.curvature, context_);
            doubtful_ = doubtful_edges(weights.patches, context_);
        }
    }

    PatchMesh& mesh_;
    const APatchParams& params_;
    Context& context_;
    bool is_turned_ = false, is_aligned_ = false, is_done_ = false, is_loosening_ = false;
    std::vector<u32> doubtful_;  ///< see doubtful_edges()
    std::size_t rounds_ = 0, faults_before_ = 0;
    std::optional<PatchMesh> before_;  ///< the mesh before the first bisection
    Repairs repairs_before_;
    bool are_creases_bisected_ = false;
    std::size_t crease_rounds_ = 0, creases_before_ = 0;
    std::optional<PatchMesh> before_creases_;
    Repairs repairs_before_creases_;
};

/// Undoes changes of a fit where they made parts of the surface intersect, or gave weights a wrong sign. `crossing` are
/// the triangles whose parts intersected before the fit.
class Uncrossing {
public:
    Uncrossing(Hull& hull, const Weights& before, std::span<const u32> crossing, Curvature curvature, Context& context)
        : hull_(hull),
          crossing_before_(crossing),
          curvature_(curvature),
          context_(context),
          edges_before_(hull.edges),
          is_taken_back_(hull.faces.size(), false) {
        for (std::size_t row = 0; row < before.patches.tets.size(); ++row)
            wrong_before_.push_back(wrong_signs(before.patches, row));
    }

    void run(Weights& weights) {
        for (;;) {
            context_.check_cancelled();
            const std::vector<u32> faulty = faulty_triangles(weights.patches);
            if (faulty.empty()) return;
            const std::vector<bool> before = is_taken_back_;
            for (const u32 f : faulty) is_taken_back_[f] = true;
            if (is_taken_back_ == before) widen();
            for (std::size_t f = 0; f < hull_.faces.size(); ++f)
                for (const u32 e : hull_.faces[f].edges)
                    if (is_taken_back_[f]) hull_.edges[e].slopes = edges_before_[e].slopes;
            if (is_taken_back_ == before) return;
            weights = make_weights(hull_, curvature_, context_);
        }
    }

private:
    std::vector<u32> faulty_triangles(const PatchComplex& patches) const {
        std::vector<u32> faulty;
        for (std::size_t row = 0; row < patches.tets.size(); ++row)
            if (wrong_signs(patches, row) > wrong_before_[row]) faulty.push_back(patches.triangles[row]);
        for (const u32 e : doubtful_edges(patches, context_))
            faulty.insert(faulty.end(), {hull_.edges[e].first, hull_.edges[e].second});
        if (faulty.empty())
            std::ranges::set_difference(crossing_triangles(patches, context_), crossing_before_,
                                        std::back_inserter(faulty));
        return faulty;
    }

    /// Adds the neighbours of the triangles that are taken back.
    void widen() {
        const std::vector<bool> before = is_taken_back_;
        for (const HullEdge& edge : hull_.edges)
            if (edge.second != HullEdge::none && before[edge.first] != before[edge.second])
                is_taken_back_[edge.first] = is_taken_back_[edge.second] = true;
    }

    Hull& hull_;
    std::span<const u32> crossing_before_;
    Curvature curvature_;
    Context& context_;
    std::vector<HullEdge> edges_before_;
    std::vector<bool> is_taken_back_;
    std::vector<std::size_t> wrong_before_;
};

/// Fits the slopes of the construction's hull, and measures the distances of the points. Returns the new weights. Pre:
/// the construction's weights are those of its hull, without violations at creases.
Weights fit_and_measure(Construction& construction, const PointCloud* points, const APatchParams& params,
                        APatchResult& result, Context& context) {
    Hull& hull = construction.hull;
    Weights weights = std::move(construction.weights);
    const std::span<const Vec3> positions = points ? points->positions.span() : std::span<const Vec3>();
    const LocatedPoints located = locate(weights.patches, positions, context);
    result.left_out = located.left_out;
    result.unfairness_before = unfairness(hull, params.curvature);
    const auto violating_edges = [&](const PatchComplex& patches) { return doubtful_edges(patches, context); };
    std::optional<Uncrossing> uncrossing;
    if (result.repairs.pointed > 0) uncrossing.emplace(hull, weights, construction.crossing, params.curvature, context);
    FitResult fitted = fit(hull, std::move(weights), located, params.curvature,
                           {params.fit, params.fairing, params.regularisation}, violating_edges, context);
    weights = std::move(fitted.weights);
    if (uncrossing && (params.fairing > 0 || (params.fit && !located.points.empty()))) uncrossing->run(weights);
    result.regularisation = fitted.regularisation;
    result.unfairness_after = unfairness(hull, params.curvature);
    context.progress(0.8);
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

void warn_about(const APatchResult& result, std::span<const u32> crossing, const TriangleMesh& mesh,
                const PointCloud* points, const MeshTopology& counts, const APatchParams& params, Context& context) {
    if (counts.boundary_edges > 0)
        context.warn(fmt::format("the mesh is open: the surface ends at {}",
                                 count_text(counts.boundary_edges, "boundary edge", "boundary edges")));
    const Repairs& repairs = result.repairs;
    if (repairs.replaced > 0)
        context.warn(
            fmt::format("{} replaced because of an opposing triangle, tetrahedra inside out, or a crease that leaves "
                        "its edge",
                        count_text(repairs.replaced, "normal is", "normals are")));
    if (repairs.bisected > 0)
        context.warn(
            fmt::format("{} bisected, because tetrahedra were inside out or too large there, or a crease left its edge",
                        count_text(repairs.bisected, "edge is", "edges are")));
    if (repairs.creased > 0)
        context.warn(fmt::format("{} sharp, because the mesh is folded there",
                                 count_text(repairs.creased, "edge becomes", "edges become")));
    if (repairs.smoothed > 0)
        context.warn(fmt::format("{} smooth, because no crease fits there",
                                 count_text(repairs.smoothed, "blunt sharp edge becomes", "blunt sharp edges become")));
    if (repairs.pointed > 0) {
        const std::string text = fmt::format(
            "no smooth surface fits at {} of {} vertices: the surface has a tip at each of them, and follows the mesh "
            "at {}",
            repairs.pointed, counts.vertices + repairs.bisected, count_text(repairs.straightened, "edge", "edges"));
        if (static_cast<double>(repairs.pointed) >
            most_loosened * static_cast<double>(counts.vertices + repairs.bisected))
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
    count("refined", result.repairs.bisected);
    count("split-faces", result.divided);
    count("raised", result.raised);
    count("creased-edges", result.repairs.creased);
    count("smoothed-edges", result.repairs.smoothed);
    count("pointed-vertices", result.repairs.pointed);
    count("straight-edges", result.repairs.straightened);
    if (result.fit) {
        context.metric("fit-rms", result.fit->rms, Unit::length);
        context.metric("fit-p95", result.fit->p95, Unit::length);
        context.metric("fit-max", result.fit->max, Unit::length);
    }
    count("left-out", result.left_out);
    context.metric("crease-max", result.crease_max, Unit::length);
    if (result.regularisation) context.metric("regularisation", *result.regularisation, Unit::number);
    context.metric("fairness-before", result.unfairness_before, Unit::number);
    context.metric("fairness-after", result.unfairness_after, Unit::number);
}

}  // namespace

APatchResult a_patch(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params, Context& context) {
    if (mesh.triangles.empty())
        throw Error("needs a mesh with triangles; it has {} vertices and no triangles", mesh.positions.size());
    const MeshTopology counts = require_usable(mesh, params);
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

    Construction construction(work, params, context);
    if (points && points->size() > 0 && params.fit && params.normals == APatchParams::Normals::automatic) {
        replace_opposing(work, construction.repairs);
        fit_normals(work, points->positions.span(), context);
    }
    level_normals(work);
    construction.run();
    const Hull& hull = construction.hull;
    result.repairs = construction.repairs;
    assert(hull.faults.thin.empty() && std::ranges::none_of(hull.edges, &HullEdge::is_open));
    context.progress(0.5);
    Weights weights = fit_and_measure(construction, points, params, result, context);
    result.raised = weights.raised;
    result.divided = static_cast<std::size_t>(std::ranges::count(hull.faces, true, &HullFace::is_divided));
    result.patches = std::move(weights.patches);
    result.patches.frame = mesh.frame;
    context.progress(0.9);
    result.inverted = inverted_tets(result.patches);
    result.sign_violations = sign_violations(result.patches, context);
    result.c1_jump = c1_jump(result.patches, context);
    result.pointed = std::move(work.pointed);
    result.mesh = std::move(work.mesh);
    Array<double> components;
    for (const auto& of_triangle : work.normals)
        for (const Vec3& n : of_triangle) components.insert(components.end(), n.data(), n.data() + 3);
    result.mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(components))));
    result.crease_max = largest_bulge(result.patches, result.mesh, context);
    warn_about(result, construction.crossing, mesh, points, counts, params, context);
    report(result, context);
    return result;
}

}  // namespace scanmill
