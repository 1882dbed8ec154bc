// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "repair/repair.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = RepairParams;
    return Declare<P>("repair", 4)
        .summary("Makes an oriented manifold mesh of any triangles: stitches, orients, splits, and drops specks.")
        .source("Gueziec, Taubin, Lazarus, Horn 2001, Cutting and stitching; by CGAL")
        .ties(
            "Among vertices at one position, equally near vertices or equal triangles, the lower row stays. A "
            "component at the limit of min-component stays.")
        .not_finite("Refused; the message gives their number and the first one.")
        .in<TriangleMesh>(
            "mesh",
            "Any triangles, also a soup: neighbours may have any orientation, and edges any number of triangles.")
        .out<TriangleMesh>("mesh",
                           "At most two triangles at an edge, oriented equally; one fan at a vertex. Vertices, "
                           "triangles and edges that stay keep their order and their columns.")
        .param("stitch", &P::stitch,
               "Vertices on the boundary at most this far apart are joined. It should be shorter than the edges there: "
               "triangles whose corners are joined disappear. Vertices at one position are joined in any case.",
               at_least(0))
        .param("min-component", &P::min_component,
               "Connected components with less than this share of the area are removed.", at_least(0), at_most(1))
        .metric("oriented", Unit::count, "Triangles that were reversed.")
        .metric("stitched", Unit::count, "Vertices that were joined to another one.")
        .metric("split-vertices", Unit::count, "Copies of vertices, made where several surfaces met.")
        .metric("split-edges", Unit::count, "Edges that had three or more triangles.")
        .metric("removed-triangles", Unit::count,
                "Triangles that were removed: they had a repeated vertex, were the same as an earlier triangle, had no "
                "area at the boundary, or were in a small component.",
                headline)
        .metric("removed-components", Unit::count, "Components below min-component.")
        .metric("removed-points", Unit::count, "Vertices, other than joined ones, that are in no triangle that stays.")
        .metric("flipped", Unit::count, "Triangles without area that were replaced by a flip of their longest edge.")
        .metric("components", Unit::count, "Connected components of the result.", headline)
        .metric("boundary-loops", Unit::count, "Boundary loops of the result.", headline)
        .doubts({"more than 5 % of the area was removed", "the mesh was closed, and is open now"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("mesh", repair(inputs.get<TriangleMesh>("mesh"), params, context).mesh);
        });
}
