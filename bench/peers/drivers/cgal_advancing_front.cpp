// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>

#include "cgal_jobs.hpp"

namespace peers {

Json advancing_front(const RawInput& input, const Json&) {
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
    std::vector<Point> points;
    points.reserve(input.points.size());
    for (const auto& [x, y, z] : input.points) points.emplace_back(x, y, z);
    std::vector<std::array<std::size_t, 3>> triangles;
    const double seconds = seconds_of([&] {
        CGAL::advancing_front_surface_reconstruction(points.begin(), points.end(), std::back_inserter(triangles));
    });
    std::vector<bool> used(points.size(), false);
    for (const auto& triangle : triangles)
        for (const std::size_t corner : triangle) used[corner] = true;
    return {
        {"seconds", seconds}, {"triangles", triangles.size()}, {"unused", std::count(used.begin(), used.end(), false)}};
}

}  // namespace peers
