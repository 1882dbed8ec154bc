// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/repair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "a_patch/normals.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/lists.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr double cosine_of_fold = 0.8660254037844386;  // of 30 degrees
// Sines of the deviation of a normal from perpendicular to a sharp edge: the largest one, and the largest as a share of
// the deviation of the normal beyond the edge.
constexpr double level_sine = 1e-3, level_share = 0.1;
constexpr double cosine_of_level = 0.9993908270190958;  // of 2 degrees
// A normal is turned in steps until its cosines with the triangles' normals are large enough.
constexpr double least_turned_cosine = 0.3, turn_share = 0.15;
constexpr int most_turns = 60;
constexpr double least_length = 0.1;  // least length of a sum or product of unit vectors that gives a direction

void set_normal(PatchMesh& mesh, std::span<const u32> corners, const Vec3& normal) {
    for (const u32 corner : corners) mesh.normals[corner / 3][corner % 3] = normal;
}

/// Turns a normal towards the normals of its triangles, each time towards the one that differs most, until none is more
/// than 73 degrees from it.
Vec3 turned_to(Vec3 normal, std::span<const Vec3> around) {
    for (int turn = 0; turn < most_turns; ++turn) {
        const auto worst = std::ranges::min_element(around, {}, [&](const Vec3& n) { return n.dot(normal); });
        if (worst->dot(normal) >= least_turned_cosine) break;
        normal = (normal + turn_share * *worst).normalized();
    }
    return normal;
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
            if (normal == Vec3::Zero()) continue;
            const Vec3 turned = turned_to(normal, around);
            if (!opposes(turned, around)) {
                if (turned != normal) {
                    ++repairs.replaced;
                    set_normal(mesh, corners[s], turned);
                }
                continue;
            }
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

void smooth_agreeing_edges(PatchMesh& mesh, Repairs& repairs) {
    const Array<u32> opposites = half_edges::opposites(mesh.mesh);
    const auto normal = [&](u32 corner) -> const Vec3& { return mesh.normals[corner / 3][corner % 3]; };
    const auto agree = [&](const Vec3& one, const Vec3& other) {
        return one == Vec3::Zero() || other == Vec3::Zero() || one.dot(other) >= cosine_of_fold;
    };
    const std::span sharp = mesh.mesh.sharp_edges.span();
    std::vector<bool> may_end(sharp.size(), false), is_smooth(sharp.size(), false);
    for (u32 half = 0; half < opposites.size(); ++half) {
        const u32 other = opposites[half];
        if (other == half_edges::boundary || other < half) continue;
        const Edge edge = make_edge(half_edges::start(mesh.mesh, half), half_edges::end(mesh.mesh, half));
        const auto found = std::ranges::lower_bound(sharp, edge);
        if (found == sharp.end() || *found != edge) continue;
        may_end[static_cast<std::size_t>(found - sharp.begin())] =
            agree(normal(half), normal(half_edges::after(other))) &&
            agree(normal(half_edges::after(half)), normal(other));
    }
    // Lines lose agreeing edges from their free ends on. What is left of a part without other edges is smooth, too.
    const Lists<> edges_at(mesh.mesh.positions.size(), [&](auto&& add) {
        for (u32 e = 0; e < sharp.size(); ++e)
            for (const u32 v : sharp[e]) add(v, e);
    });
    DisjointSets parts(sharp.size());
    std::vector<u32> count(mesh.mesh.positions.size()), ends;
    for (u32 v = 0; v < count.size(); ++v) {
        count[v] = static_cast<u32>(edges_at[v].size());
        if (count[v] == 1) ends.push_back(v);
        for (const u32 e : edges_at[v]) parts.unite(edges_at[v][0], e);
    }
    while (!ends.empty()) {
        const u32 v = ends.back();
        ends.pop_back();
        for (const u32 e : edges_at[v]) {
            if (is_smooth[e] || !may_end[e] || count[v] != 1) continue;
            is_smooth[e] = true;
            for (const u32 end : sharp[e])
                if (--count[end] == 1) ends.push_back(end);
        }
    }
    std::vector<bool> has_crease(sharp.size(), false);
    for (u32 e = 0; e < sharp.size(); ++e)
        if (!may_end[e]) has_crease[parts.find(e)] = true;
    std::vector<bool> is_changed(mesh.mesh.positions.size(), false);
    Array<Edge> left;
    for (u32 e = 0; e < sharp.size(); ++e) {
        if (has_crease[parts.find(e)] && !is_smooth[e]) {
            left.push_back(sharp[e]);
            continue;
        }
        ++repairs.smoothed;
        for (const u32 v : sharp[e]) is_changed[v] = true;
    }
    if (left.size() == sharp.size()) return;
    mesh.mesh.sharp_edges = std::move(left);
    const Sectors sectors = sectors_of(mesh.mesh);
    const std::vector<std::vector<u32>> corners = corners_of(sectors);
    for (std::size_t s = 0; s < sectors.size(); ++s) {
        if (!is_changed[sectors.vertex[s]]) continue;
        Vec3 sum = Vec3::Zero();
        for (const u32 corner : corners[s]) sum += normal(corner);
        // Equal normals stay as they are, bit for bit.
        const bool are_equal =
            std::ranges::all_of(corners[s], [&](u32 c) { return normal(c) == normal(corners[s][0]); });
        if (!are_equal) set_normal(mesh, corners[s], sum.normalized());
    }
}

bool move_back(PatchMesh& mesh, u32 triangle) {
    const std::size_t first_new = mesh.mesh.positions.size() - mesh.bisected.size();
    std::vector<u32> sought;
    for (const u32 v : mesh.mesh.triangles[triangle]) sought.push_back(v);
    for (std::size_t i = 0; i < sought.size(); ++i)
        if (sought[i] >= first_new)
            for (const u32 end : mesh.bisected[sought[i] - first_new]) sought.push_back(end);
    // An edge is older than the vertex in its middle.
    std::ranges::sort(sought);
    Array<Vec3> positions(mesh.mesh.positions.begin(), mesh.mesh.positions.end());
    bool has_moved = false;
    for (const u32 v : sought) {
        if (v < first_new) continue;
        const auto& [a, b] = mesh.bisected[v - first_new];
        const Vec3 middle = (positions[a] + positions[b]) / 2;
        has_moved = has_moved || positions[v] != middle;
        positions[v] = middle;
    }
    if (!has_moved) return false;
    mesh.mesh.positions = std::move(positions);
    for (u32 f = 0; f < mesh.flat.size(); ++f)
        if (mesh.flat[f]) mesh.normals[f].fill(area_vector(mesh.mesh.positions, mesh.mesh.triangles[f]).normalized());
    return true;
}

void follow_mesh(PatchMesh& mesh, std::span<const Edge> edges, std::span<const u32> triangles, Repairs& repairs) {
    std::vector<Edge> opened(edges.begin(), edges.end());
    repairs.opened += edges.size();
    mesh.flat.resize(mesh.mesh.triangles.size(), false);
    const Array<u32> opposites = half_edges::opposites(mesh.mesh);
    for (const u32 f : triangles) {
        if (mesh.flat[f]) continue;
        mesh.flat[f] = true;
        ++repairs.flattened;
        mesh.normals[f].fill(area_vector(mesh.mesh.positions, mesh.mesh.triangles[f]).normalized());
        for (u32 half = 3 * f; half < 3 * f + 3; ++half)
            if (opposites[half] != half_edges::boundary)
                opened.push_back(make_edge(half_edges::start(mesh.mesh, half), half_edges::end(mesh.mesh, half)));
    }
    add_sharp(mesh.mesh, opened);
    mesh.open.insert(mesh.open.end(), opened.begin(), opened.end());
    std::ranges::sort(mesh.open);
    mesh.open.erase(std::ranges::unique(mesh.open).begin(), mesh.open.end());
}

}  // namespace scanmill::a_patches
