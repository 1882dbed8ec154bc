// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "smooth/smooth.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = SmoothParams;
    return Declare<P>("smooth", 1)
        .summary("Moves the points of a noisy scan onto the surface that their neighbours form.")
        .source("Cazals, Pouget 2005 for `jet`; Alexa and others 2003 for `mls`")
        .ties(
            "Among equally near points, the lower by x, then y, then z counts as nearer. A point at exactly `radius` "
            "is not a neighbour.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"moved"})
        .in<PointCloud>("points", "Finite coordinates; every column is carried along.")
        .out<PointCloud>(
            "points",
            "The same rows at new positions, with the column `moved`: how far a point moved, in the scan's "
            "unit.")
        .choice("method", &P::method,
                {{"jet", P::Method::jet, "All neighbours have the same weight."},
                 {"mls", P::Method::mls,
                  "Near neighbours have more weight (moving least squares): more details stay, but also more noise."}},
                "Weights of the neighbours when a polynomial of degree two is fitted to them.")
        .param("neighbours", &P::neighbours,
               "Number of nearest other positions. The point itself counts in addition; its duplicates do not count.",
               at_least(5), at_most(1000), unless_given("radius"))
        .param("radius", &P::radius,
               "The neighbours are all other positions nearer than this, however many. With `auto`, they are the "
               "`neighbours` nearest positions.",
               above(0), word("auto"))
        .metric("moved-rms", Unit::length, "Root of the mean square of the distances that points moved.", headline)
        .metric("moved-max", Unit::length, "The longest distance that a point moved.", headline)
        .metric("flat", Unit::count, "Points whose neighbours determine no polynomial; they moved onto their plane.")
        .doubts({"the neighbours of most points form no surface: they deviate by more than 25 % of their distance"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", smooth(inputs.get<PointCloud>("points"), params, context).points);
        });
}
