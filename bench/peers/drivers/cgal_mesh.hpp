// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Conversion between raw arrays and a CGAL::Surface_mesh.

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Surface_mesh.h>

#include "cgal_jobs.hpp"

namespace peers {

/// A Surface_mesh is an oriented manifold, so vertices and edges where `raw` is not manifold are duplicated.
template <class Kernel>
CGAL::Surface_mesh<typename Kernel::Point_3> mesh_of(const RawInput& raw) {
    namespace processing = CGAL::Polygon_mesh_processing;
    std::vector<typename Kernel::Point_3> points;
    for (const auto& [x, y, z] : raw.points) points.emplace_back(x, y, z);
    std::vector<std::array<std::size_t, 3>> triangles;
    for (const auto& [a, b, c] : raw.triangles) triangles.push_back({a, b, c});
    processing::orient_polygon_soup(points, triangles);
    CGAL::Surface_mesh<typename Kernel::Point_3> mesh;
    processing::polygon_soup_to_polygon_mesh(points, triangles, mesh);
    return mesh;
}

template <class Mesh>
RawInput raw_of(Mesh& mesh) {
    mesh.collect_garbage();
    RawInput raw;
    for (const auto vertex : mesh.vertices()) {
        const auto& p = mesh.point(vertex);
        raw.points.push_back({p.x(), p.y(), p.z()});
    }
    for (const auto face : mesh.faces()) {
        std::array<std::uint32_t, 3> corners{};
        auto corner = corners.begin();
        for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face))) *corner++ = vertex.idx();
        raw.triangles.push_back(corners);
    }
    return raw;
}

}  // namespace peers
