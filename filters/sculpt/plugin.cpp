// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "sculpt/sculpt.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = SculptParams;
    return Declare<P>("sculpt", 3)
        .summary("Takes single cells off a solid until every point lies on its boundary and the boundary bends less.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 3; Boissonnat 1984 for the admissible steps")
        .ties(
            "Of equal gains the step at the larger triangle comes first, then the one whose cell has the lower "
            "corners; of chains of flips the one whose first cell has.")
        .in<TetMesh>("tets",
                     "Cells of a Delaunay tetrahedralisation, labelled by alpha-solid; its boundary a manifold.")
        .made_by("alpha-solid")
        .out<TriangleMesh>("mesh", "The boundary that is left, closed and outward.")
        .out<TetMesh>("tets", "The cells, those that were removed labelled outside.")
        .choice("weight", &P::weight,
                {{"none", SculptWeight::none, "Every edge counts the angle that it bends by."},
                 {"length", SculptWeight::length, "The angle times the edge's length: better on uneven triangles."}},
                "What an edge counts in the sum that is lessened.")
        .param(
            "min-gain", &P::min_gain,
            "A smoothing step must lessen the bending by more than this, a chain of them by more than this for each.",
            at_least(0))
        .param("lookahead", &P::lookahead,
               "Whether an exposing step is judged together with the best smoothing step after it.")
        .metric("removed", Unit::count, "Cells removed.", headline)
        .metric("removed-exposing", Unit::count, "Of these, such that brought a point to the surface.")
        .metric("removed-smoothing", Unit::count,
                "Of these, such that flipped an edge to lessen the bending, alone or in a chain.")
        .metric("removed-opening", Unit::count, "Of these, such that flipped an edge to get at a deeper point.")
        .metric("removed-share", Unit::ratio, "Removed cells over the cells inside before.")
        .metric("volume-removed", Unit::volume, "Volume of the removed cells.")
        .metric("bending-before", Unit::angle, "Sum over the boundary's edges of the angle between normals, before.")
        .metric("bending-after", Unit::angle, "The same sum afterwards.", headline)
        .metric("interior-points", Unit::count, "Points left inside the solid.", headline)
        .metric(
            "interior-blocked", Unit::count,
            "Of these, such as no cell over them can go without the boundary touching itself or a point falling out.")
        .metric("interior-deep", Unit::count, "Of these, such as lie more than two cells below the boundary.")
        .metric("outside-points", Unit::count, "Points in no cell of the solid, as in the input.")
        .metric("triangles", Unit::count, "Triangles of the boundary.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            SculptResult result = sculpt(inputs.get<TetMesh>("tets"), params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("tets", std::move(result.tets));
        });
}
