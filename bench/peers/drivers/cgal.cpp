// SPDX-License-Identifier: GPL-3.0-or-later
/// The CGAL driver.

#include <CGAL/version.h>

#include "cgal_jobs.hpp"

int main() {
    using namespace peers;
    RawInput input, points;
    const auto of_input = [&input](Json (*job)(const RawInput&, const Json&)) {
        return [&input, job](const Json& request) { return job(input, request); };
    };
    const auto load = [&](const Json& request) {
        input = read_raw(request.at("path"));
        if (request.contains("points")) points = read_raw(request["points"]);
        return input.counts();
    };
    return answer({{"load", load},
                   {"delaunay", of_input(delaunay)},
                   {"regular", of_input(regular)},
                   {"fixed-alpha-shape", of_input(fixed_alpha_shape)},
                   {"optimal-alpha-shape", of_input(optimal_alpha_shape)},
                   {"advancing-front", of_input(advancing_front)},
                   {"remove-outliers", of_input(remove_outliers)},
                   {"normals", of_input(normals)},
                   {"smooth", of_input(smooth)},
                   {"fill-holes", of_input(fill_holes)},
                   {"repair", of_input(repair)},
                   {"decimate", of_input(decimate)},
                   {"distances", [&](const Json& request) { return distances(input, points, request); }}},
                  {{"CGAL", CGAL_VERSION_STR}});
}
