// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/decimate.hpp"
#include "scanmill/plugin/plugin.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = DecimateParams;
    return Declare<P>("decimate", 1)
        .summary("Removes vertices while the surface stays within a distance.")
        .source("Bernardini, Bajaj, Chen, Schikore 1997, section 4")
        .in<TriangleMesh>("mesh", "A manifold.")
        .out<TriangleMesh>("mesh", "The lighter mesh.")
        .param("max-error", &P::max_error, "Largest distance.", at_least(0))
        .run([](const Inputs& inputs, const P& params, Context& context) {
            DecimateResult result = decimate(inputs.get<TriangleMesh>("mesh"), nullptr, params, context);
            return Outputs().set("mesh", std::move(result.mesh));
        });
}
