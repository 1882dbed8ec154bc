// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/far_sides.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>

namespace scanmill::growing {

namespace {

using Place = std::array<double, 3>;

Place place_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// Whichever way it is passed.
std::pair<Place, Place> segment(const Vec3& a, const Vec3& b) { return std::minmax({place_of(a), place_of(b)}); }

/// Of the wanted vertices the summed normals of their triangles.
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

void tell_far_sides(FeatureGraph& features, const FinishedMesh& finished, const Samples& samples,
                    std::span<const PatchEdge> patch_edges) {
    if (patch_edges.empty()) return;
    const auto vertex = [&](u32 place) {
        return static_cast<u32>(std::ranges::lower_bound(finished.rows, samples.rows[place]) - finished.rows.begin());
    };
    std::map<u32, Vec3> normals;
    std::map<std::pair<Place, Place>, u32> beyond;
    const auto& p = finished.mesh.positions;
    for (const PatchEdge& edge : patch_edges) {
        beyond[segment(p[vertex(edge.from)], p[vertex(edge.to)])] = vertex(edge.beyond);
        normals[vertex(edge.beyond)] = Vec3::Zero();
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
