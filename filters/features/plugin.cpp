// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "features/features.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = FeatureParams;
    return Declare<P>("features", 1)
        .summary("Finds where a mesh ends, where it bends sharply, and the corners where such lines meet or turn.")
        .source("Wang 2006, chapter 4, for loops, holes and sharp edges")
        .ties(
            "An angle equal to a limit, within 1e-9 rad, is not above it; of equally long loops the one that begins at "
            "the lower place (x, then y, then z) is the outer boundary.")
        .not_finite("Refused at a vertex of a triangle, with the first of them.")
        .in<TriangleMesh>("mesh",
                          "At most two triangles at an edge, oriented alike; its own sharp edges are creases, too.")
        .out<FeatureGraph>("features", "Polylines with the unit normals on both sides, and corners.")
        .param("sharp-angle", &P::sharp_angle, "Edges whose triangles' normals differ by more are sharp.", at_least(0),
               at_most(180))
        .param("corner-angle", &P::corner_angle, "A line that turns by more has a corner there.", at_least(0),
               at_most(180))
        .param("min-length", &P::min_length, "Creases that are shorter, from corner to corner, are left out.",
               at_least(0))
        .metric("creases", Unit::count, "Lines of sharp edges, from corner to corner or closed.", headline)
        .metric("holes", Unit::count, "Boundary loops round a hole in the mesh.", headline)
        .metric("boundaries", Unit::count, "Boundary loops round a piece of the mesh.", headline)
        .metric("corners", Unit::count, "Places where lines meet, end or turn.", headline)
        .metric("ambiguous", Unit::count, "Loops told apart by their length, as their area does not tell.")
        .metric("dropped", Unit::count, "Creases left out because they are shorter than min-length.")
        .metric("without-area", Unit::count, "Triangles without area, counted to a neighbour's plane.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("features", features(inputs.get<TriangleMesh>("mesh"), params, context).graph);
        });
}
