// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/finished_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "scanmill/geometry/mesh/facet_normals.hpp"

namespace scanmill::growing {

namespace {

/// The third corner of the triangle beyond the edge. Triangles may have been turned over since they were stored.
u32 opposite(const Surface& surface, u32 from, u32 to, u32 third) {
    const u32 left = surface.fans.left_of(from, to), right = surface.fans.right_of(from, to);
    return left == third ? right : left;
}

/// By places. Each edge is asked from its triangle whose third corner is the lower.
std::vector<Edge> bent_edges(const Surface& surface, Angle sharp_angle) {
    const double limit = sharp_angle.in_radians() + angle_tie;
    const double surely_below = std::cos(limit) + 1e-6;
    std::vector<Edge> edges;
    for (const Triangle& triangle : surface.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3], third = triangle[(i + 2) % 3];
            const u32 other = opposite(surface, from, to, third);
            if (other == nobody || other < third) continue;
            const Vec3 one = surface.facet_normal(from, to, third), two = surface.facet_normal(to, from, other);
            if (one.dot(two) < surely_below && angle_between(one, two) > limit) edges.push_back(make_edge(from, to));
        }
    return edges;
}

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

std::vector<PatchEdge> find_patch_edges(const Surface& surface, PointChooser& chooser, const Limits& limits,
                                        const Context& context) {
    std::size_t looks = 0;
    std::vector<PatchEdge> edges;
    for (const Triangle& triangle : surface.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 from = triangle[i], to = triangle[(i + 1) % 3];
            if (surface.states[from] != PlaceState::front || surface.states[to] != PlaceState::front ||
                surface.fans.right_of(from, to) != nobody)
                continue;
            if (looks++ % 64 == 0) context.check_cancelled();
            const u32 beyond = chooser.beyond_sharp_edge(from, to, limits);
            if (beyond != nobody) edges.push_back({from, to, beyond});
        }
    return edges;
}

FinishedMesh finish_mesh(const PointCloud& cloud, const Surface& surface, std::span<const PatchEdge> patch_edges,
                         Angle sharp_angle) {
    const auto& rows = surface.samples.rows;
    FinishedMesh finished;
    Array<u32> vertex_of_row(cloud.size());
    std::ranges::fill(vertex_of_row, nobody);
    for (u32 place = 0; place < rows.size(); ++place)
        if (!surface.fans.empty(place)) vertex_of_row[rows[place]] = 0;
    for (u32 row = 0; row < cloud.size(); ++row) {
        if (vertex_of_row[row] == nobody) continue;
        vertex_of_row[row] = static_cast<u32>(finished.rows.size());
        finished.rows.push_back(row);
    }
    const auto vertex = [&](u32 place) { return vertex_of_row[rows[place]]; };

    TriangleMesh& mesh = finished.mesh;
    mesh.frame = cloud.frame;
    mesh.positions = gather(cloud.positions, finished.rows);
    mesh.vertex_columns = cloud.columns.gather(finished.rows);
    Array<Triangle> triangles(surface.triangles.size());
    for (std::size_t row = 0; row < triangles.size(); ++row) {
        const auto& [a, b, c] = surface.triangles[row];
        triangles[row] = {vertex(a), vertex(b), vertex(c)};
        std::ranges::rotate(triangles[row], std::ranges::min_element(triangles[row]));
    }
    mesh.triangles = std::move(triangles);
    Array<Edge> sharp;
    for (const auto& [a, b] : bent_edges(surface, sharp_angle)) sharp.push_back(make_edge(vertex(a), vertex(b)));
    for (const PatchEdge& edge : patch_edges) sharp.push_back(make_edge(vertex(edge.from), vertex(edge.to)));
    std::ranges::sort(sharp);
    mesh.sharp_edges = std::move(sharp);
    return finished;
}

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
