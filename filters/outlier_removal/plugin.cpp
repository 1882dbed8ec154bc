// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "outlier_removal/outlier_removal.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = OutlierRemovalParams;
    return Declare<P>("outlier-removal", 3)
        .summary("Removes points that are far from all others, in small groups, scattered, or above the surface.")
        .source("Rusu, Marton, Blodow, Dolha, Beetz 2008; Breunig, Kriegel, Ng, Sander 2000")
        .ties("Points at a limit pass. Of equally near points, the lower in order of x, then y, then z is nearer.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"outlier"})
        .in<PointCloud>("points", "Finite coordinates; every column is carried along.")
        .out<PointCloud>("points",
                         "The kept points, in input order. With `mark`, all points with the column `outlier`: 0 for "
                         "kept points, 1 for outliers.")
        .choice("method", &P::method,
                {{"statistical", P::Method::statistical,
                  "Suspects have a mean distance to their nearest points that is far above that of these points: by "
                  "`factor` robust standard deviations of the logarithm. With `min-component: 0`: above the mean of "
                  "all points plus `factor` standard deviations."},
                 {"radius", P::Method::radius, "Suspects have fewer than `neighbours` other points within `radius`."}},
                "The test that finds suspects. A suspect is removed if it is not connected to the scan.")
        .param("neighbours", &P::neighbours,
               "Number of nearest other points; duplicates count, the point itself does not.", at_least(1),
               at_most(1000))
        .param("factor", &P::factor,
               "Number of standard deviations that `method: statistical` tolerates. A higher factor removes fewer "
               "points.",
               above(0))
        .param("radius", &P::radius,
               "Points at most this far from each other are connected; with `method: radius` also the radius of the "
               "test. `3 spacing` is three times the median distance from a position to the nearest other one.",
               at_least(0), takes_spacings)
        .param("min-component", &P::min_component,
               "Connected components with less than this share of the distinct positions, and of the area, are "
               "removed; 0 removes all suspects instead, as PCL does.",
               at_least(0), at_most(1))
        .param("mark", &P::mark, "Keeps all points and adds the column `outlier`.")
        .metric("kept", Unit::count, "Points that are not outliers.")
        .metric("removed", Unit::count, "Points that are outliers, also if they are only marked.", headline)
        .metric("suspects", Unit::count, "Points that failed the test, removed or not.")
        .metric("limit", Unit::length,
                "Largest distance that passes the test, with `min-component: 0` or `method: radius`.")
        .metric("log-limit", Unit::number,
                "Largest logarithm that passes the test otherwise: of a mean distance over that of its neighbours.")
        .metric("hovering", Unit::count, "Suspects that hover above the surface; none with `min-component: 0`.")
        .metric("scattered", Unit::count,
                "Points in clusters that are scattered over a volume; none with `min-component: 0`.")
        .metric("components", Unit::count, "Connected components that are kept; none with `min-component: 0`.")
        .doubts({"more than 10 % of the points are outliers",
                 "the outliers cover more than 10 % of the area of the surface"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", outlier_removal(inputs.get<PointCloud>("points"), params, context).points);
        });
}
