// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/refinement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr double least_cosine_of_part = 0.5;  // between the normals of a part and of the triangle or new vertex
constexpr double least_share_of_part = 0.1;  // of the area of the triangle; thinner parts are needles
constexpr double straight_share = 1e-3;  // weight of an edge's length beside its curving
constexpr double rounding = 1e-12;  // share of a size up to which two sizes tie

struct LongEdge {
    double squared;
    Edge ends;
    u32 half_edge;

    bool operator<(const LongEdge& other) const {
        return std::tuple(-squared, ends, half_edge) < std::tuple(-other.squared, other.ends, other.half_edge);
    }
};

/// The edge whose ends' normals make the surface deviate most from it; its longest edge if no normal makes it deviate.
/// Ties: the edge with the lower vertices.
LongEdge most_curved_edge(const PatchMesh& mesh, u32 triangle) {
    LongEdge best{0, {}, 0};
    double greatest = -1;
    for (u32 half = 3 * triangle; half < 3 * triangle + 3; ++half) {
        const u32 a = half_edges::start(mesh.mesh, half), b = half_edges::end(mesh.mesh, half);
        const Vec3 d = mesh.mesh.positions[b] - mesh.mesh.positions[a];
        const auto& normals = mesh.normals[triangle];
        const double bend = std::max(std::abs(normals[half % 3].dot(d)), std::abs(normals[(half + 1) % 3].dot(d)));
        const double size = bend + straight_share * d.norm();
        const LongEdge edge{d.squaredNorm(), make_edge(a, b), half};
        const bool is_tie = std::abs(size - greatest) <= rounding * greatest;
        if (is_tie ? !(edge < best) : size < greatest) continue;
        greatest = size;
        best = edge;
    }
    return best;
}

/// Bisects the edges, the longest first. Skips an edge if one of its triangles is already cut. Returns the number of
/// bisected edges.
std::size_t bisect(PatchMesh& patch_mesh, std::vector<LongEdge> edges) {
    TriangleMesh& mesh = patch_mesh.mesh;
    CornerNormals& normals = patch_mesh.normals;
    const Array<u32> opposites = half_edges::opposites(mesh);
    std::ranges::sort(edges, std::less<>());

    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    Array<Triangle> cut(mesh.triangles.begin(), mesh.triangles.end());
    std::vector<Edge> sharp(mesh.sharp_edges.begin(), mesh.sharp_edges.end());
    std::vector<bool> is_cut(cut.size(), false);
    std::size_t bisected = 0;
    const auto normal_of = [&](u32 i, u32 j, u32 k) -> Vec3 { return area_vector(positions, {i, j, k}).normalized(); };
    const auto face_normal = [&](u32 f) { return normal_of(cut[f][0], cut[f][1], cut[f][2]); };
    const auto corner_normal = [&](u32 half) -> const Vec3& { return normals[half / 3][half % 3]; };
    // Whether the last vertex, with this normal, may cut the triangle at this half-edge.
    const auto is_sound = [&](u32 half, const Vec3& normal) {
        const auto middle = static_cast<u32>(positions.size() - 1);
        const u32 i = half_edges::start(mesh, half), j = half_edges::end(mesh, half),
                  k = half_edges::start(mesh, half_edges::before(half));
        const Triangle& t = cut[half / 3];
        const Vec3 whole = area_vector(positions, t);
        for (const Triangle& part : {Triangle{i, middle, k}, Triangle{middle, j, k}}) {
            const Vec3 area = area_vector(positions, part);
            if (!(area.dot(whole) >= least_share_of_part * whole.squaredNorm())) return false;
            const Vec3 n = area.normalized();
            if (!(n.dot(whole.normalized()) >= least_cosine_of_part && n.dot(normal) >= least_cosine_of_part))
                return false;
        }
        return true;
    };
    std::vector<Edge> open = patch_mesh.open;
    patch_mesh.flat.resize(cut.size(), false);
    const auto cut_in_two = [](std::vector<Edge>& list, const Edge& whole, u32 middle) {
        list.erase(std::ranges::lower_bound(list, whole));
        for (const u32 end : whole)
            list.insert(std::ranges::lower_bound(list, make_edge(end, middle)), make_edge(end, middle));
    };
    for (const LongEdge& edge : edges) {
        const u32 half = edge.half_edge, other = opposites[half];
        const bool is_border = other == half_edges::boundary;
        if (is_cut[half / 3] || (!is_border && is_cut[other / 3])) continue;
        const u32 a = half_edges::start(mesh, half), b = half_edges::end(mesh, half);
        const bool is_sharp = !is_border && std::ranges::binary_search(mesh.sharp_edges, edge.ends);
        const Vec3 d = positions[b] - positions[a];
        // Normals of the edge, by end and side.
        const std::array<std::array<Vec3, 2>, 2> at{
            {{corner_normal(half), is_border ? corner_normal(half) : corner_normal(half_edges::after(other))},
             {corner_normal(half_edges::after(half)),
              is_border ? corner_normal(half_edges::after(half)) : corner_normal(other)}}};
        const Vec3 at_a = off_tangent(d, at[0][0], at[0][1], is_sharp),
                   at_b = off_tangent(d, at[1][0], at[1][1], is_sharp);
        if (is_sharp && at_a.dot(at_b) > 0) continue;  // an S, whose halves leave the edge as much
        const Vec3 tangent = d + (at_a + at_b) / 4;
        const auto middle = static_cast<u32>(positions.size());
        ++bisected;
        patch_mesh.bisected.push_back(edge.ends);
        std::array<Vec3, 2> new_normals;
        for (std::size_t side = 0; side < 2; ++side) {
            const Vec3 sum = at[0][side] + at[1][side];
            new_normals[side] = (sum - tangent * (tangent.dot(sum) / tangent.squaredNorm())).normalized();
        }
        positions.push_back((positions[a] + positions[b]) / 2 + (at_b - at_a) / 8);
        if (!is_sound(half, new_normals[0]) || (!is_border && !is_sound(other, new_normals[1]))) {
            positions.back() = (positions[a] + positions[b]) / 2;
            const Vec3 first = face_normal(half / 3), second = is_border ? Vec3(Vec3::Zero()) : face_normal(other / 3);
            new_normals = {is_sharp ? first : (first + second).normalized(),
                           is_sharp ? second : (first + second).normalized()};
        }
        if (is_sharp) {
            cut_in_two(sharp, edge.ends, middle);
            if (patch_mesh.is_open(edge.ends)) cut_in_two(open, edge.ends, middle);
        }
        for (std::size_t side = 0; side < (is_border ? 1 : 2); ++side) {
            const u32 of_side = side == 0 ? half : other;
            is_cut[of_side / 3] = true;
            Triangle& first = cut[of_side / 3];
            std::array<Vec3, 3>& first_normals = normals[of_side / 3];
            Triangle second = first;
            std::array<Vec3, 3> second_normals = first_normals;
            const u32 i = of_side % 3, j = (i + 1) % 3;  // of_side % 3 is the corner where the edge begins
            first[j] = second[i] = middle;
            first_normals[j] = second_normals[i] = new_normals[side];
            cut.push_back(second);
            patch_mesh.flat.push_back(patch_mesh.flat[of_side / 3]);
            normals.push_back(second_normals);
        }
    }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(cut);
    mesh.sharp_edges = Array<Edge>(sharp.begin(), sharp.end());
    patch_mesh.open = std::move(open);
    return bisected;
}

}  // namespace

std::size_t bisect(PatchMesh& mesh, std::span<const u32> triangles) {
    std::vector<LongEdge> edges;
    for (const u32 triangle : triangles) edges.push_back(most_curved_edge(mesh, triangle));
    return bisect(mesh, std::move(edges));
}

std::size_t bisect_edges(PatchMesh& mesh, std::span<const Edge> edges) {
    std::vector<Edge> sought(edges.begin(), edges.end());
    std::ranges::sort(sought);
    std::vector<LongEdge> found;
    for (u32 half = 0; half < 3 * mesh.mesh.triangles.size(); ++half) {
        const u32 a = half_edges::start(mesh.mesh, half), b = half_edges::end(mesh.mesh, half);
        if (a < b && std::ranges::binary_search(sought, make_edge(a, b)))
            found.push_back({(mesh.mesh.positions[b] - mesh.mesh.positions[a]).squaredNorm(), make_edge(a, b), half});
    }
    return bisect(mesh, std::move(found));
}

}  // namespace scanmill::a_patches
