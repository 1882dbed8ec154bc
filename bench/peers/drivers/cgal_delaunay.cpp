// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/bounding_box.h>
#include <tbb/global_control.h>

#include <optional>

#include "cgal_jobs.hpp"

namespace peers {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Sequential = CGAL::Delaunay_triangulation_3<Kernel>;
using Structure =
    CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_3<Kernel>,
                                         CGAL::Delaunay_triangulation_cell_base_3<Kernel>, CGAL::Parallel_tag>;
using Parallel = CGAL::Delaunay_triangulation_3<Kernel, Structure>;

std::vector<Kernel::Point_3> points_of(const RawInput& input) {
    std::vector<Kernel::Point_3> points;
    points.reserve(input.points.size());
    for (const auto& [x, y, z] : input.points) points.emplace_back(x, y, z);
    return points;
}

template <class Triangulation>
Json facts(double seconds, const Triangulation& triangulation) {
    return {{"seconds", seconds},
            {"cells", triangulation.number_of_finite_cells()},
            {"vertices", triangulation.number_of_vertices()}};
}

/// As in CGAL's manual: a grid of locks over the bounding box, with 50 boxes per axis.
Json in_parallel(const std::vector<Kernel::Point_3>& points, unsigned threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::optional<Parallel::Lock_data_structure> locks;
    std::optional<Parallel> triangulation;
    const double seconds = seconds_of([&] {
        locks.emplace(CGAL::bounding_box(points.begin(), points.end()).bbox(), 50);
        triangulation.emplace(points.begin(), points.end(), &*locks);
    });
    return facts(seconds, *triangulation);
}

}  // namespace

Json delaunay(const RawInput& input, const Json& request) {
    const std::vector<Kernel::Point_3> points = points_of(input);
    if (request.value("parallel", false)) return in_parallel(points, threads_of(request));
    std::optional<Sequential> triangulation;
    const double seconds = seconds_of([&] { triangulation.emplace(points.begin(), points.end()); });
    return facts(seconds, *triangulation);
}

}  // namespace peers
