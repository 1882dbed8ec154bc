// SPDX-License-Identifier: GPL-3.0-or-later
/// CGAL takes squared radii. The boundaries of the shapes are counted after the timed work.

#include <CGAL/Alpha_shape_3.h>
#include <CGAL/Alpha_shape_cell_base_3.h>
#include <CGAL/Alpha_shape_vertex_base_3.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Fixed_alpha_shape_3.h>
#include <CGAL/Fixed_alpha_shape_cell_base_3.h>
#include <CGAL/Fixed_alpha_shape_vertex_base_3.h>

#include <cmath>
#include <optional>
#include <unordered_set>

#include "cgal_jobs.hpp"

namespace peers {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

template <class VertexBase, class CellBase>
using Triangulation =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;
using Fixed = CGAL::Fixed_alpha_shape_3<
    Triangulation<CGAL::Fixed_alpha_shape_vertex_base_3<Kernel>, CGAL::Fixed_alpha_shape_cell_base_3<Kernel>>>;
using Family =
    CGAL::Alpha_shape_3<Triangulation<CGAL::Alpha_shape_vertex_base_3<Kernel>, CGAL::Alpha_shape_cell_base_3<Kernel>>>;

std::vector<Kernel::Point_3> points_of(const RawInput& input) {
    std::vector<Kernel::Point_3> points;
    points.reserve(input.points.size());
    for (const auto& [x, y, z] : input.points) points.emplace_back(x, y, z);
    return points;
}

/// Facets with the shape's interior on exactly one side.
template <class Shape>
std::size_t regular_facets(const Shape& shape) {
    std::size_t count = 0;
    for (const auto& facet : shape.finite_facets())
        if (shape.classify(facet) == Shape::REGULAR) ++count;
    return count;
}

/// All cells that are reachable from the unbounded cells through facets outside the shape.
std::unordered_set<const void*> outside(const Fixed& shape) {
    std::vector<Fixed::Cell_handle> to_visit{shape.infinite_cell()};
    std::unordered_set<const void*> reached{&*to_visit.back()};
    while (!to_visit.empty()) {
        const Fixed::Cell_handle cell = to_visit.back();
        to_visit.pop_back();
        for (int i = 0; i < 4; ++i) {
            const Fixed::Cell_handle next = cell->neighbor(i);
            const Fixed::Facet facet(cell, i);
            const bool wall = !shape.is_infinite(facet) && shape.classify(facet) != Fixed::EXTERIOR;
            if (!wall && reached.insert(&*next).second) to_visit.push_back(next);
        }
    }
    return reached;
}

/// Number of boundary triangles of the solid that alpha-solid delivers: all cells that are unreachable from outside.
std::size_t solid_triangles(const Fixed& shape) {
    const std::unordered_set<const void*> reached = outside(shape);
    std::size_t count = 0;
    for (const Fixed::Facet& facet : shape.finite_facets()) {
        const bool one = reached.contains(&*facet.first),
                   other = reached.contains(&*facet.first->neighbor(facet.second));
        count += one != other;
    }
    return count;
}

}  // namespace

Json fixed_alpha_shape(const RawInput& input, const Json& request) {
    const std::vector<Kernel::Point_3> points = points_of(input);
    const double alpha = request.at("alpha");
    std::optional<Fixed> shape;
    const double seconds = seconds_of([&] { shape.emplace(points.begin(), points.end(), alpha * alpha); });
    return {{"seconds", seconds}, {"triangles", solid_triangles(*shape)}, {"regular_facets", regular_facets(*shape)}};
}

Json optimal_alpha_shape(const RawInput& input, const Json&) {
    const std::vector<Kernel::Point_3> points = points_of(input);
    std::optional<Family> shape;
    const double seconds = seconds_of([&] {
        shape.emplace(points.begin(), points.end());
        shape->set_alpha(*shape->find_optimal_alpha(1));
    });
    return {{"seconds", seconds}, {"alpha", std::sqrt(shape->get_alpha())}, {"regular_facets", regular_facets(*shape)}};
}

}  // namespace peers
