// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/refinement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr double least_sine_of_crease = 0.1;  // between the normals on its sides, to give the crease a direction
constexpr double least_cosine_of_part = 0.5;  // between the normals of a part and of the triangle or new vertex

struct LongEdge {
    double squared;
    Edge ends;
    u32 half_edge;

    bool operator<(const LongEdge& other) const {
        return std::tuple(-squared, ends, half_edge) < std::tuple(-other.squared, other.ends, other.half_edge);
    }
};

LongEdge longest_edge(const TriangleMesh& mesh, u32 triangle) {
    LongEdge longest{-1, {}, 0};
    for (u32 half = 3 * triangle; half < 3 * triangle + 3; ++half) {
        const u32 a = half_edges::start(mesh, half), b = half_edges::end(mesh, half);
        longest =
            std::min(longest, LongEdge{(mesh.positions[b] - mesh.positions[a]).squaredNorm(), make_edge(a, b), half});
    }
    return longest;
}

/// Bisects the edges, the longest first. Skips an edge if one of its triangles is already cut. Returns the number of
/// bisected edges.
std::size_t bisect(PatchMesh& patch_mesh, std::vector<LongEdge> edges, Middle position) {
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
        const Vec3 whole = face_normal(half / 3);
        for (const Vec3& n : {normal_of(i, middle, k), normal_of(middle, j, k)})
            if (!(n.dot(whole) >= least_cosine_of_part && n.dot(normal) >= least_cosine_of_part)) return false;
        return true;
    };
    for (const LongEdge& edge : edges) {
        const u32 half = edge.half_edge, other = opposites[half];
        const bool is_border = other == half_edges::boundary;
        if (is_cut[half / 3] || (!is_border && is_cut[other / 3])) continue;
        ++bisected;
        const u32 a = half_edges::start(mesh, half), b = half_edges::end(mesh, half);
        const bool is_sharp = !is_border && std::ranges::binary_search(mesh.sharp_edges, edge.ends);
        const Vec3 d = positions[b] - positions[a];
        const auto middle = static_cast<u32>(positions.size());
        // Normals of the edge, by end and side.
        const std::array<std::array<Vec3, 2>, 2> at{
            {{corner_normal(half), is_border ? corner_normal(half) : corner_normal(half_edges::after(other))},
             {corner_normal(half_edges::after(half)),
              is_border ? corner_normal(half_edges::after(half)) : corner_normal(other)}}};
        // The difference between d and the tangent at an end.
        const auto missing = [&](const std::array<Vec3, 2>& n) -> Vec3 {
            const Vec3 crease = n[0].cross(n[1]);
            if (!is_sharp || crease.norm() < least_sine_of_crease) return d.dot(n[0]) * n[0];
            return d - crease * (crease.dot(d) / crease.squaredNorm());
        };
        const Vec3 at_a = missing(at[0]), at_b = missing(at[1]), tangent = d + (at_a + at_b) / 4;
        std::array<Vec3, 2> new_normals;
        for (std::size_t side = 0; side < 2; ++side) {
            const Vec3 sum = at[0][side] + at[1][side];
            new_normals[side] = (sum - tangent * (tangent.dot(sum) / tangent.squaredNorm())).normalized();
        }
        positions.push_back((positions[a] + positions[b]) / 2 + (at_b - at_a) / 8);
        if (position == Middle::of_segment || !is_sound(half, new_normals[0]) ||
            (!is_border && !is_sound(other, new_normals[1]))) {
            positions.back() = (positions[a] + positions[b]) / 2;
            const Vec3 first = face_normal(half / 3), second = is_border ? Vec3(Vec3::Zero()) : face_normal(other / 3);
            new_normals = {is_sharp ? first : (first + second).normalized(),
                           is_sharp ? second : (first + second).normalized()};
        }
        if (is_sharp) {
            sharp.erase(std::ranges::lower_bound(sharp, edge.ends));
            for (const u32 end : {a, b})
                sharp.insert(std::ranges::lower_bound(sharp, make_edge(end, middle)), make_edge(end, middle));
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
            normals.push_back(second_normals);
        }
    }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(cut);
    mesh.sharp_edges = Array<Edge>(sharp.begin(), sharp.end());
    return bisected;
}

}  // namespace

std::size_t bisect(PatchMesh& mesh, std::span<const u32> triangles) {
    std::vector<LongEdge> edges;
    for (const u32 triangle : triangles) edges.push_back(longest_edge(mesh.mesh, triangle));
    return bisect(mesh, std::move(edges), Middle::of_curve);
}

std::size_t bisect_edges(PatchMesh& mesh, std::span<const Edge> edges, Middle middle) {
    std::vector<Edge> sought(edges.begin(), edges.end());
    std::ranges::sort(sought);
    std::vector<LongEdge> found;
    for (u32 half = 0; half < 3 * mesh.mesh.triangles.size(); ++half) {
        const u32 a = half_edges::start(mesh.mesh, half), b = half_edges::end(mesh.mesh, half);
        if (a < b && std::ranges::binary_search(sought, make_edge(a, b)))
            found.push_back({(mesh.mesh.positions[b] - mesh.mesh.positions[a]).squaredNorm(), make_edge(a, b), half});
    }
    return bisect(mesh, std::move(found), middle);
}

}  // namespace scanmill::a_patches
