// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "edge_flip/edge_flip.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = EdgeFlipParams;
    return Declare<P>("edge-flip", 3)
        .summary("Flips edges of a mesh where this improves the triangles and hardly moves the surface.")
        .source("Sangveraphunsiri, Srirakulchai 2006, section 4; Lawson 1977 for the Delaunay criterion")
        .ties("An edge stays if the other diagonal is equally good, to 1e-9.")
        .not_finite("Refused; the message gives their number and the first one.")
        .in<TriangleMesh>("mesh",
                          "One fan of triangles at every vertex, at most two triangles at an edge, oriented "
                          "consistently. Its sharp edges are never flipped; on a noisy mesh, neither are creases.")
        .out<TriangleMesh>("mesh",
                           "The same vertices with their columns, and the same sharp edges; without face and edge "
                           "columns.")
        .choice("criterion", &P::criterion,
                {{"delaunay", P::Criterion::delaunay, "The least angle of the two triangles grows."},
                 {"shorter", P::Criterion::shorter, "The other diagonal is shorter."},
                 {"paper", P::Criterion::paper,
                  "The paper's words taken literally: the other diagonal is shorter, and the normals of the new "
                  "triangles are more than 90° apart. This makes folds; `keep-angle` and `deviation` have no effect."}},
                "The condition for flipping an edge.")
        .param("keep-angle", &P::keep_angle,
               "Largest angle between the normals of neighbours after a flip; a larger one is allowed if it was there "
               "before.",
               at_least(0), at_most(60))
        .param(
            "deviation", &P::deviation,
            "Largest distance between the two diagonals, as a share of the shorter one: how far the surface may move.",
            at_least(0))
        .param("max-edge", &P::max_edge, "New edges are shorter than this.", above(0))
        .param("noise", &P::noise,
               "Standard deviation of the vertices' distances from the true surface. Triangles that are too small for "
               "this noise are judged by the normals of neighbourhoods, and creases stay. `auto` estimates the noise; "
               "with 0, all triangles are judged by their own normals.",
               at_least(0), word("auto"))
        .metric("flips", Unit::count, "Number of edges that were flipped.", headline)
        .metric("min-angle-before", Unit::angle, "Least angle of all triangles before the flips.")
        .metric("min-angle-after", Unit::angle, "Least angle of all triangles after the flips.", headline,
                larger_is_better)
        .metric("left", Unit::count,
                "Edges that fulfil the criterion and were not flipped, because they are sharp or another limit forbids "
                "it; a warning gives the reasons.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("mesh", edge_flip(inputs.get<TriangleMesh>("mesh"), params, context).mesh);
        });
}
