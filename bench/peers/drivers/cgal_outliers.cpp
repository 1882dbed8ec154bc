// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Simple_cartesian.h>
#include <CGAL/remove_outliers.h>
#include <tbb/global_control.h>

#include "cgal_jobs.hpp"

namespace peers {

Json remove_outliers(const RawInput& input, const Json& request) {
    using Kernel = CGAL::Simple_cartesian<double>;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads_of(request));
    std::vector<Kernel::Point_3> points;
    points.reserve(input.points.size());
    for (const auto& [x, y, z] : input.points) points.emplace_back(x, y, z);
    const double seconds = seconds_of([&] {
        const auto removed = CGAL::remove_outliers<CGAL::Parallel_tag>(
            points, request.at("neighbours").get<unsigned>(),
            CGAL::parameters::threshold_percent(request.at("percent").get<double>()));
        points.erase(removed, points.end());
    });
    return {{"seconds", seconds}, {"kept", points.size()}};
}

}  // namespace peers
