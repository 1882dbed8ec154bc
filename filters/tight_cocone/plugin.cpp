// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "cocone/parameters.hpp"
#include "scanmill/geometry/mesh/doubtful_surface.hpp"
#include "scanmill/geometry/mesh/handles.hpp"
#include "tight_cocone/parameters.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = TightCoconeParams;
    auto declaration = Declare<P>("tight-cocone", 1);
    declaration.summary("Makes a closed surface through the points, with every hole filled.")
        .source("Dey, Goswami 2003 and 2004; Woo, Dey 2005, section 2")
        .ties(
            "A direction exactly on a limit of a cocone is inside. A cell whose good points disagree "
            "follows most of them; on a tie it is inside. Among "
            "equally small facets of a cell, the one opposite to its first corner counts, in the order along a "
            "space-filling curve.")
        .adds({"pole-normal", "flat", "boundary"})
        .in<TetMesh>("tets", "A Delaunay tetrahedralisation without weights.")
        .made_by("delaunay")
        .out<TriangleMesh>("mesh", "The solid's boundary, closed and outward.")
        .out<TetMesh>("tets", "The cells, labelled inside or outside.");
    cocones::declare_parameters(declaration);
    tight_cocones::declare_noise(declaration);
    return declaration.metric("good", Unit::count, "Points where cocone's surface is one closed fan.", larger_is_better)
        .metric("poor", Unit::count, "All other points.", smaller_is_better)
        .metric("boundary-points", Unit::count, "Points where the sampling ends or is too sparse.")
        .metric("unused-points", Unit::count, "Points that are not on the surface.", headline, smaller_is_better)
        .metric("triangles", Unit::count, "Triangles of the surface.", headline)
        .metric("holes-filled", Unit::count, "Boundary loops of cocone's surface that are filled.")
        .metric("invented-area", Unit::area, "Area of the triangles that are not in cocone's surface.", headline,
                smaller_is_better)
        .metric("removed-blobs", Unit::count, "Connected sets of good points that lie inside the solid.")
        .metric("mended-vertices", Unit::count,
                "Vertices where the boundary was not a manifold before cells were added.", smaller_is_better)
        .doubts({"more than 10 % of the area is not in the surface of `cocone`",
                 "more than 2 % of the points are not on the surface (not with `noise: big-balls`)",
                 signs_of_doubtful_surface, sign_of_doubtful_handles})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            TightCoconeResult result = tight_cocone(inputs.get<TetMesh>("tets"), params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("tets", std::move(result.tets));
        });
}
