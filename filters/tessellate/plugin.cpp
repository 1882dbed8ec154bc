// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "tessellate/tessellate.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = TessellateParams;
    return Declare<P>("tessellate", 3)
        .summary("Triangles on the surface of A-patches: watertight, with exact normals and creases.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 5")
        .ties("Between an edge and the inside of a triangle, the edge's next sample comes first.")
        .not_finite("Patches have finite coordinates.")
        .in<PatchComplex>("patches", "The surface.")
        .out<TriangleMesh>("mesh",
                           "Triangles with `patch`, the row of the mesh's triangle, `side`, 1 outside the mesh, and "
                           "beside creases `corner-normals`; vertices with `normal`; the creases are sharp edges.")
        .adds({"normal", "patch", "side", "corner-normals"})
        .param("subdivision", &P::subdivision,
               "Segments per edge of the mesh; with max-error the most, as a power of two.", at_least(1), at_most(1024))
        .param("max-error", &P::max_error,
               "Largest distance between the triangles and the surface, measured amid the triangles; `none`: uniform.",
               word("none"), above(0))
        .metric("triangles", Unit::count, "Triangles of the result.", headline)
        .run([](const Inputs& inputs, const P& params, Context& context) {
            double left = 0;
            TriangleMesh mesh = tessellate(inputs.get<PatchComplex>("patches"), params, context, &left);
            if (left > 0)
                context.doubt(fmt::format(
                    "the triangles are up to {:.3g} from the surface, where it leaps: no more segments bring "
                    "them nearer; max-error is {:.3g}",
                    left, params.max_error->value()));
            context.metric("triangles", static_cast<double>(mesh.triangles.size()));
            return Outputs().set("mesh", std::move(mesh));
        });
}
