// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "cgal_jobs.hpp"

namespace peers {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace simplification = CGAL::Surface_mesh_simplification;

/// A Surface_mesh is an oriented manifold, so vertices and edges where `raw` is not manifold are duplicated.
Mesh mesh_of(const RawInput& raw) {
    namespace processing = CGAL::Polygon_mesh_processing;
    std::vector<Kernel::Point_3> points;
    for (const auto& [x, y, z] : raw.points) points.emplace_back(x, y, z);
    std::vector<std::array<std::size_t, 3>> triangles;
    for (const auto& [a, b, c] : raw.triangles) triangles.push_back({a, b, c});
    processing::orient_polygon_soup(points, triangles);
    Mesh mesh;
    processing::polygon_soup_to_polygon_mesh(points, triangles, mesh);
    return mesh;
}

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

struct Few_faces {
    std::size_t wanted;

    template <class Cost, class Profile>
    bool operator()(const Cost&, const Profile& profile, std::size_t, std::size_t) const {
        return profile.surface_mesh().number_of_faces() <= wanted;
    }
};

}  // namespace

Json decimate(const RawInput& input, const Json& request) {
    using Policies = simplification::GarlandHeckbert_plane_policies<Mesh, Kernel>;
    using Placement = simplification::Bounded_normal_change_placement<Policies::Get_placement>;
    Mesh mesh = mesh_of(input);
    const Few_faces stop{request.at("triangles").get<std::size_t>()};
    const double seconds = seconds_of([&] {
        Policies policies(mesh);
        const Policies::Get_cost& cost = policies.get_cost();
        const Placement placement(policies.get_placement());
        simplification::edge_collapse(mesh, stop, CGAL::parameters::get_cost(cost).get_placement(placement));
    });
    const RawInput result = raw_of(mesh);
    if (request.contains("into")) write_raw(request["into"], result);
    return {{"seconds", seconds}, {"triangles", result.triangles.size()}};
}

}  // namespace peers
