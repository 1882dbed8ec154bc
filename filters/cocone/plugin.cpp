// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "cocone/cocone.hpp"
#include "cocone/parameters.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = CoconeParams;
    auto declaration = Declare<P>("cocone", 1);
    declaration
        .summary(
            "Takes the surface through the points from their tetrahedralisation, and leaves it open where the "
            "scan is.")
        .source("Amenta, Choi, Dey, Leekha 2000; Dey, Giesen 2001; Woo, Dey 2005, section 2")
        .ties(
            "A direction exactly on a limit of a cocone is inside. Of equally far poles, that of the lower cell "
            "counts.")
        .adds({"pole-normal", "flat", "boundary"})
        .in<TetMesh>("tets", "A Delaunay tetrahedralisation without weights.")
        .made_by("delaunay")
        .out<TriangleMesh>("mesh", "The surface, open where the scan is.")
        .out<FeatureGraph>("features", "The boundary loops of the surface.");
    cocones::declare_parameters(declaration);
    return declaration.metric("triangles", Unit::count, "Triangles of the surface.", headline)
        .metric("boundary-points", Unit::count, "Points where the sampling ends or is too sparse.", headline)
        .metric("loops", Unit::count, "Boundary loops of the surface.", headline)
        .metric("unused-points", Unit::count, "Points in no triangle.", smaller_is_better)
        .metric("pole-flat", Unit::count, "Points that are flat by the test with poles.")
        .doubts(
            {"more than 2 % of the points are in no triangle",
             "more than three boundary loops, and more than one per 1,000 vertices, are shorter than 12 median edges"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            CoconeResult result = cocone(inputs.get<TetMesh>("tets"), params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("features", std::move(result.features));
        });
}
