// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/finished_mesh.hpp"

#include <algorithm>

#include "scanmill/geometry/facet_normals.hpp"
#include "scanmill/geometry/sides.hpp"

namespace scanmill::growing {

namespace {

/// As feature_lines.hpp counts angles as equal.
constexpr double angle_tie = 1e-9;

Array<Edge> bent_edges(const TriangleMesh& mesh, double limit, unsigned threads) {
    const Array<u32> twins = sides::oriented_twins(mesh);
    const FacetNormals normals = facet_normals(mesh, twins, threads);
    Array<Edge> edges;
    for (u32 side = 0; side < twins.size(); ++side) {
        if (twins[side] >= sides::no_side || twins[side] < side) continue;
        if (angle_between(normals.unit[side / 3], normals.unit[twins[side] / 3]) > limit)
            edges.push_back(make_edge(sides::start(mesh, side), sides::end(mesh, side)));
    }
    return edges;
}

}  // namespace

FinishedMesh finish_mesh(const PointCloud& cloud, const Surface& surface, std::span<const Edge> patch_edges,
                         Angle sharp_angle, unsigned threads) {
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
    Array<Edge> sharp = bent_edges(mesh, sharp_angle.in_radians() + angle_tie, threads);
    for (const auto& [a, b] : patch_edges) sharp.push_back(make_edge(vertex(a), vertex(b)));
    std::ranges::sort(sharp);
    mesh.sharp_edges = std::move(sharp);
    return finished;
}

}  // namespace scanmill::growing
