// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "plate_corners/plate_corners.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = PlateCornersParams;
    return Declare<P>("plate-corners", 2)
        .summary("Finds the four corners of a rectangular plate in a scan.")
        .source("Wang 2006, chapter 5; Fischler and Bolles 1981")
        .ties("Among equally good planes or lines, the first in the order of the random samples counts.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"normal"})
        .in<PointCloud>("points", "A scan of the plate; a part may stand on it.")
        .out<PointCloud>("points",
                         "The four corners, counter-clockwise seen from above, with the column `normal`: the normal of "
                         "the upper side.")
        .param("sides", &P::sides,
               "The two known side lengths of the plate. If given, the corners form a rectangle of this size.", size(2),
               above(0))
        .param("tolerance", &P::tolerance, "The largest distance of the plate's points from its plane.", above(0))
        .param("up", &P::up, "Direction in which the plate's upper side faces; used if the points have no normals.",
               size(3))
        .metric("residual", Unit::length, "Distance of the points at the border from the sides, root mean square.",
                headline, smaller_is_better)
        .metric("flatness", Unit::length, "Distance of the plate's points from its plane, root mean square.",
                smaller_is_better)
        .metric("side-1", Unit::length, "Found length of the side from the first to the second corner.", headline)
        .metric("side-2", Unit::length, "Found length of the side from the second to the third corner.", headline)
        .metric("plane-points", Unit::count, "Points on the plate's plane.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", plate_corners(inputs.get<PointCloud>("points"), params, context).corners);
        });
}
