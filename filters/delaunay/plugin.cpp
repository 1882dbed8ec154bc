// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/delaunay.hpp"
#include "scanmill/filter/plugin.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = DelaunayParams;
    return Declare<P>("delaunay", 1)
        .summary("Tetrahedralises the points so that no point lies inside the circumsphere of a cell.")
        .source("Delaunay 1934; Bernardini, Bajaj, Chen, Schikore 1997, section 3")
        .in<PointCloud>("points", "Finite coordinates, at least 4 points that are not coplanar; every column is carried.")
        .out<TetMesh>("tets", "The cells over the distinct points, in an order that depends on the points alone.")
        .metric("cells", Unit::count, "Finite tetrahedra.")
        .metric("duplicates", Unit::count, "Points merged into an earlier one with the same three coordinates.")
        .metric("hidden", Unit::count, "Points that are no vertex of the result; none without weights.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("tets", delaunay(inputs.get<PointCloud>("points"), params, context).tets);
        });
}
