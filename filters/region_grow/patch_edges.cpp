// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/patch_edges.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace scanmill::growing {

namespace {

using Coordinates = std::array<double, 3>;

/// Returns the ends of a segment, in the same order for both directions.
std::pair<Coordinates, Coordinates> segment(const Vec3& a, const Vec3& b) {
    const auto coordinates = [](const Vec3& p) { return Coordinates{p.x(), p.y(), p.z()}; };
    return std::minmax({coordinates(a), coordinates(b)});
}

/// Adds the unit normals of the triangles at each vertex in `normals` to its entry.
void add_normals(const TriangleMesh& mesh, std::map<u32, Vec3>& normals) {
    std::vector<bool> wanted(mesh.positions.size(), false);
    for (const auto& [vertex, normal] : normals) wanted[vertex] = true;
    for (const auto& [a, b, c] : mesh.triangles) {
        if (!wanted[a] && !wanted[b] && !wanted[c]) continue;
        const auto& p = mesh.positions;
        const Vec3 normal = (p[b] - p[a]).normalized().cross((p[c] - p[a]).normalized()).normalized();
        for (u32 corner : {a, b, c})
            if (wanted[corner]) normals[corner] += normal;
    }
}

}  // namespace

std::vector<PatchEdge> find_patch_edges(const Surface& surface, PointChooser& chooser, const Limits& limits,
                                        const Context& context) {
    std::size_t tests = 0;
    std::vector<PatchEdge> edges;
    for (const Triangle& triangle : surface.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3];
            if (surface.states[from] != PointState::front || surface.states[to] != PointState::front ||
                surface.fans.right_of(from, to) != invalid_index)
                continue;
            if (tests++ % 64 == 0) context.check_cancelled();
            const u32 beyond = chooser.beyond_sharp_edge(from, to, limits);
            if (beyond != invalid_index) edges.push_back({from, to, beyond});
        }
    return edges;
}

void set_sharp_edges(FinishedMesh& finished, const FeatureLines& lines, std::span<const PatchEdge> patch_edges,
                     std::span<const Edge> more) {
    const FeatureGraph& graph = lines.graph;
    const auto vertex_at = [&](u32 row) { return lines.mesh_vertices[graph.vertices[row]]; };
    Array<Edge> sharp;
    for (const FeaturePolyline& line : graph.polylines) {
        if (line.type != FeatureType::crease) continue;
        for (u32 row = line.begin; row + 1 < line.end; ++row)
            sharp.push_back(make_edge(vertex_at(row), vertex_at(row + 1)));
        if (line.closed) sharp.push_back(make_edge(vertex_at(line.end - 1), vertex_at(line.begin)));
    }
    const auto& vertex = finished.vertex_of_point;
    for (const PatchEdge& edge : patch_edges) sharp.push_back(make_edge(vertex[edge.from], vertex[edge.to]));
    sharp.insert(sharp.end(), more.begin(), more.end());
    std::ranges::sort(sharp);
    sharp.erase(std::unique(sharp.begin(), sharp.end()), sharp.end());
    finished.mesh.sharp_edges = std::move(sharp);
}

void set_normals_beyond(FeatureGraph& features, const FinishedMesh& finished, std::span<const PatchEdge> patch_edges) {
    if (patch_edges.empty()) return;
    const auto& vertex = finished.vertex_of_point;
    std::map<u32, Vec3> normals;
    std::map<std::pair<Coordinates, Coordinates>, u32> beyond;
    const auto& p = finished.mesh.positions;
    for (const PatchEdge& edge : patch_edges) {
        beyond[segment(p[vertex[edge.from]], p[vertex[edge.to]])] = vertex[edge.beyond];
        normals[vertex[edge.beyond]] = Vec3::Zero();
    }
    add_normals(finished.mesh, normals);

    Array<Vec3> right(features.right_normals.begin(), features.right_normals.end());
    for (const FeaturePolyline& line : features.polylines) {
        if (line.type == FeatureType::crease) continue;
        for (u32 i = line.begin; i < line.end; ++i) {
            const u32 next = i + 1 < line.end ? i + 1 : line.begin;
            const auto found = beyond.find(
                segment(features.positions[features.vertices[i]], features.positions[features.vertices[next]]));
            if (found != beyond.end()) right[i] = normals[found->second].normalized();
        }
    }
    features.right_normals = std::move(right);
}

}  // namespace scanmill::growing
