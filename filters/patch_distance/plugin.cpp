// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "patch_distance/patch_distance.hpp"

using namespace scanmill;

namespace {

struct PatchDistanceParams {};

}  // namespace

SCANMILL_FILTER() {
    return Declare<PatchDistanceParams>("patch-distance", 5)
        .summary("Signed distance of points to the surface of A-patches.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 5")
        .ties(
            "If parts of the surface are equally near, the part with the nearer triangle of the tessellation counts. "
            "If these triangles are equally near, the one with the lower row counts.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"distance-to-patches"})
        .in<PatchComplex>("patches", "The surface.")
        .in<PointCloud>("points", "The points to measure.")
        .out<PointCloud>("points",
                         "All points, with the column `distance-to-patches`: positive outside, negative inside, NaN "
                         "for points without a distance.")
        .metric("rms", Unit::length, "Root of the mean squared distance.", headline, smaller_is_better)
        .metric("p95", Unit::length, "95 % quantile of the distances without sign.", smaller_is_better)
        .metric("max", Unit::length, "Largest distance without sign.", headline, smaller_is_better)
        .metric("unlocated", Unit::count,
                "Points without a distance: far from the surface, or nearest to its boundary.", smaller_is_better)
        .run([](const Inputs& inputs, const PatchDistanceParams&, Context& context) {
            return Outputs().set(
                "points",
                patch_distance(inputs.get<PatchComplex>("patches"), inputs.get<PointCloud>("points"), context).points);
        });
}
