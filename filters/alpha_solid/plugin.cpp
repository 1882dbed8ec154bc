// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "alpha_solid/alpha_solid.hpp"
#include "scanmill/geometry/mesh/doubtful_surface.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = AlphaSolidParams;
    return Declare<P>("alpha-solid", 4)
        .summary(
            "Finds the solid that the points enclose: every cell that a ball of radius alpha cannot enter from "
            "outside.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 3")
        .ties(
            "Facets with equal alpha in double precision become walls together. Among components with equally many "
            "points, the one with the lowest point is kept.")
        .in<TetMesh>("tets", "A Delaunay tetrahedralisation.")
        .out<TriangleMesh>("mesh", "The solid's boundary, closed and outward.")
        .out<TetMesh>("tets", "The cells, labelled inside or outside.")
        .param("alpha", &P::alpha, "Radius of the ball; `auto` is the smallest radius that gives a valid solid.",
               word("auto"), above(0))
        .choice(
            "search", &P::search,
            {{"scan", AlphaSearch::scan, "The least alpha whose solid is valid."},
             {"binary", AlphaSearch::binary, "The paper's bisection; it finds a valid solid, not always the least."}},
            "How alpha is found for `alpha: auto`.")
        .choice(
            "components", &P::components,
            {{"single", AlphaComponents::single,
              "One solid. Alpha grows until all solids are joined; with coverage below 100 %, only the solid with the "
              "most points is kept."},
             {"many", AlphaComponents::many,
              "Any number of solids. Solids that are separate at the least alpha stay separate."}},
            "Number of separate solids that a valid result may have.")
        .param("coverage", &P::coverage, "Share of the points that must be in or on the solid.", above(0), at_most(1))
        .metric("alpha", Unit::length, "The radius used.", headline)
        .metric("alpha-cover", Unit::length, "The least radius that covers the requested share of the points.")
        .metric("spectrum", Unit::count,
                "Number of different alpha-solids from alpha-cover (or a smaller given alpha) up to the hull.")
        .metric("cells", Unit::count, "Cells inside.")
        .metric("interior-points", Unit::count, "Points inside the solid but not on its boundary.", smaller_is_better)
        .metric("uncovered-points", Unit::count, "Points in no cell of the solid.", headline, smaller_is_better)
        .metric("hidden-points", Unit::count, "Points in no cell at all, because weights hide them.", smaller_is_better)
        .metric("triangles", Unit::count, "Triangles of the boundary.", headline)
        .doubts({"alpha is at least seven times the median edge of the surface",
                 "more than half of the points are inside the solid, not on its surface", signs_of_doubtful_surface})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            AlphaSolidResult result = alpha_solid(inputs.get<TetMesh>("tets"), params, context);
            return Outputs().set("mesh", std::move(result.mesh)).set("tets", std::move(result.tets));
        });
}
