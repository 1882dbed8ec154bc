// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "normals/normals.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = NormalsParams;
    return Declare<P>("normals", 4)
        .summary("Estimates the normal at every point, and turns it to the outside.")
        .source("Hoppe, DeRose, Duchamp, McDonald, Stuetzle 1992; Cazals, Pouget 2005 for `jet`")
        .ties(
            "Of equally near points, the lower in order of x, then y, then z is nearer. Of equal links of the tree, "
            "the one to the lower point comes first.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"normal"})
        .in<PointCloud>("points",
                        "Finite coordinates, at least 3 different positions; every column is carried along. The column "
                        "`approach`, 3 numbers, is a direction from the point to the scanner.")
        .out<PointCloud>(
            "points",
            "The same points with the column `normal`, of unit length; with `orient: known` and no scanner, the "
            "input as it is.")
        .choice("method", &P::method,
                {{"pca", P::Method::pca, "The normal of the plane that fits a point and its neighbours best."},
                 {"jet", P::Method::jet,
                  "The normal, at the point, of the polynomial of degree two that fits them best: better where the "
                  "surface is curved, worse where it is noisy."}},
                "How a normal is estimated.")
        .param("neighbours", &P::neighbours,
               "Number of nearest other positions. The point itself counts in addition; its duplicates do not count.",
               at_least(2), at_most(1000))
        .choice(
            "orient", &P::orient,
            {{"auto", P::Orient::automatic,
              "As `sensor` if there is a column `approach` or a `scanner`; else as `column` if there is a column "
              "`normal` that does not contradict itself; else as `tree`."},
             {"sensor", P::Orient::sensor,
              "Towards the scanner; where the surface is seen edge-on, consistent with the neighbours."},
             {"known", P::Orient::known,
              "As `sensor` if there is a column `approach` or a `scanner`; else the points stay as they are, for "
              "steps that can do without normals."},
             {"column", P::Orient::column, "On the side of the column `normal`; only the direction is estimated anew."},
             {"tree", P::Orient::tree,
              "Consistent with the neighbours, along a spanning tree. The tree starts at the highest point of "
              "every component, where up is outside."},
             {"none", P::Orient::none, "Either of the two sides."}},
            "Which side is outside.")
        .param("scanner", &P::scanner,
               "x, y, z of the scanner, in the coordinates of the file, for a scan from one position.", size(3))
        .metric(
            "oriented", Unit::count,
            "Points whose side is decided: all points; none with `orient: none`, and if the points stay as they are.")
        .metric("by-sensor", Unit::count, "Points that are turned towards the scanner.")
        .metric("against", Unit::count,
                "Points whose normals are on the other side than the scanner, or than the column `normal`.",
                smaller_is_better)
        .metric("doubtful", Unit::count,
                "Points whose neighbours lie on one line, or most of whose neighbours have normals on the other side.",
                headline, smaller_is_better)
        .metric("components", Unit::count, "Connected components of the neighbourhoods.", headline)
        .doubts({"at more than 5 % of the points the neighbours lie on a line, or most of them have normals on the "
                 "other side",
                 "more than 5 % of the points are in connected components whose side is a guess",
                 "the column `normal` contradicts itself at more than 5 % of the points",
                 "the neighbours of most points form no surface"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", normals(inputs.get<PointCloud>("points"), params, context).points);
        });
}
