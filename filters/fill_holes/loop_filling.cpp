// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill_holes/loop_filling.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>
#include <functional>
#include <iterator>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace CGAL::CommonKernelFunctors {

/// CGAL's formula, but with an arctangent that gives the same bits on every processor. CGAL chooses triangulations by
/// these angles.
template <>
inline double Compute_approximate_dihedral_angle_3<Epick>::operator()(const Point_3& a, const Point_3& b,
                                                                      const Point_3& c, const Point_3& d) const {
    const auto ab = b - a, ac = c - a, ad = d - a, across = cross_product(ab, ad);
    const double cosine = cross_product(ab, ac) * across, sine = std::sqrt(ab.squared_length()) * (ac * across);
    return std::copysign(scanmill::angle_of(cosine, std::abs(sine)), sine) * 180 / CGAL_PI;
}

}  // namespace CGAL::CommonKernelFunctors

namespace scanmill {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace processing = CGAL::Polygon_mesh_processing;

/// Largest loop for which CGAL searches all triangulations. The search takes 0.1 s with 200 vertices, and its time
/// grows with their cube.
constexpr std::size_t most_vertices_of_all = 200;

struct Cancellation : processing::Hole_filling::Default_visitor {
    explicit Cancellation(const Execution& of) : execution(&of) {}
    void quadratic_step() const { execution->check_cancelled(); }
    void cubic_step() const { execution->check_cancelled(); }
    const Execution* execution;
};

/// Builds CGAL's mesh. Returns its half-edge in the gap, opposite to the half-edge `loop`.
Mesh::Halfedge_index build(const LoopSurroundings& from, Mesh& mesh) {
    std::vector<Mesh::Vertex_index> vertices;
    for (const Vec3& p : from.positions) vertices.push_back(mesh.add_vertex(Kernel::Point_3(p.x(), p.y(), p.z())));
    const auto start = [&](u32 h) { return vertices[from.triangles[h / 3][h % 3]]; };
    const u32 count = static_cast<u32>(3 * from.triangles.size());
    std::vector<Mesh::Halfedge_index> inner(count), gap(count);
    for (u32 h = 0; h < count; ++h) {
        const u32 other = from.opposite[h];
        if (other != half_edges::boundary && other < h) continue;
        const Mesh::Halfedge_index one = mesh.add_edge(start(h), start(half_edges::after(h)));
        inner[h] = one;
        (other == half_edges::boundary ? gap[h] : inner[other]) = mesh.opposite(one);
    }
    for (u32 t = 0; t < from.triangles.size(); ++t) {
        const Mesh::Face_index face = mesh.add_face();
        mesh.set_halfedge(face, inner[3 * t]);
        for (u32 h = 3 * t; h < 3 * t + 3; ++h) {
            mesh.set_face(inner[h], face);
            mesh.set_next(inner[h], inner[half_edges::after(h)]);
            mesh.set_halfedge(start(half_edges::after(h)), inner[h]);
        }
    }
    for (u32 h = 0; h < count; ++h) {
        if (from.opposite[h] != half_edges::boundary) continue;
        mesh.set_next(gap[h], gap[from.before_on_boundary[h]]);
        mesh.set_halfedge(start(h), gap[h]);
    }
    return gap[from.loop];
}

}  // namespace

LoopFilling fill_loop(const LoopSurroundings& surroundings, FillingStage stage, const Execution& execution) {
    Mesh mesh;
    const Mesh::Halfedge_index gap = build(surroundings, mesh);
    std::size_t loop_size = 0;
    for (Mesh::Halfedge_index h = gap; loop_size == 0 || h != gap; h = mesh.next(h)) ++loop_size;
    Cancellation visitor(execution);
    std::vector<Mesh::Face_index> faces;
    processing::triangulate_hole(
        mesh, gap, std::back_inserter(faces),
        CGAL::parameters::visitor(std::ref(visitor)).do_not_use_cubic_algorithm(loop_size > most_vertices_of_all));
    LoopFilling filling;
    if (faces.empty()) return filling;
    std::vector<Mesh::Vertex_index> vertices;
    if (stage >= FillingStage::refined) {
        execution.check_cancelled();
        std::vector<Mesh::Face_index> divided;
        processing::refine(mesh, faces, std::back_inserter(divided), std::back_inserter(vertices));
    }
    if (stage >= FillingStage::faired && !vertices.empty()) {
        execution.check_cancelled();
        if (!processing::fair(mesh, vertices)) return filling;
    }
    for (std::size_t v = surroundings.positions.size(); v < mesh.number_of_vertices(); ++v) {
        const Kernel::Point_3& p = mesh.point(Mesh::Vertex_index(static_cast<u32>(v)));
        filling.positions.emplace_back(p.x(), p.y(), p.z());
        if (!filling.positions.back().allFinite()) return {};
    }
    for (std::size_t f = surroundings.triangles.size(); f < mesh.number_of_faces(); ++f) {
        const Mesh::Halfedge_index h = mesh.halfedge(Mesh::Face_index(static_cast<u32>(f)));
        filling.triangles.push_back({mesh.source(h), mesh.target(h), mesh.target(mesh.next(h))});
    }
    return filling;
}

}  // namespace scanmill
