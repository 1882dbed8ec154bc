// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "scanmill/geometry/mesh/handles.hpp"

#include <fmt/format.h>

#include "fill_holes/fill_holes.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = FillHolesParams;
    return Declare<P>("fill-holes", 6)
        .summary("Closes the holes of a mesh with triangles that continue the surface, and marks them.")
        .source("Liepa 2003, Filling holes in meshes; Botsch, Kobbelt 2004 for fairing; by CGAL")
        .ties(
            "A loop at a limit is filled. Of two triangulations that intersect each other, the one with more edges is "
            "replaced; with equally many edges, the later one.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"filled"})
        .in<TriangleMesh>("mesh",
                          "At most two triangles at an edge, oriented consistently, no triangle with a repeated "
                          "vertex. Vertices where holes touch are welcome.")
        .out<TriangleMesh>("mesh",
                           "The input's vertices and triangles in their rows, then the new ones. The face column "
                           "`filled` and the vertex column `filled` are 1 for new rows. Other columns of new rows have "
                           "the values of the boundary beside them.")
        .choice(
            "outer", &P::outer,
            {{"auto", P::Outer::automatic,
              fmt::format("A surface with a loop that would add {0:g} % to its area if it were closed flat is open, as "
                          "masks, terrain and plates. Then all loops of {1:g} % or more stay open, otherwise none.",
                          100 * P::outer_share, 100 * P::large_share)},
             {"keep", P::Outer::keep,
              fmt::format("Loops that would add {:g} % or more to the mesh stay open.", 100 * P::large_share)},
             {"fill", P::Outer::fill, "Every loop is filled."}},
            "The loops that are outer boundaries and stay open.")
        .choice("closed", &P::must_close,
                {{"auto", false, "Loops may stay open; those without a filling make the result doubtful."},
                 {"required", true, "Every loop is filled, also outer ones; it is an error if that fails."}},
                "Whether the result must be closed.")
        .param("max-edges", &P::max_edges, "Loops with more boundary edges stay open; `none`: any number.", at_least(3),
               word("none"))
        .param("max-length", &P::max_length, "Loops longer than this stay open; `none`: any length.", above(0),
               word("none"))
        .param("fair", &P::fair,
               "Moves the new vertices so that they continue the surface without a crease. Otherwise they stay "
               "in the triangles that span the loop.")
        .param(
            "together", &P::together,
            "If loops stay open because every triangulation would intersect something, closes the whole surface as the "
            "boundary of a solid. This replaces some of its triangles. It is not done if a limit or an outer boundary "
            "leaves loops open.")
        .metric("filled", Unit::count, "Loops that are filled.", headline)
        .metric("left", Unit::count,
                "Loops that stay open: outer boundaries, beyond a limit, or without valid triangles.", headline)
        .metric("outer", Unit::count, "Outer boundaries that stay open.")
        .metric("largest-share", Unit::ratio,
                "Largest flat area of a loop, as a share of the area of the mesh; see `outer`.")
        .metric("added-triangles", Unit::count, "New triangles.")
        .metric("added-points", Unit::count, "New vertices.")
        .metric("area", Unit::area, "Area of the new triangles.")
        .metric("share", Unit::ratio, "Area of the new triangles as a share of the whole area.", smaller_is_better)
        .metric("longest", Unit::length, "Length of the longest filled loop.", smaller_is_better)
        .metric("plain", Unit::count,
                "Filled loops whose faired triangulation would intersect something, so a plainer one was used.")
        .metric("together", Unit::count,
                "Filled loops that were closed together with the whole surface, because they have no triangulation of "
                "their own.",
                smaller_is_better)
        .metric("replaced-triangles", Unit::count,
                "Triangles of the input that were replaced to close the whole surface.", smaller_is_better)
        .metric("failed", Unit::count,
                "Loops within the limits that stay open because any triangulation would intersect "
                "something.",
                smaller_is_better)
        .doubts({"more than 5 % of the surface is filled", "a filled loop is longer than the diagonal of the mesh",
                 "loops were closed all together, because one has no filling of its own",
                 "a loop that should be filled stays open", sign_of_doubtful_handles})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("mesh", fill_holes(inputs.get<TriangleMesh>("mesh"), params, context).mesh);
        });
}
