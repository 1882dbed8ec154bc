// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/a_patch.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

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
constexpr std::size_t most_rounds = 8;
constexpr std::size_t most_listed = 5;
constexpr std::size_t chunk = 1024;
constexpr double least_factor = 1.05, most_factor = 3;

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
    if (params.fit) throw Error("fit is not possible yet").hint("leave it out: the surface interpolates the vertices");
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

/// The normals of the triangles at every vertex.
std::vector<std::vector<Vec3>> normals_around(const TriangleMesh& mesh) {
    std::vector<std::vector<Vec3>> around(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 n = (mesh.positions[t[1]] - mesh.positions[t[0]])
                           .cross(mesh.positions[t[2]] - mesh.positions[t[0]])
                           .normalized();
        for (const u32 v : t) around[v].push_back(n);
    }
    return around;
}

bool opposes(const Vec3& normal, std::span<const Vec3> around) {
    return std::ranges::any_of(around, [&](const Vec3& n) { return !(n.dot(normal) >= least_cosine); });
}

/// Replaces normals that oppose a triangle. Returns how many.
std::size_t replace_opposing(MeshWithNormals& mesh) {
    const std::vector<std::vector<Vec3>> around = normals_around(mesh.mesh);
    std::vector<Vec3> of_mesh;
    std::size_t replaced = 0;
    for (std::size_t v = 0; v < around.size(); ++v) {
        if (!opposes(mesh.normals[v], around[v])) continue;
        ++replaced;
        if (of_mesh.empty()) of_mesh = mesh_normals(mesh.mesh);
        mesh.normals[v] = opposes(of_mesh[v], around[v]) ? most_normal(around[v]) : of_mesh[v];
    }
    return replaced;
}

/// Gives the corners of the triangles the direction nearest to all their triangles' normals. Returns how many there
/// are.
std::size_t turn_normals(MeshWithNormals& mesh, std::span<const u32> triangles) {
    const std::vector<std::vector<Vec3>> around = normals_around(mesh.mesh);
    std::vector<u32> corners;
    for (const u32 f : triangles)
        corners.insert(corners.end(), mesh.mesh.triangles[f].begin(), mesh.mesh.triangles[f].end());
    std::ranges::sort(corners);
    corners.erase(std::ranges::unique(corners).begin(), corners.end());
    for (const u32 v : corners) mesh.normals[v] = most_normal(around[v]);
    return corners.size();
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

std::vector<Vec3> vertex_normals(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params,
                                 Context& context) {
    using Normals = APatchParams::Normals;
    Normals source = params.normals;
    if (source == Normals::automatic)
        source = mesh.face_columns.find("corner-normals") ? Normals::given : points ? Normals::points : Normals::mesh;
    if (source == Normals::points && !points)
        throw Error("normals is points, but there are no points")
            .hint("wire the scan: 'in: {points: scan}'; 'normals: mesh' needs none");
    std::vector<Vec3> of_mesh = mesh_normals(mesh);
    if (source == Normals::mesh) return of_mesh;
    if (source == Normals::points) {
        require_finite(points->positions.span());
        return point_normals(mesh, points->positions.span(), of_mesh, context);
    }
    const GivenNormals given = given_normals(mesh);
    require_outward(given.normals, of_mesh);
    if (given.several > 0)
        context.warn(fmt::format("sharp edges are smoothed: {} with several normals {} their mean",
                                 count_text(given.several, "vertex", "vertices"),
                                 by_count(given.several, "gets", "get")));
    return given.normals;
}

// The surface.

std::vector<u32> triangles_at(const Hull& hull) {
    std::vector<u32> triangles = hull.faults.opposed;
    triangles.insert(triangles.end(), hull.faults.thin.begin(), hull.faults.thin.end());
    for (const u32 e : hull.faults.inverted) {
        triangles.push_back(hull.edges[e].first);
        triangles.push_back(hull.edges[e].second);
    }
    std::ranges::sort(triangles);
    triangles.erase(std::ranges::unique(triangles).begin(), triangles.end());
    return triangles;
}

[[noreturn]] void throw_faults(const Hull& hull, const TriangleMesh& mesh) {
    const std::vector<u32> triangles = triangles_at(hull);
    std::string list;
    for (std::size_t i = 0; i < std::min(most_listed, triangles.size()); ++i)
        list += (i > 0 ? ", " : "") + place(mesh, mesh.triangles[triangles[i]][0]);
    if (triangles.size() > most_listed) list += " …";
    if (!hull.faults.opposed.empty())
        throw Error(
            "the mesh is folded: {} a corner where no direction is within 84 degrees of all triangles' normals: at {}",
            count_text(triangles.size(), "triangle has", "triangles have"), list)
            .hint(
                "a larger alpha of 'alpha-solid' closes narrow gaps; 'decimate' with a smaller max-error leaves "
                "fewer folds");
    throw Error(
        "no smooth surface fits at {} after {} rounds of bisection: {} too near to the next sheet, and beside {} a "
        "tetrahedron is inside out: at {}",
        count_text(triangles.size(), "triangle", "triangles"), most_rounds - 1,
        count_text(hull.faults.thin.size(), "triangle is", "triangles are"),
        count_text(hull.faults.inverted.size(), "edge", "edges"), list)
        .hint("a mesh with more triangles follows the surface better: 'decimate' with a smaller max-error");
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
        const bool is_positive = (patches.kinds[row] == PatchKind::face) == (patches.sides[row] == 1);
        inverted += !((is_positive ? volume : -volume) > 0);
    }
    return inverted;
}

std::size_t sign_violations(const PatchComplex& patches) {
    std::size_t violations = 0;
    for (std::size_t row = 0; row < patches.tets.size(); ++row) {
        std::size_t number = 0;
        for (int i = 3; i >= 0; --i)
            for (int j = 3 - i; j >= 0; --j)
                for (int k = 3 - i - j; k >= 0; --k, ++number) {
                    const int layer = 3 - i - j - k + (patches.kinds[row] == PatchKind::edge ? i : 0);
                    const double weight = patches.weights[row][number];
                    if (layer > 0 && (patches.sides[row] == 1 ? weight < 0 : weight > 0)) ++violations;
                }
    }
    return violations;
}

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
        for (std::size_t without = 0; without < 4; ++without) {
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
        for (std::size_t i = std::max<std::size_t>(1, begin); i < end; ++i) {
            if (faces[i].vertices != faces[i - 1].vertices) continue;
            const PatchCell one(patches, faces[i - 1].tet), other(patches, faces[i].tet);
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

void warn_about(const APatchResult& result, const TriangleMesh& mesh, const MeshTopology& counts, Context& context) {
    if (counts.boundary_edges > 0)
        context.warn(fmt::format("the mesh is open: the surface ends at {}",
                                 count_text(counts.boundary_edges, "boundary edge", "boundary edges")));
    if (!mesh.sharp_edges.empty())
        context.warn(fmt::format("the mesh's {} smoothed",
                                 count_text(mesh.sharp_edges.size(), "sharp edge is", "sharp edges are")));
    if (result.replaced_normals > 0)
        context.warn(fmt::format("{} replaced, because tetrahedra are inside out with them, or a triangle opposes them",
                                 count_text(result.replaced_normals, "normal is", "normals are")));
    if (result.bisected > 0)
        context.warn(fmt::format("{} bisected, because tetrahedra were inside out or too large there",
                                 count_text(result.bisected, "edge is", "edges are")));
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
}

}  // namespace

APatchResult a_patch(const TriangleMesh& mesh, const PointCloud* points, const APatchParams& params, Context& context) {
    if (mesh.triangles.empty())
        throw Error("needs a mesh with triangles; it has {} vertices and none", mesh.positions.size());
    const MeshTopology counts = require_usable(mesh, used_vertices(mesh), params);
    APatchResult result;
    MeshWithNormals refined;
    refined.mesh.frame = mesh.frame;
    refined.mesh.positions = mesh.positions;
    refined.mesh.triangles = mesh.triangles;
    refined.normals = vertex_normals(mesh, points, params, context);
    context.progress(0.2);

    Hull hull;
    for (std::size_t round = 0;; ++round) {
        context.check_cancelled();
        result.replaced_normals += replace_opposing(refined);
        hull = make_hull(refined.mesh, refined.normals, params.apex_factor, params.split, context);
        if (hull.faults.empty()) break;
        if (!hull.faults.opposed.empty() || round == most_rounds) throw_faults(hull, refined.mesh);
        const std::vector<u32> triangles = triangles_at(hull);
        if (round == 0)
            result.replaced_normals += turn_normals(refined, triangles);
        else
            result.bisected += bisect(refined, triangles);
    }
    context.progress(0.5);
    Weights weights = make_weights(hull, params.curvature, context);
    result.raised = weights.raised;
    result.divided = static_cast<std::size_t>(std::ranges::count(hull.faces, true, &HullFace::is_divided));
    result.patches = std::move(weights.patches);
    result.patches.frame = mesh.frame;
    context.progress(0.7);
    result.inverted = inverted_tets(result.patches);
    result.sign_violations = sign_violations(result.patches);
    result.c1_jump = c1_jump(result.patches, context);
    result.mesh = std::move(refined.mesh);
    Array<double> components(3 * refined.normals.size());
    for (std::size_t v = 0; v < refined.normals.size(); ++v)
        for (std::size_t i = 0; i < 3; ++i) components[3 * v + i] = refined.normals[v][static_cast<Eigen::Index>(i)];
    result.mesh.vertex_columns.add(Column("normal", 3, Buffer<double>(std::move(components))));
    warn_about(result, mesh, counts, context);
    report(result, context);
    return result;
}

}  // namespace scanmill
