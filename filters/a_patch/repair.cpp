// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/repair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "a_patch/normals.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr double cosine_of_fold = 0.8660254037844386;  // of 30 degrees
// Sines of the deviation of a normal from perpendicular to a sharp edge: the largest one, and the largest as a share of
// the deviation of the normal beyond the edge.
constexpr double level_sine = 1e-3, level_share = 0.1;
constexpr double cosine_of_level = 0.9993908270190958;  // of 2 degrees
constexpr double least_length = 0.1;  // least length of a sum or product of unit vectors that gives a direction

void set_normal(PatchMesh& mesh, std::span<const u32> corners, const Vec3& normal) {
    for (const u32 corner : corners) mesh.normals[corner / 3][corner % 3] = normal;
}

/// Adds edges to the sharp edges. Returns the number of new ones.
std::size_t add_sharp(TriangleMesh& mesh, std::vector<Edge> edges) {
    const std::size_t before = mesh.sharp_edges.size();
    edges.insert(edges.end(), mesh.sharp_edges.begin(), mesh.sharp_edges.end());
    std::ranges::sort(edges);
    edges.erase(std::ranges::unique(edges).begin(), edges.end());
    mesh.sharp_edges = Array<Edge>(edges.begin(), edges.end());
    return mesh.sharp_edges.size() - before;
}

/// The edge within a sector whose two triangles' normals differ most; ties: by its vertices.
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

/// For a sector: the directions of the sharp edges at its sides, and the normals beyond them.
struct SharpSides {
    std::vector<Vec3> along, beyond;
};

SharpSides sharp_sides(const PatchMesh& mesh, std::span<const u32> corners, const Array<u32>& opposites) {
    SharpSides sides;
    const auto add = [&](u32 half, u32 from, u32 to, u32 corner_beyond) {
        if (opposites[half] == half_edges::boundary) return;
        if (!std::ranges::binary_search(mesh.mesh.sharp_edges, make_edge(from, to))) return;
        sides.along.push_back((mesh.mesh.positions[to] - mesh.mesh.positions[from]).normalized());
        sides.beyond.push_back(mesh.normals[corner_beyond / 3][corner_beyond % 3]);
    };
    for (const u32 corner : corners) {
        const u32 v = half_edges::start(mesh.mesh, corner), in = half_edges::before(corner);
        add(corner, v, half_edges::end(mesh.mesh, corner), half_edges::after(opposites[corner]));
        add(in, v, half_edges::start(mesh.mesh, in), opposites[in]);
    }
    return sides;
}

}  // namespace

std::vector<Vec3> triangle_normals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals;
    for (const Triangle& t : mesh.triangles) normals.push_back(area_vector(mesh.positions, t).normalized());
    return normals;
}

std::vector<Vec3> normals_at(std::span<const u32> corners, std::span<const Vec3> of_triangles) {
    std::vector<Vec3> around;
    for (const u32 corner : corners) around.push_back(of_triangles[corner / 3]);
    return around;
}

bool opposes(const Vec3& normal, std::span<const Vec3> around) {
    return std::ranges::any_of(around, [&](const Vec3& n) { return !(n.dot(normal) >= least_cosine); });
}

void replace_opposing(PatchMesh& mesh, Repairs& repairs) {
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
            if (normal == Vec3::Zero() || !opposes(normal, around)) continue;
            if (of_mesh.empty()) of_mesh = mesh_normals(mesh.mesh, sectors);
            const Vec3 better = opposes(of_mesh[s], around) ? most_normal(around) : of_mesh[s];
            if (opposes(better, around)) {
                if (const auto edge = most_acute_edge(mesh.mesh, sectors, corners[s], opposites, of_triangles))
                    sharp.push_back(*edge);
            } else {
                ++repairs.replaced;
                set_normal(mesh, corners[s], better);
            }
        }
        if (sharp.empty()) return;
        repairs.creased += add_sharp(mesh.mesh, std::move(sharp));
    }
}

void level_normals(PatchMesh& mesh) {
    const std::vector<Vec3> of_triangles = triangle_normals(mesh.mesh);
    const Array<u32> opposites = half_edges::opposites(mesh.mesh);
    const Sectors sectors = sectors_of(mesh.mesh);
    const std::vector<std::vector<u32>> corners = corners_of(sectors);
    CornerNormals levelled = mesh.normals;
    for (std::size_t s = 0; s < sectors.size(); ++s) {
        if (sectors.is_whole[s]) continue;
        const Vec3 normal = mesh.normals[corners[s][0] / 3][corners[s][0] % 3];
        const SharpSides sides = sharp_sides(mesh, corners[s], opposites);
        if (normal == Vec3::Zero() || sides.along.empty() || sides.along.size() > 2) continue;
        bool is_level = true;
        for (std::size_t i = 0; i < sides.along.size(); ++i)
            is_level =
                is_level && std::abs(normal.dot(sides.along[i])) <=
                                std::max(level_sine, level_share * std::abs(sides.beyond[i].dot(sides.along[i])));
        if (!is_level) continue;
        Vec3 better;
        if (sides.along.size() == 2) {
            better = sides.along[0].cross(sides.along[1]);
            if (better.norm() < least_length / 2) continue;
            better *= better.dot(normal) < 0 ? -1 : 1;
        } else {
            better = normal - sides.along[0] * sides.along[0].dot(normal);
        }
        better.normalize();
        if (better.dot(normal) < cosine_of_level || opposes(better, normals_at(corners[s], of_triangles))) continue;
        for (const u32 corner : corners[s]) levelled[corner / 3][corner % 3] = better;
    }
    mesh.normals = std::move(levelled);
}

void turn_normals(PatchMesh& mesh, std::span<const u32> triangles, Repairs& repairs) {
    const std::vector<Vec3> of_triangles = triangle_normals(mesh.mesh);
    const Sectors sectors = sectors_of(mesh.mesh);
    const std::vector<std::vector<u32>> corners = corners_of(sectors);
    std::vector<u32> turned;
    for (const u32 f : triangles) turned.insert(turned.end(), sectors.of_corner[f].begin(), sectors.of_corner[f].end());
    std::ranges::sort(turned);
    turned.erase(std::ranges::unique(turned).begin(), turned.end());
    for (const u32 s : turned) set_normal(mesh, corners[s], most_normal(normals_at(corners[s], of_triangles)));
    repairs.replaced += turned.size();
}

void align_normals(PatchMesh& mesh, std::span<const Edge> edges, Repairs& repairs) {
    const std::vector<Vec3> of_triangles = triangle_normals(mesh.mesh);
    const Sectors sectors = sectors_of(mesh.mesh);
    const std::vector<std::vector<u32>> corners = corners_of(sectors);
    std::vector<int> sharp_at(mesh.mesh.positions.size(), 0);
    std::vector<bool> is_end(mesh.mesh.positions.size(), false);
    for (const Edge& edge : mesh.mesh.sharp_edges)
        for (const u32 v : edge) ++sharp_at[v];
    for (const Edge& edge : edges)
        for (const u32 v : edge) is_end[v] = true;
    for (std::size_t s = 0; s < sectors.size(); ++s) {
        const u32 v = sectors.vertex[s];
        Vec3 normal = mesh.normals[corners[s][0] / 3][corners[s][0] % 3];
        if (!is_end[v] || normal == Vec3::Zero()) continue;
        std::vector<u32> others;
        for (const u32 corner : corners[s])
            for (const u32 other :
                 {half_edges::end(mesh.mesh, corner), half_edges::start(mesh.mesh, half_edges::before(corner))})
                if (std::ranges::binary_search(mesh.mesh.sharp_edges, make_edge(v, other)) &&
                    std::ranges::find(others, other) == others.end())
                    others.push_back(other);
        if (others.empty() || others.size() > 2) continue;
        const auto direction = [&](std::size_t i) -> Vec3 {
            return (mesh.mesh.positions[others[i]] - mesh.mesh.positions[v]).normalized();
        };
        if (others.size() == 2 && sharp_at[v] > 2) {
            const Vec3 across = direction(0).cross(direction(1));
            if (across.norm() < least_length) continue;
            normal = across.dot(normal) < 0 ? Vec3(-across.normalized()) : Vec3(across.normalized());
        } else {
            const Vec3 along = others.size() == 1 ? direction(0) : Vec3(direction(0) - direction(1));
            if (!(along.norm() > least_length)) continue;
            normal = (normal - along * (along.dot(normal) / along.squaredNorm())).normalized();
        }
        if (opposes(normal, normals_at(corners[s], of_triangles))) continue;
        set_normal(mesh, corners[s], normal);
        ++repairs.replaced;
    }
}

std::size_t smooth_edges(PatchMesh& mesh, std::span<const Edge> edges, Repairs& repairs) {
    std::vector<Edge> sought(edges.begin(), edges.end());
    std::ranges::sort(sought);
    const std::vector<Vec3> of_triangles = triangle_normals(mesh.mesh);
    const Array<u32> opposites = half_edges::opposites(mesh.mesh);
    std::vector<Edge> blunt;
    for (u32 half = 0; half < opposites.size(); ++half) {
        if (opposites[half] == half_edges::boundary || opposites[half] < half) continue;
        const Edge edge = make_edge(half_edges::start(mesh.mesh, half), half_edges::end(mesh.mesh, half));
        if (!std::ranges::binary_search(sought, edge)) continue;
        const u32 other = opposites[half];
        const auto normal = [&](u32 corner) -> const Vec3& { return mesh.normals[corner / 3][corner % 3]; };
        // At the last edge of a chain of creases, the normals differ at one end only.
        const bool is_crease = normal(half).dot(normal(half_edges::after(other))) < cosine_of_fold ||
                               normal(half_edges::after(half)).dot(normal(other)) < cosine_of_fold;
        if (!is_crease || of_triangles[half / 3].dot(of_triangles[other / 3]) > cosine_of_fold) blunt.push_back(edge);
    }
    if (blunt.empty()) return 0;
    std::ranges::sort(blunt);
    std::vector<bool> is_end(mesh.mesh.positions.size(), false);
    for (const Edge& edge : blunt)
        for (const u32 v : edge) is_end[v] = true;
    Array<Edge> sharp;
    std::ranges::set_difference(mesh.mesh.sharp_edges, blunt, std::back_inserter(sharp));
    mesh.mesh.sharp_edges = std::move(sharp);
    const Sectors sectors = sectors_of(mesh.mesh);
    const std::vector<std::vector<u32>> corners = corners_of(sectors);
    for (std::size_t s = 0; s < sectors.size(); ++s) {
        if (!is_end[sectors.vertex[s]]) continue;
        Vec3 sum = Vec3::Zero();
        for (const u32 corner : corners[s]) sum += mesh.normals[corner / 3][corner % 3];
        set_normal(mesh, corners[s], sum.norm() > least_length ? Vec3(sum.normalized()) : sum);
    }
    repairs.smoothed += blunt.size();
    return blunt.size();
}

bool loosen(PatchMesh& mesh, std::span<const Edge> edges, std::span<const u32> triangles, Repairs& repairs) {
    std::vector<bool>& pointed = mesh.pointed;
    pointed.resize(mesh.mesh.positions.size(), false);
    const std::vector<bool> before = pointed;
    std::vector<Edge> straight;
    for (const Edge& edge : edges) {
        if (before[edge[0]] && before[edge[1]]) straight.push_back(edge);
        for (const u32 v : edge) pointed[v] = true;
    }
    for (const u32 f : triangles) {
        const Triangle& t = mesh.mesh.triangles[f];
        const bool is_pointed = std::ranges::all_of(t, [&](u32 v) { return before[v]; });
        for (std::size_t i = 0; i < 3; ++i) {
            if (is_pointed) straight.push_back(make_edge(t[i], t[(i + 1) % 3]));
            pointed[t[i]] = true;
        }
    }
    for (std::size_t f = 0; f < mesh.mesh.triangles.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i)
            if (pointed[mesh.mesh.triangles[f][i]]) mesh.normals[f][i] = Vec3::Zero();
    const std::size_t added = add_sharp(mesh.mesh, std::move(straight));
    repairs.straightened += added;
    repairs.pointed = static_cast<std::size_t>(std::ranges::count(pointed, true));
    return added > 0 || pointed != before;
}

}  // namespace scanmill::a_patches
