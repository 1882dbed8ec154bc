// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/finished_mesh.hpp"

#include <algorithm>
#include <utility>

namespace scanmill::growing {

FinishedMesh finish_mesh(const PointCloud& cloud, const Surface& surface) {
    const auto& rows = surface.points.rows;
    FinishedMesh finished;
    Array<u32> vertex_of_row(cloud.size());
    std::ranges::fill(vertex_of_row, invalid_index);
    for (u32 point = 0; point < rows.size(); ++point)
        if (!surface.fans.empty(point)) vertex_of_row[rows[point]] = 0;
    for (u32 row = 0; row < cloud.size(); ++row) {
        if (vertex_of_row[row] == invalid_index) continue;
        vertex_of_row[row] = static_cast<u32>(finished.rows.size());
        finished.rows.push_back(row);
    }
    finished.vertex_of_point.resize(rows.size());
    for (u32 point = 0; point < rows.size(); ++point) finished.vertex_of_point[point] = vertex_of_row[rows[point]];

    TriangleMesh& mesh = finished.mesh;
    mesh.frame = cloud.frame;
    mesh.positions = gather(cloud.positions, finished.rows);
    mesh.vertex_columns = cloud.columns.gather(finished.rows);
    Array<Triangle> triangles(surface.triangles.size());
    for (std::size_t row = 0; row < triangles.size(); ++row) {
        for (std::size_t i = 0; i < 3; ++i) triangles[row][i] = finished.vertex_of_point[surface.triangles[row][i]];
        std::ranges::rotate(triangles[row], std::ranges::min_element(triangles[row]));
    }
    mesh.triangles = std::move(triangles);
    return finished;
}

}  // namespace scanmill::growing
