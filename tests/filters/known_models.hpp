// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The well-known models, and CGAL's test of their reconstructions.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include "scanmill/data/mesh.hpp"
#include "support/known_models.hpp"

namespace scanmill::test {

/// What CGAL says.
inline bool intersects_itself(const TriangleMesh& mesh) {
    CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3> surface;
    using Vertex = decltype(surface)::Vertex_index;
    for (const Vec3& p : mesh.positions) surface.add_vertex({p.x(), p.y(), p.z()});
    for (const auto& [a, b, c] : mesh.triangles)
        if (surface.add_face(Vertex(a), Vertex(b), Vertex(c)) == decltype(surface)::null_face()) return true;
    return CGAL::Polygon_mesh_processing::does_self_intersect(surface);
}

}  // namespace scanmill::test
