// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "scanmill/geometry/mesh/doubtful_surface.hpp"
#include "scanmill/geometry/mesh/handles.hpp"
#include "sculpt/sculpt.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = SculptParams;
    return Declare<P>("sculpt", 5)
        .summary("Removes single cells of a solid until every point is on its boundary and the boundary is smoother.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 3; Boissonnat 1984 for the admissible steps")
        .ties(
            "Among steps of equal gain, the one at the larger triangle comes first, then the one whose cell has the "
            "lower corners. Among chains of flips, the one with the lower first cell comes first.")
        .in<TetMesh>("tets",
                     "Cells of a Delaunay tetrahedralisation, labelled by alpha-solid or tight-cocone, with a manifold "
                     "boundary.")
        .made_by("alpha-solid")
        .out<TriangleMesh>("mesh", "The resulting boundary, closed and outward.")
        .out<TetMesh>("tets", "The cells, with the removed ones labelled outside.")
        .choice("weight", &P::weight,
                {{"none", SculptWeight::none, "Every edge counts the angle between its triangles' normals."},
                 {"length", SculptWeight::length,
                  "Every edge counts the angle times its length: better on uneven triangles."}},
                "Contribution of an edge to the sum that is minimised.")
        .param("min-gain", &P::min_gain,
               "A smoothing step must decrease the bending by more than this; a chain of n steps must decrease it by "
               "more than n times this.",
               at_least(0))
        .param("lookahead", &P::lookahead,
               "Whether the gain of an exposing step includes the best smoothing step after it.")
        .metric("removed", Unit::count, "Cells removed.")
        .metric("removed-exposing", Unit::count, "Removed cells that brought a point to the boundary.")
        .metric("removed-smoothing", Unit::count,
                "Removed cells that flipped an edge to decrease the bending, alone or in a chain.")
        .metric("removed-opening", Unit::count,
                "Removed cells that flipped an edge of the boundary to reach a deeper point.")
        .metric("removed-share", Unit::ratio, "Removed cells divided by the cells inside before.")
        .metric("volume-removed", Unit::volume, "Volume of the removed cells.")
        .metric("bending-before", Unit::angle, "Sum over the boundary's edges of the angle between normals, before.")
        .metric("bending-after", Unit::angle, "Sum over the boundary's edges of the angle between normals, afterwards.",
                smaller_is_better)
        .metric("interior-points", Unit::count, "Points left inside the solid.", headline, smaller_is_better)
        .metric("interior-blocked", Unit::count,
                "Interior points that no removal can reach: the boundary would touch itself, or a point would be left "
                "outside.",
                smaller_is_better)
        .metric("interior-deep", Unit::count, "Interior points that lie more than two cells below the boundary.",
                smaller_is_better)
        .metric("outside-points", Unit::count, "Points in no cell of the solid, as in the input.", smaller_is_better)
        .metric("triangles", Unit::count, "Triangles of the boundary.")
        .metric("noise", Unit::length,
                "Standard deviation of the boundary's points from a smooth surface, estimated from 5,000 to 10,000 of "
                "them.")
        .doubts({"more than half of the cells had to be removed", signs_of_doubtful_surface, sign_of_doubtful_handles})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            SculptResult result = sculpt(inputs.get<TetMesh>("tets"), params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("tets", std::move(result.tets));
        });
}
