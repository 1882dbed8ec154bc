// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/refinement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>

#include "scanmill/geometry/mesh/half_edges.hpp"

namespace scanmill::a_patches {

namespace {

constexpr double least_cosine_of_part = 0.5;  // to the whole triangle, and to the new vertex

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

}  // namespace

std::size_t bisect(MeshWithNormals& with_normals, std::span<const u32> triangles) {
    TriangleMesh& mesh = with_normals.mesh;
    std::vector<Vec3>& normals = with_normals.normals;
    const Array<u32> opposites = half_edges::opposites(mesh);
    std::vector<LongEdge> edges;
    for (const u32 triangle : triangles) edges.push_back(longest_edge(mesh, triangle));
    std::ranges::sort(edges, std::less<>());

    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    Array<Triangle> cut(mesh.triangles.begin(), mesh.triangles.end());
    std::vector<bool> is_cut(cut.size(), false);
    std::size_t bisected = 0;
    const auto normal_of = [&](u32 i, u32 j, u32 k) -> Vec3 {
        return (positions[j] - positions[i]).cross(positions[k] - positions[i]).normalized();
    };
    const auto face_normal = [&](u32 f) { return normal_of(cut[f][0], cut[f][1], cut[f][2]); };
    // Whether the last vertex may cut the triangle at this half-edge.
    const auto is_sound = [&](u32 half) {
        const auto middle = static_cast<u32>(positions.size() - 1);
        const u32 i = half_edges::start(mesh, half), j = half_edges::end(mesh, half),
                  k = half_edges::start(mesh, half_edges::before(half));
        const Vec3 whole = face_normal(half / 3);
        for (const Vec3& n : {normal_of(i, middle, k), normal_of(middle, j, k)})
            if (!(n.dot(whole) >= least_cosine_of_part && n.dot(normals[middle]) >= least_cosine_of_part)) return false;
        return true;
    };
    for (const LongEdge& edge : edges) {
        const u32 other = opposites[edge.half_edge];
        const bool is_border = other == half_edges::boundary;
        if (is_cut[edge.half_edge / 3] || (!is_border && is_cut[other / 3])) continue;
        ++bisected;
        const auto [a, b] = edge.ends;
        const Vec3 d = positions[b] - positions[a];
        const auto middle = static_cast<u32>(positions.size());
        const Vec3 at_a = d.dot(normals[a]) * normals[a], at_b = d.dot(normals[b]) * normals[b];
        const Vec3 sum = normals[a] + normals[b], tangent = d + (at_a + at_b) / 4;
        positions.push_back((positions[a] + positions[b]) / 2 + (at_b - at_a) / 8);
        normals.push_back((sum - tangent * (tangent.dot(sum) / tangent.squaredNorm())).normalized());
        if (!is_sound(edge.half_edge) || (!is_border && !is_sound(other))) {
            positions.back() = (positions[a] + positions[b]) / 2;
            normals.back() =
                (face_normal(edge.half_edge / 3) + (is_border ? Vec3(Vec3::Zero()) : face_normal(other / 3)))
                    .normalized();
        }
        for (const u32 half : {edge.half_edge, other}) {
            if (half == half_edges::boundary) continue;
            is_cut[half / 3] = true;
            Triangle& first = cut[half / 3];
            Triangle second = first;
            first[(half + 1) % 3] = middle;  // half % 3 is the corner where the edge begins: 3 divides 3 * triangle
            second[half % 3] = middle;
            cut.push_back(second);
        }
    }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(cut);
    return bisected;
}

}  // namespace scanmill::a_patches
