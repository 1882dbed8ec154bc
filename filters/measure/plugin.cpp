// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/plugin.hpp"
#include "measure/measure.hpp"
#include "measure/measured_metrics.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = MeasureParams;
    return Declare<P>("measure", 1)
        .summary("Tells how far a mesh is from the truth, both ways, and how good a mesh it is.")
        .source("Aspert, Santa-Cruz, Ebrahimi 2002")
        .ties("Of equally near triangles the first gives the normal.")
        .not_finite("Refused, with their number and the first of them.")
        .in<TriangleMesh>("mesh", "What was made.")
        .in<TriangleMesh>("truth", "What it should be.")
        .out<Metrics>("metrics", "The numbers.")
        .param("samples", &P::samples, "Points on each mesh.", at_least(32))
        .param("self-intersections", &P::self_intersections, "Whether pairs of intersecting triangles are counted.")
        .metric("hausdorff", Unit::length, "Largest distance found at a sample or vertex, either way.", headline)
        .run([](const Inputs& inputs, const P& params, Context& context) {
            const Measurement measured =
                measure(inputs.get<TriangleMesh>("mesh"), inputs.get<TriangleMesh>("truth"), params, context);
            const Metrics metrics = metrics_of(measured);
            for (const Metric& metric : metrics.values) context.metric(metric.name, metric.value, metric.unit);
            return Outputs().set("metrics", metrics);
        });
}
