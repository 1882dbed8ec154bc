// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/alpha_solid.hpp"
#include "scanmill/filter/plugin.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = AlphaSolidParams;
    return Declare<P>("alpha-solid", 1)
        .summary("The part of a tetrahedralisation that a ball of radius alpha cannot enter, with alpha found by itself.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 3")
        .in<TetMesh>("tets", "Made by delaunay.")
        .out<TriangleMesh>("mesh", "The solid's boundary, closed and oriented outwards; point columns are carried along.")
        .out<TetMesh>("tets", "The same cells, labelled inside or outside.")
        .param("alpha", &P::alpha,
               "Radius of the ball; `auto` takes the least that gives a valid solid. A given one promises nothing of the "
               "boundary.",
               above(0), word("auto"))
        .choice("search", &P::search,
                {{"scan", AlphaSearch::scan, "The least alpha with a valid solid."},
                 {"binary", AlphaSearch::binary, "The paper's bisection: a valid solid, not always the least."}},
                "How the automatic alpha is searched.")
        .choice("components", &P::components,
                {{"single", AlphaComponents::single,
                  "One solid; with a coverage below 100 % the largest, and the others are left out."},
                 {"many", AlphaComponents::many, "Any number of solids."}},
                "What a valid solid may consist of.")
        .param("coverage", &P::coverage, "Share of the points that must be in or on the solid.", above(0), at_most(1))
        .metric("alpha", Unit::length, "The radius of the solid.", headline)
        .metric("alpha-cover", Unit::length, "Least radius at which the asked share of the points is in or on the solid.")
        .metric("cells", Unit::count, "Cells inside.")
        .metric("interior-points", Unit::count, "Points inside the solid but not on its boundary.")
        .metric("uncovered-points", Unit::count, "Points in no cell of the solid.")
        .metric("triangles", Unit::count, "Triangles of the boundary.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            AlphaSolidResult result = alpha_solid(inputs.get<TetMesh>("tets"), params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("tets", std::move(result.tets));
        });
}
