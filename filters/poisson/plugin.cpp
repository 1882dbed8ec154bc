// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "poisson/poisson.hpp"
#include "scanmill/geometry/mesh/handles.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = PoissonParams;
    return Declare<P>("poisson", 5)
        .summary("Makes a surface of points with normals, also where points are missing.")
        .source("Kazhdan, Hoppe 2013, Screened Poisson surface reconstruction; by PCL")
        .ties(
            "Among vertices of equal density, the lower row is removed first. A vertex at exactly `max-distance` "
            "stays.")
        .not_finite(
            "Coordinates: refused; the message gives their number and the first one. Normals: the point is not used, "
            "with a warning.")
        .adds({"density"})
        .in<PointCloud>("points",
                        "Points with finite coordinates and the column `normal`: vectors of any length above 0 that "
                        "point outwards. At least 4 different positions that are not on one line are needed.")
        .out<TriangleMesh>("mesh",
                           "The surface, with the vertex column `density`: about 1 where points are as dense as usual, "
                           "1/100 where they are ten times as far away.")
        .param("depth", &P::depth,
               "The octree has at most 2^depth cells along the edge of its cube. Raising the depth by 1 halves the "
               "cells and takes up to four times the time and memory.",
               at_least(3), at_most(12))
        .param("scale", &P::scale,
               "Edge of the octree's cube, as a multiple of the longest side of the points' box. A larger cube closes "
               "gaps that face its sides, but has larger cells at equal `depth`.",
               above(1), at_most(10))
        .param("trim", &P::trim, "Share of the vertices to remove, those of least density first; 0 keeps all.",
               at_least(0), below(1))
        .param("max-distance", &P::max_distance,
               "Vertices farther than this from every point are removed, too; with `none`, distance removes no vertex.",
               above(0), word("none"))
        .metric("triangles", Unit::count, "Triangles of the surface.")
        .metric("trimmed", Unit::count, "Vertices removed by `trim` and `max-distance`.")
        .metric("invented", Unit::ratio,
                "Share of the area that is farther from the nearest point than twice the distance from that point to "
                "its 8th neighbour.",
                headline, smaller_is_better)
        .metric("missed", Unit::ratio,
                "Share of the points that are farther from the surface than two cells and than twice the distance to "
                "their 8th neighbour.",
                headline, smaller_is_better)
        .metric("against", Unit::ratio,
                "Share of the vertices where the surface faces away from the normals of the nearest points.", headline,
                smaller_is_better)
        .metric("without-normal", Unit::count, "Points that are not used, because their normal is 0 or NaN.",
                smaller_is_better)
        .metric("cracks", Unit::count, "Holes of a few edges that PCL leaves in the surface and that were filled.")
        .metric("loops", Unit::count, "Boundary loops of the surface.", headline)
        .metric("cell", Unit::length, "Edge of the smallest cell that the octree may have.")
        .doubts({"more than 5 % of the area is far from all points",
                 "more than 5 % of the points are far from the surface",
                 "at more than 5 % of the vertices the surface faces away from the normals of the nearest points",
                 sign_of_doubtful_handles})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("mesh", poisson(inputs.get<PointCloud>("points"), params, context).mesh);
        });
}
