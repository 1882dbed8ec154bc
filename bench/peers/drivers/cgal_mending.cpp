// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include "cgal_mesh.hpp"

namespace peers {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace processing = CGAL::Polygon_mesh_processing;

}  // namespace

Json fill_holes(const RawInput& input, const Json&) {
    Mesh mesh;
    const double seconds = seconds_of([&] {
        mesh = mesh_of<Kernel>(input);
        std::vector<Mesh::Halfedge_index> cycles;
        processing::extract_boundary_cycles(mesh, std::back_inserter(cycles));
        for (const Mesh::Halfedge_index cycle : cycles) {
            std::vector<Mesh::Face_index> faces;
            std::vector<Mesh::Vertex_index> vertices;
            processing::triangulate_refine_and_fair_hole(mesh, cycle, std::back_inserter(faces),
                                                         std::back_inserter(vertices));
        }
    });
    const RawInput result = raw_of(mesh);
    return {{"seconds", seconds},
            {"boundary_edges", boundary_edges(result.triangles)},
            {"triangles", result.triangles.size()},
            {"volume", enclosed_volume(result.points, result.triangles)}};
}

Json repair(const RawInput& input, const Json&) {
    std::vector<Kernel::Point_3> points;
    for (const auto& [x, y, z] : input.points) points.emplace_back(x, y, z);
    std::vector<std::vector<std::size_t>> polygons;
    for (const auto& [a, b, c] : input.triangles) polygons.push_back({a, b, c});
    const double seconds = seconds_of([&] {
        processing::repair_polygon_soup(points, polygons);
        processing::orient_polygon_soup(points, polygons);
    });
    RawInput result;
    for (const Kernel::Point_3& p : points) result.points.push_back({p.x(), p.y(), p.z()});
    for (const std::vector<std::size_t>& polygon : polygons)
        result.triangles.push_back({static_cast<std::uint32_t>(polygon[0]), static_cast<std::uint32_t>(polygon[1]),
                                    static_cast<std::uint32_t>(polygon[2])});
    return {{"seconds", seconds},
            {"points", points.size()},
            {"boundary_edges", boundary_edges(result.triangles)},
            {"enclosed", std::abs(enclosed_volume(result.points, result.triangles))}};
}

}  // namespace peers
