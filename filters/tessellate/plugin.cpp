// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "tessellate/tessellate.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = TessellateParams;
    return Declare<P>("tessellate", 5)
        .summary("Triangles on the surface of A-patches: watertight, with exact normals and creases.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 5")
        .ties(
            "Samples on an edge and points inside a triangle are joined in order of their shares of the way; among "
            "equal shares, the edge's sample comes first.")
        .not_finite("Patches have finite coordinates.")
        .in<PatchComplex>("patches", "The surface.")
        .out<TriangleMesh>(
            "mesh",
            "The triangles have `patch` (the row of the mesh's triangle), `side` (1 outside the mesh) and, if there "
            "are creases, `corner-normals`. The vertices have `normal`. The creases are sharp edges.")
        .adds({"normal", "patch", "side", "corner-normals"})
        .param("subdivision", &P::subdivision,
               "Segments per edge of the mesh. With max-error, this is the largest number of segments, rounded down to "
               "a power of two.",
               at_least(1), at_most(1024))
        .param("max-error", &P::max_error,
               "Largest distance between the triangles and the surface, measured inside edges and triangles. With "
               "`none`, all edges get `subdivision` segments.",
               word("none"), above(0))
        .metric("triangles", Unit::count, "Triangles of the result.", headline)
        .doubts({"the surface jumps by more than `max-error`"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            double left = 0;
            TriangleMesh mesh = tessellate(inputs.get<PatchComplex>("patches"), params, context, &left);
            if (left > 0)
                context.doubt(
                    fmt::format("the triangles are up to {:.3g} u from the surface where it jumps: more segments do "
                                "not bring them nearer; max-error is {:.3g} u",
                                left, params.max_error->value()));
            context.metric("triangles", static_cast<double>(mesh.triangles.size()));
            return Outputs().set("mesh", std::move(mesh));
        });
}
