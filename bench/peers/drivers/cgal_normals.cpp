// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/jet_smooth_point_set.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <tbb/global_control.h>

#include <cmath>

#include "cgal_jobs.hpp"

namespace peers {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Oriented_points = std::vector<std::pair<Kernel::Point_3, Kernel::Vector_3>>;

Oriented_points points_of(const RawInput& input) {
    Oriented_points points;
    for (const auto& [x, y, z] : input.points) points.emplace_back(Kernel::Point_3(x, y, z), Kernel::Vector_3());
    return points;
}

auto maps() {
    return CGAL::parameters::point_map(CGAL::First_of_pair_property_map<Oriented_points::value_type>())
        .normal_map(CGAL::Second_of_pair_property_map<Oriented_points::value_type>());
}

tbb::global_control limit_of(const Json& request) {
    return {tbb::global_control::max_allowed_parallelism, threads_of(request)};
}

}  // namespace

Json normals(const RawInput& input, const Json& request) {
    const tbb::global_control limit = limit_of(request);
    const auto neighbours = request.at("neighbours").get<unsigned>();
    const bool jet = request.value("jet", false), oriented = request.value("oriented", false);
    Oriented_points points = points_of(input);
    const double seconds = seconds_of([&] {
        if (jet)
            CGAL::jet_estimate_normals<CGAL::Parallel_tag>(points, neighbours, maps());
        else
            CGAL::pca_estimate_normals<CGAL::Parallel_tag>(points, neighbours, maps());
        if (oriented) CGAL::mst_orient_normals(points, neighbours, maps());
    });
    Vectors at, directions_at;  // mst_orient_normals reorders the points
    for (const auto& [p, n] : points) {
        at.push_back({p.x(), p.y(), p.z()});
        directions_at.push_back({n.x(), n.y(), n.z()});
    }
    Json answer = directions(request, at, directions_at);
    answer["seconds"] = seconds;
    return answer;
}

Json smooth(const RawInput& input, const Json& request) {
    const tbb::global_control limit = limit_of(request);
    Oriented_points points = points_of(input);
    const double seconds = seconds_of([&] {
        CGAL::jet_smooth_point_set<CGAL::Parallel_tag>(points, request.at("neighbours").get<unsigned>(), maps());
    });
    double squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& [x, y, z] = input.points[i];
        squares += (points[i].first - Kernel::Point_3(x, y, z)).squared_length();
    }
    return {{"seconds", seconds}, {"moved_rms", std::sqrt(squares / static_cast<double>(points.size()))}};
}

}  // namespace peers
