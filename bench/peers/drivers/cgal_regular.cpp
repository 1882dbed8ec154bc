// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>

#include <optional>
#include <stdexcept>

#include "cgal_jobs.hpp"

namespace peers {

Json regular(const RawInput& input, const Json&) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Triangulation = CGAL::Regular_triangulation_3<Kernel>;
    if (input.weights.size() != input.points.size()) throw std::runtime_error("the points have no weights");
    std::vector<Triangulation::Weighted_point> points;
    for (std::size_t i = 0; i < input.points.size(); ++i) {
        const auto& [x, y, z] = input.points[i];
        points.emplace_back(Kernel::Point_3(x, y, z), input.weights[i]);
    }
    std::optional<Triangulation> triangulation;
    const double seconds = seconds_of([&] { triangulation.emplace(points.begin(), points.end()); });
    return {{"seconds", seconds}, {"cells", triangulation->number_of_finite_cells()}};
}

}  // namespace peers
