// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "outlier_removal/outlier_removal.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = OutlierRemovalParams;
    return Declare<P>("outlier-removal", 1)
        .summary("Removes points that are far from all others, in small groups, or hover above the surface.")
        .source("Rusu, Marton, Blodow, Dolha, Beetz 2008, section 4.1")
        .ties("Points at a limit pass. Of equally near points, the lower in order of x, then y, then z is nearer.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"outlier"})
        .in<PointCloud>("points", "Finite coordinates; every column is carried along.")
        .out<PointCloud>("points",
                         "The kept points, in input order. With `mark`, all points with the column `outlier`: 0 for "
                         "kept points, 1 for outliers.")
        .choice("method", &P::method,
                {{"statistical", P::Method::statistical,
                  "Suspects have a mean distance to their nearest points above the mean plus `factor` standard "
                  "deviations."},
                 {"radius", P::Method::radius, "Suspects have fewer than `neighbours` other points within `radius`."}},
                "The test that finds suspects. A suspect is removed if it is not connected to the scan.")
        .param("neighbours", &P::neighbours,
               "Number of nearest other points; duplicates count, the point itself does not.", at_least(1),
               at_most(1000))
        .param("factor", &P::factor,
               "With `method: statistical`, the number of standard deviations by which the mean distance of a point "
               "may exceed the mean of all points. A higher factor removes fewer points.",
               above(0))
        .param("radius", &P::radius,
               "Points at most this far from each other are connected; with `method: radius` also the radius of the "
               "test. `3 spacing` is three times the median distance from a position to the nearest other one.",
               at_least(0), takes_spacings)
        .param("min-component", &P::min_component,
               "Connected components with fewer than this share of the distinct positions are removed; 0 removes all "
               "suspects instead, as PCL does.",
               at_least(0), at_most(1))
        .param("mark", &P::mark, "Keeps all points and adds the column `outlier`.")
        .metric("kept", Unit::count, "Points that are not outliers.")
        .metric("removed", Unit::count, "Points that are outliers, also if they are only marked.", headline)
        .metric("suspects", Unit::count, "Points that failed the test, removed or not.")
        .metric("limit", Unit::length, "Largest distance that passes the test.")
        .metric("hovering", Unit::count, "Suspects that hover above the surface; none with `min-component: 0`.")
        .metric("components", Unit::count, "Connected components that are kept; none with `min-component: 0`.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", outlier_removal(inputs.get<PointCloud>("points"), params, context).points);
        });
}
