// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "cgal_mesh.hpp"

namespace peers {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace simplification = CGAL::Surface_mesh_simplification;

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
    Mesh mesh = mesh_of<Kernel>(input);
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
