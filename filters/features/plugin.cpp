// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "features/features.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = FeatureParams;
    return Declare<P>("features", 4)
        .summary("Finds the boundaries and sharp edges of a mesh, and the corners where such lines meet or turn.")
        .source("Wang 2006, chapter 4, for loops, holes and sharp edges")
        .ties(
            "An angle within 1e-9 rad of a limit is not above it. Among equally long loops, the one that begins at the "
            "lower position (x, then y, then z) is the outer boundary.")
        .not_finite("Refused at vertices of triangles; the message names the first one.")
        .in<TriangleMesh>("mesh",
                          "At most two triangles at an edge, oriented consistently. Sharp edges that the mesh declares "
                          "are creases, too.")
        .out<FeatureGraph>("features", "Polylines with the unit normals on both sides, and corners.")
        .param("sharp-angle", &P::sharp_angle,
               "An edge is sharp if the normals of its triangles differ by more than this.", at_least(0), at_most(180))
        .param("corner-angle", &P::corner_angle, "A line has a corner where it turns by more than this.", at_least(0),
               at_most(180))
        .param("min-length", &P::min_length, "Creases shorter than this, from corner to corner, are left out.",
               at_least(0))
        .param("noise", &P::noise,
               "Standard deviation of the vertices' distances from the true surface. Triangles that are too small for "
               "this noise take the normal of a neighbourhood. `auto` estimates the noise; with 0, all triangles keep "
               "their normals.",
               at_least(0), word("auto"))
        .metric("creases", Unit::count, "Lines of sharp edges, from corner to corner or closed.", headline)
        .metric("holes", Unit::count, "Boundary loops around a hole in the mesh.", headline)
        .metric("boundaries", Unit::count, "Boundary loops around a component of the mesh.", headline)
        .metric("corners", Unit::count, "Points where lines meet, end or turn.", headline)
        .metric("ambiguous", Unit::count, "Loops classified by their length because their area does not decide.",
                smaller_is_better)
        .metric("dropped", Unit::count, "Creases left out because they are shorter than min-length.")
        .metric("without-area", Unit::count, "Triangles without area; they take the normal of a neighbour.",
                smaller_is_better)
        .metric("noise", Unit::length,
                "Standard deviation of the vertices' distances from the true surface, given or estimated.")
        .metric("unreliable", Unit::count,
                "Triangles too small for the noise; they take the normal of a neighbourhood.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("features", features(inputs.get<TriangleMesh>("mesh"), params, context).graph);
        });
}
