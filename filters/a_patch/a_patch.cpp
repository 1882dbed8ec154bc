// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/a_patch.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "a_patch/fit.hpp"
#include "a_patch/normals.hpp"
#include "a_patch/refinement.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/a_patch.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"
#include "scanmill/geometry/mesh/topology.hpp"

namespace scanmill {

namespace {

using namespace a_patches;

constexpr double thinnest = 1e-9;  // height over longest edge of a triangle with area
constexpr std::size_t most_bisections = 7;  // rounds
constexpr std::size_t chunk = 1024;
constexpr double least_factor = 1.05, most_factor = 3;
constexpr double least_regularisation = 1e-6;

std::string place(const TriangleMesh& mesh, u32 vertex) {
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
        throw Error("{} of {} triangles {} no area, the first is triangle {} at {}", count, mesh.triangles.size(),
                    by_count(count, "has", "have"), first, place(mesh, mesh.triangles[first][0]))
            .hint("'decimate' makes well-shaped triangles");
}

std::vector<bool> used_vertices(const TriangleMesh& mesh) {
    std::vector<bool> is_used(mesh.positions.size(), false);
    for (const Triangle& t : mesh.triangles)
        for (const u32 v : t) is_used[v] = true;
    return is_used;
}

void require_distinct_vertices(const TriangleMesh& mesh, const std::vector<bool>& is_used) {
    std::vector<u32> order;
    for (u32 v = 0; v < is_used.size(); ++v)
        if (is_used[v]) order.push_back(v);
    const auto key = [&](u32 v) {
        const Vec3& p = mesh.positions[v];
        return std::tuple(p.x(), p.y(), p.z());
    };
    std::ranges::stable_sort(order, [&](u32 one, u32 other) { return key(one) < key(other); });
    std::size_t count = 0, first = 0;
    for (std::size_t i = 1; i < order.size(); ++i)
        if (key(order[i]) == key(order[i - 1]) && count++ == 0) first = order[i];
    if (count > 0)
        throw Error("{} of {} vertices {} at the position of another one, the first is vertex {} at {}", count,
                    order.size(), by_count(count, "is", "are"), first, place(mesh, static_cast<u32>(first)))
            .hint("merge equal vertices, so that triangles share them");
}

MeshTopology require_usable(const TriangleMesh& mesh, const std::vector<bool>& is_used, const APatchParams& params) {
    if (!(params.apex_factor >= least_factor && params.apex_factor <= most_factor))
        throw Error("apex-factor must be from {} to {}; it is {}", least_factor, most_factor, params.apex_factor);
    if (!(params.fairing >= 0 && std::isfinite(params.fairing)))
        throw Error("fairing must be at least 0; it is {}", params.fairing);
    if (!(params.regularisation >= least_regularisation && params.regularisation <= 1))
        throw Error("regularisation must be from {} to 1; it is {}", least_regularisation, params.regularisation);
    require_finite(mesh.positions.span(), "vertices");
    half_edges::opposites(mesh);
    require_areas(mesh);
    require_distinct_vertices(mesh, is_used);
    const MeshTopology counts = topology(mesh);
    if (counts.nonmanifold_vertices > 0)
        throw Error("at {} of {} vertices the triangles do not form one fan", counts.nonmanifold_vertices,
                    counts.vertices)
            .hint("'alpha-solid: {alpha: auto}' and 'sculpt' give manifolds");
    return counts;
}

// Normals.

std::vector<Vec3> triangle_normals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals;
    for (const Triangle& t : mesh.triangles)
        normals.push_back((mesh.positions[t[1]] - mesh.positions[t[0]])
                              .cross(mesh.positions[t[2]] - mesh.positions[t[0]])
                              .normalized());
    return normals;
}

bool opposes(const Vec3& normal, std::span<const Vec3> around) {
    return std::ranges::any_of(around, [&](const Vec3& n) { return !(n.dot(normal) >= least_cosine); });
}

std::vector<Vec3> normals_at(std::span<const u32> corners, std::span<const Vec3> of_triangles) {
    std::vector<Vec3> around;
    for (const u32 corner : corners) around.push_back(of_triangles[corner / 3]);
    return around;
}

void set_normal(PatchMesh& mesh, std::span<const u32> corners, const Vec3& normal) {
    for (const u32 corner : corners) mesh.normals[corner / 3][corner % 3] = normal;
}

/// Adds to the sharp edges. Returns how many are new.
std::size_t add_sharp(TriangleMesh& mesh, std::vector<Edge> edges) {
    const std::size_t before = mesh.sharp_edges.size();
    edges.insert(edges.end(), mesh.sharp_edges.begin(), mesh.sharp_edges.end());
    std::ranges::sort(edges);
    edges.erase(std::ranges::unique(edges).begin(), edges.end());
    mesh.sharp_edges = Array<Edge>(edges.begin(), edges.end());
    return mesh.sharp_edges.size() - before;
}

/// The edge within a sector between the triangles whose normals differ most; ties: its vertices.
std::optional<Edge> most_acute_edge(const TriangleMesh& mesh, const Sectors& sectors, std::span<const u32> corners,
                                    const Array<u32>& opposites, std::span<const Vec3> of_triangles) {
    std::optional<std::pair<double, Edge>> best;
    for (const u32 half : corners) {
        const u32 other = opposites[half];
        if (other == half_edges::boundary) continue;
        const u32 beyond = half_edges::after(other);
        if (sectors.of_corner[beyond / 3][beyond % 3] != sectors.of_corner[half / 3][half % 3]) continue;
        const Edge edge = make_edge(half_edges::start(mesh, half), half_edges::end(mesh, half));
        if (std::ranges::binary_search(mesh.sharp_edges, edge)) continue;
        const std::pair found(of_triangles[half / 3].dot(of_triangles[other / 3]), edge);
        if (!best || found < *best) best = found;
    }
    return best ? std::optional(best->second) : std::nullopt;
}

/// Replaces normals that oppose a triangle. Where no direction suits all triangles of a sector, its most acute edges
/// become sharp, until one does.
void replace_opposing(PatchMesh& mesh, APatchResult& result) {
    const std::vector<Vec3> of_triangles = triangle_normals(mesh.mesh);
    const Array<u32> opposites = half_edges::opposites(mesh.mesh);
    for (;;) {
        const Sectors sectors = sectors_of(mesh.mesh);
        const std::vector<std::vector<u32>> corners = corners_of(sectors);
        std::vector<Vec3> of_mesh;
        std::vector<Edge> sharp;
        for (std::size_t s = 0; s < sectors.size(); ++s) {
            const std::vector<Vec3> around = normals_at(corners[s], of_triangles);
            const Vec3 normal = mesh.normals[corners[s][0] / 3][corners[s][0] % 3];
            const bool is_singular = normal == Vec3::Zero();
            if (!is_singular && !opposes(normal, around)) continue;
            if (of_mesh.empty()) of_mesh = mesh_normals(mesh.mesh, sectors);
            const Vec3 better = opposes(of_mesh[s], around) ? most_normal(around) : of_mesh[s];
            if (opposes(better, around)) {
                if (const auto edge = most_acute_edge(mesh.mesh, sectors, corners[s], opposites, of_triangles))
                    sharp.push_back(*edge);
            } else if (!is_singular) {
                ++result.replaced_normals;
                set_normal(mesh, corners[s], better);
            }
        }
        if (sharp.empty()) return;
        result.creased += add_sharp(mesh.mesh, std::move(sharp));
    }
}

/// Gives the corners of the triangles the direction nearest to all their triangles' normals. Returns how many sectors
/// there are.
std::size_t turn_normals(PatchMesh& mesh, std::span<const u32> triangles) {
    const std::vector<Vec3> of_triangles = triangle_normals(mesh.mesh);
    const Sectors sectors = sectors_of(mesh.mesh);
    const std::vector<std::vector<u32>> corners = corners_of(sectors);
    std::vector<u32> turned;
    for (const u32 f : triangles) turned.insert(turned.end(), sectors.of_corner[f].begin(), sectors.of_corner[f].end());
    std::ranges::sort(turned);
    turned.erase(std::ranges::unique(turned).begin(), turned.end());
    for (const u32 s : turned) set_normal(mesh, corners[s], most_normal(normals_at(corners[s], of_triangles)));
    return turned.size();
}

/// Makes the surface equal to these triangles.
void flatten(PatchMesh& mesh, std::span<const u32> triangles, APatchResult& result) {
    const std::vector<Vec3> of_triangles = triangle_normals(mesh.mesh);
    const Array<u32> opposites = half_edges::opposites(mesh.mesh);
    std::vector<Edge> sharp;
    for (const u32 f : triangles) {
        if (mesh.is_flat[f]) continue;
        mesh.is_flat[f] = true;
        ++result.flat;
        mesh.normals[f].fill(of_triangles[f]);
        for (u32 half = 3 * f; half < 3 * f + 3; ++half)
            if (opposites[half] != half_edges::boundary)
                sharp.push_back(make_edge(half_edges::start(mesh.mesh, half), half_edges::end(mesh.mesh, half)));
    }
    result.creased += add_sharp(mesh.mesh, std::move(sharp));
}

/// Throws if most given normals point inwards.
void require_outward(std::span<const Vec3> normals, std::span<const Vec3> of_mesh) {
    std::size_t inward = 0, count = 0;
    for (std::size_t v = 0; v < normals.size(); ++v) {
        count += normals[v] != Vec3::Zero();
        inward += normals[v].dot(of_mesh[v]) < 0;
    }
    if (2 * inward > count)
        throw Error("{} of {} normals point against the triangles at their vertices", inward, count)
            .hint("the mesh or its normals are inside out; 'normals: mesh' takes those of the triangles");
}

CornerNormals corner_normals(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params,
                             Context& context) {
    using Normals = APatchParams::Normals;
    Normals source = params.normals;
    if (source == Normals::automatic)
        source = mesh.face_columns.find("corner-normals") ? Normals::given : points ? Normals::points : Normals::mesh;
    if (source == Normals::points && !points)
        throw Error("normals is points, but there are no points")
            .hint("wire the scan: 'in: {points: scan}'; 'normals: mesh' needs none");
    const Sectors sectors = sectors_of(mesh);
    std::vector<Vec3> normals = mesh_normals(mesh, sectors);
    if (source == Normals::points) {
        normals = point_normals(mesh, sectors, points->positions.span(), normals, context);
    } else if (source == Normals::given) {
        GivenNormals given = given_normals(mesh, sectors);
        require_outward(given.normals, normals);
        if (given.several > 0)
            context.warn(fmt::format("{} no sharp edge separates get their mean",
                                     count_text(given.several, "group of different corner normals that",
                                                "groups of different corner normals that")));
        normals = std::move(given.normals);
    }
    return at_corners(sectors, normals);
}

// The surface.

/// The sharp edges between two triangles.
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

/// Those with a fault of their own, and those beside the edges.
std::vector<u32> triangles_at(const Hull& hull, std::span<const u32> edges) {
    std::vector<u32> triangles = hull.faults.opposed;
    triangles.insert(triangles.end(), hull.faults.thin.begin(), hull.faults.thin.end());
    for (const u32 e : edges) {
        triangles.push_back(hull.edges[e].first);
        triangles.push_back(hull.edges[e].second);
    }
    std::ranges::sort(triangles);
    triangles.erase(std::ranges::unique(triangles).begin(), triangles.end());
    return triangles;
}

std::size_t inverted_tets(const PatchComplex& patches) {
    std::size_t inverted = 0;
    for (std::size_t row = 0; row < patches.tets.size(); ++row) {
        const auto& t = patches.tets[row];
        const Vec3& o = patches.positions[t[0]];
        const double volume =
            (patches.positions[t[1]] - o).cross(patches.positions[t[2]] - o).dot(patches.positions[t[3]] - o);
        // From the base point corners i, j and the apex turn the other way than from an edge point, and inside the
        // other way than outside.
        const bool is_over_face =
            patches.kinds[row] == PatchKind::face || patches.kinds[row] == PatchKind::continuation;
        const bool is_positive = is_over_face == (patches.sides[row] == 1);
        inverted += !((is_positive ? volume : -volume) > 0);
    }
    return inverted;
}

/// Of tetrahedra with one function, and of the functions of triangles.
std::size_t sign_violations(const PatchComplex& patches) {
    std::size_t violations = 0;
    for (std::size_t row = 0; row < patches.tets.size(); ++row) violations += wrong_signs(patches, row);
    return violations;
}

/// Tetrahedra with two functions, sampled: whether every line from the mesh to an apex, or to the line between two,
/// meets the surface once, and whether the own function of a triangle alone sets the surface where it meets the
/// triangle's other thirds.
class CreaseCheck {
public:
    explicit CreaseCheck(const PatchComplex& patches) : patches_(patches) {}

    /// Edges with a violation, ascending, and how many there are in all.
    std::vector<u32> edges;
    std::size_t violations = 0;

    void run() {
        for (u32 row = 0; row < patches_.tets.size(); ++row) {
            const std::size_t before = violations;
            if (patches_.kinds[row] == PatchKind::continuation) check_continuation(row);
            if (patches_.kinds[row] == PatchKind::sharp && patches_.partners[row] > row) check_gap(row);
            if (violations > before) edges.push_back(patches_.edges[row]);
        }
        std::ranges::sort(edges);
        edges.erase(std::ranges::unique(edges).begin(), edges.end());
    }

private:
    static constexpr int steps = 8, grid = 5;
    static constexpr double rounding = 1e-12;  // of the largest weight

    double sign_of_side(u32 row) const { return patches_.sides[row] == 1 ? 1 : -1; }

    double largest_weight(u32 row) const {
        double largest = 0;
        for (const u32 each : {row, patches_.partners[row]})
            for (const double weight : patches_.weights[each]) largest = std::max(largest, std::abs(weight));
        return largest;
    }

    double value(u32 row, const Barycentric& at) const {
        const u32 partner = patches_.partners[row];
        const Barycentric there = patches_.tets[partner] == patches_.tets[row] ? at : Barycentric(at.reverse());
        const double one = patch_value(patches_.weights[row], at),
                     other = patch_value(patches_.weights[partner], there);
        return patches_.combine[row] == Combine::max ? std::max(one, other) : std::min(one, other);
    }

    /// Whether the function, seen outwards, rises once from below 0 to above 0 on the way; where it begins above, the
    /// tetrahedron on the other side counts.
    bool is_single(u32 row, const Barycentric& from, const Barycentric& to) const {
        const double sign = sign_of_side(row), least = rounding * largest_weight(row);
        bool is_above = false;
        for (int step = 0; step <= steps; ++step) {
            const double t = static_cast<double>(step) / steps, found = sign * value(row, (1 - t) * from + t * to);
            if (is_above && found < -least) return false;
            is_above = is_above || found > least;
        }
        return is_above;
    }

    void check_gap(u32 row) {
        for (int s = 1; s < grid; ++s)
            for (int u = 0; u <= grid; ++u) {
                const double share = static_cast<double>(s) / grid, across = static_cast<double>(u) / grid;
                violations += !is_single(row, {0, 1 - share, share, 0}, {across, 0, 0, 1 - across});
            }
    }

    void check_continuation(u32 row) {
        const Barycentric apex(0, 0, 0, 1);
        for (int i = 0; i <= grid; ++i)
            for (int j = 0; i + j <= grid; ++j) {
                if (i == grid || j == grid) continue;
                violations += !is_single(row, Barycentric(grid - i - j, i, j, 0) / grid, apex);
            }
        const u32 own = patches_.partners[row];
        const double sign = patches_.combine[row] == Combine::max ? 1 : -1, least = rounding * largest_weight(row);
        for (int corner = 1; corner <= 2; ++corner)
            for (const double share : {0.0, 0.25, 0.5, 0.75, 0.95}) {
                Barycentric from(1 - share, 0, 0, 0);
                from[corner] = share;
                if (sign_of_side(row) * patch_value(patches_.weights[own], from) > 0) continue;
                const auto hit = patch_hit(patches_.weights[own], from, apex);
                violations +=
                    !hit || sign * patch_value(patches_.weights[row], (1 - *hit) * from + *hit * apex) > least;
            }
    }

    const PatchComplex& patches_;
};

struct SharedFace {
    std::array<u32, 3> vertices;  // ascending
    u32 tet;
    auto operator<=>(const SharedFace&) const = default;
};

double c1_jump(const PatchComplex& patches, Execution& execution) {
    static const std::array<Vec3, 3> places{Vec3::Constant(1. / 3), {0.6, 0.3, 0.1}, {0.1, 0.2, 0.7}};
    std::vector<SharedFace> faces;
    faces.reserve(4 * patches.tets.size());
    for (u32 row = 0; row < patches.tets.size(); ++row)
        for (std::size_t without = 0; without < 4 && patches.kinds[row] != PatchKind::continuation; ++without) {
            SharedFace face{{}, row};
            for (std::size_t i = 0, n = 0; i < 4; ++i)
                if (i != without) face.vertices[n++] = patches.tets[row][i];
            std::ranges::sort(face.vertices);
            faces.push_back(face);
        }
    std::ranges::sort(faces);
    execution.check_cancelled();
    std::vector<double> largest(faces.size() / chunk + 1, 0.0);
    for_each_chunk(execution.threads(), faces.size(), chunk, [&](std::size_t begin, std::size_t end) {
        double& jump = largest[begin / chunk];
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t j = i; j > 0 && faces[i].vertices == faces[j - 1].vertices; --j) {
                const u32 here = faces[j - 1].tet, there = faces[i].tet;
                const bool is_sharp =
                    patches.kinds[here] == PatchKind::sharp || patches.kinds[there] == PatchKind::sharp;
                if (is_sharp && patches.triangles[here] != patches.triangles[there]) continue;
                const PatchCell one(patches, here), other(patches, there);
                for (const Vec3& share : places) {
                    Vec3 point = Vec3::Zero();
                    for (std::size_t v = 0; v < 3; ++v)
                        point += share[static_cast<Eigen::Index>(v)] * patches.positions[faces[i].vertices[v]];
                    const Vec3 a = one.gradient(point), b = other.gradient(point);
                    jump = std::max(jump, (a - b).norm() / std::max(a.norm(), b.norm()));
                }
            }
    });
    return std::ranges::max(largest);
}

/// Fits the slopes, and measures. `weights` are those of the hull as it is, without violations at creases.
Weights fit_and_measure(Hull& hull, Weights weights, const PointCloud* points, const APatchParams& params,
                        APatchResult& result, Context& context) {
    const std::span<const Vec3> positions = points ? points->positions.span() : std::span<const Vec3>();
    const LocatedPoints located = locate(weights.patches, positions, context);
    result.left_out = located.left_out;
    result.unfairness_before = unfairness(hull, params.curvature);
    const auto violating_edges = [](const PatchComplex& patches) {
        CreaseCheck check(patches);
        check.run();
        return check.edges;
    };
    FitResult fitted = fit(hull, std::move(weights), located, params.curvature,
                           {params.fit, params.fairing, params.regularisation}, violating_edges, context);
    weights = std::move(fitted.weights);
    result.regularisation = fitted.regularisation;
    result.unfairness_after = unfairness(hull, params.curvature);
    context.progress(0.8);
    if (located.points.empty()) return weights;
    std::vector<double> found = distances(hull, weights.patches, positions, located, context);
    double squares = 0;
    for (const double d : found) squares += d * d;
    std::ranges::sort(found);
    const auto count = static_cast<double>(found.size());
    result.fit = {std::sqrt(squares / count), found[static_cast<std::size_t>(std::ceil(0.95 * count)) - 1],
                  found.back()};
    return weights;
}

void warn_about(const APatchResult& result, const TriangleMesh& mesh, const PointCloud* points,
                const MeshTopology& counts, Context& context) {
    if (counts.boundary_edges > 0)
        context.warn(fmt::format("the mesh is open: the surface ends at {}",
                                 count_text(counts.boundary_edges, "boundary edge", "boundary edges")));
    if (result.replaced_normals > 0)
        context.warn(fmt::format("{} replaced, because tetrahedra are inside out with them, or a triangle opposes them",
                                 count_text(result.replaced_normals, "normal is", "normals are")));
    if (result.creased > 0)
        context.warn(fmt::format("no smooth surface follows the mesh's folds: {} sharp, and {}",
                                 count_text(result.creased, "edge becomes", "edges become"),
                                 count_text(result.flat, "triangle remains flat", "triangles remain flat")));
    if (result.bisected > 0)
        context.warn(fmt::format("{} bisected, because tetrahedra were inside out or too large there",
                                 count_text(result.bisected, "edge is", "edges are")));
    if (points && result.left_out == points->size())
        context.warn(points->size() == 0
                         ? "there are no points: the surface is not fitted"
                         : fmt::format("none of the {} is in a tetrahedron near the surface: it is not fitted",
                                       count_text(points->size(), "point", "points")));
    if (result.sign_violations > 0)
        context.doubt(fmt::format("{} the wrong sign: the surface may have several sheets there",
                                  count_text(result.sign_violations, "weight has", "weights have")));
    if (!counts.closed) return;
    double volume = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3& o = mesh.positions[mesh.triangles[0][0]];
        volume += (mesh.positions[t[0]] - o).dot((mesh.positions[t[1]] - o).cross(mesh.positions[t[2]] - o));
    }
    if (volume < 0) context.doubt("the mesh is inside out: inside and outside are exchanged");
}

void report(const APatchResult& result, Context& context) {
    const auto count = [&](std::string_view name, std::size_t number) {
        context.metric(name, static_cast<double>(number));
    };
    count("tetrahedra", result.patches.tets.size());
    count("inverted", result.inverted);
    context.metric("c1-jump", result.c1_jump, Unit::number);
    count("sign-violations", result.sign_violations);
    count("refined", result.bisected);
    count("split-faces", result.divided);
    count("raised", result.raised);
    count("creased-edges", result.creased);
    count("flat-triangles", result.flat);
    if (result.fit) {
        context.metric("fit-rms", result.fit->rms, Unit::length);
        context.metric("fit-p95", result.fit->p95, Unit::length);
        context.metric("fit-max", result.fit->max, Unit::length);
    }
    count("left-out", result.left_out);
    if (result.fit) context.metric("regularisation", result.regularisation, Unit::number);
    context.metric("fairness-before", result.unfairness_before, Unit::number);
    context.metric("fairness-after", result.unfairness_after, Unit::number);
}

}  // namespace

APatchResult a_patch(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params, Context& context) {
    if (mesh.triangles.empty())
        throw Error("needs a mesh with triangles; it has {} vertices and none", mesh.positions.size());
    const MeshTopology counts = require_usable(mesh, used_vertices(mesh), params);
    if (points) require_finite(points->positions.span());
    APatchResult result;
    PatchMesh work;
    work.mesh.frame = mesh.frame;
    work.mesh.positions = mesh.positions;
    work.mesh.triangles = mesh.triangles;
    work.mesh.sharp_edges = inner_edges(mesh);
    work.is_flat.resize(mesh.triangles.size(), false);
    TriangleMesh with_columns = work.mesh;
    with_columns.face_columns = mesh.face_columns;
    work.normals = corner_normals(with_columns, points, params, context);
    context.progress(0.2);

    Hull hull;
    Weights weights;
    for (std::size_t round = 0;; ++round) {
        context.check_cancelled();
        replace_opposing(work, result);
        hull = make_hull(work, params.apex_factor, params.split, context);
        std::vector<u32> triangles = triangles_at(hull, hull.faults.inverted);
        if (triangles.empty()) {
            weights = make_weights(hull, params.curvature, context);
            CreaseCheck check(weights.patches);
            check.run();
            if (check.edges.empty()) break;
            triangles = triangles_at(hull, check.edges);
        }
        if (round == 0) {
            result.replaced_normals += turn_normals(work, triangles);
        } else if (round <= most_bisections) {
            result.bisected += bisect(work, triangles);
        } else {
            const std::size_t before = result.flat;
            flatten(work, triangles, result);
            if (result.flat == before) throw Error("no surface fits at {}", place(work.mesh, triangles[0]));
        }
    }
    context.progress(0.5);
    weights = fit_and_measure(hull, std::move(weights), points, params, result, context);
    result.raised = weights.raised;
    result.divided = static_cast<std::size_t>(std::ranges::count(hull.faces, true, &HullFace::is_divided));
    result.patches = std::move(weights.patches);
    result.patches.frame = mesh.frame;
    context.progress(0.9);
    result.inverted = inverted_tets(result.patches);
    result.sign_violations = sign_violations(result.patches);
    result.c1_jump = c1_jump(result.patches, context);
    result.mesh = std::move(work.mesh);
    Array<double> components;
    for (const auto& of_triangle : work.normals)
        for (const Vec3& n : of_triangle) components.insert(components.end(), n.data(), n.data() + 3);
    result.mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(components))));
    warn_about(result, mesh, points, counts, context);
    report(result, context);
    return result;
}

}  // namespace scanmill
