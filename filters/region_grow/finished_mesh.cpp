// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/finished_mesh.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

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

}  // namespace scanmill::growing
