// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "delaunay/delaunay.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = DelaunayParams;
    return Declare<P>("delaunay", 1)
        .summary("Tetrahedralises the points so that no point lies inside the circumsphere of any cell.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 3")
        .ties(
            "Ties between points on one empty sphere are broken by a symbolic perturbation of their coordinates, which "
            "does not depend on their order. Of duplicates, the first is kept with the largest of their weights.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"hidden"})
        .in<PointCloud>(
            "points",
            "Finite coordinates, at least 4 distinct points that are not coplanar; every column is carried along.")
        .out<TetMesh>("tets", "The cells over the distinct points, in canonical order.")
        .param("weights", &P::weights,
               "Adapts the cells to the local density of the sampling. `none` gives no weights; `spacing` gives every "
               "point the square of its mean distance to its neighbours as weight; any other word is the name of a "
               "column of squared lengths in the scan's unit. A column called `none` or `spacing` must be renamed in "
               "the file before it can be used.",
               word("none"))
        .param("factor", &P::factor, "The weights are multiplied by this; with `spacing` at most 4.", at_least(0))
        .metric("cells", Unit::count, "Finite tetrahedra.")
        .metric("duplicates", Unit::count,
                "Points that were merged into an earlier point at exactly the same position.")
        .metric("hidden", Unit::count, "Distinct points in no cell, because weights hide them; they are kept.",
                smaller_is_better)
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("tets", delaunay(inputs.get<PointCloud>("points"), params, context).tets);
        });
}
