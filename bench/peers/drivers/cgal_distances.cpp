// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>

#include "cgal_jobs.hpp"

namespace peers {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

}  // namespace

Json distances(const RawInput& mesh, const RawInput& points, const Json&) {
    Triangles triangles;
    for (const auto& [a, b, c] : mesh.triangles)
        triangles.emplace_back(point(mesh.points[a]), point(mesh.points[b]), point(mesh.points[c]));
    std::vector<double> found(points.points.size());
    Tree tree;
    const double building = seconds_of([&] {
        tree.insert(triangles.begin(), triangles.end());
        tree.build();
        tree.accelerate_distance_queries();
    });
    const double asking = seconds_of([&] {
        std::ranges::transform(points.points, found.begin(),
                               [&](const auto& p) { return std::sqrt(tree.squared_distance(point(p))); });
    });
    double sum = 0, squares = 0;
    for (const double distance : found) sum += distance, squares += distance * distance;
    const auto count = static_cast<double>(found.size());
    return {{"seconds", building + asking},
            {"building_seconds", building},
            {"mean", sum / count},
            {"rms", std::sqrt(squares / count)},
            {"max", *std::ranges::max_element(found)}};
}

}  // namespace peers
