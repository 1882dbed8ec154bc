// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "virtual_probe/virtual_probe.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = VirtualProbeParams;
    return Declare<P>("virtual-probe", 2)
        .summary("Makes the touches of a probe plan against a mesh, as a measuring machine would.")
        .source("Wang 2006, chapter 5; sphere tracing: Hart 1996")
        .ties("None: all equally near triangles give the same contact.")
        .not_finite("Refused; the message gives their number and the first one.")
        .adds({"uncertainty", "touch", "feature", "approach"})
        .in<ProbePlan>("probes", "The plan. Touches that cannot be made are skipped.")
        .made_by("probe-planner")
        .in<TriangleMesh>("mesh", "The part that is touched, in the frame of the plan.")
        .out<PointCloud>("points", "Measured points of the edges, compensated by the radius along `approach`.")
        .param("noise", &P::noise, "Standard deviation of the machine's error in each coordinate.", at_least(0))
        .param("reference-error", &P::reference_error,
               "Largest distance by which reference points are moved at random across the edge; below the radius of "
               "the plan's ball.",
               at_least(0))
        .metric("points", Unit::count, "Touches that met the mesh.", headline)
        .metric("missed", Unit::count, "Touches without contact.", headline, smaller_is_better)
        .doubts({"more than 10 % of the touches miss the mesh"})
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", virtual_probe(inputs.get<ProbePlan>("probes"),
                                                         inputs.get<TriangleMesh>("mesh"), params, context)
                                               .points);
        });
}
