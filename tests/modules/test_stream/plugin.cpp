// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "test_stream/test_stream.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = TestStreamParams;
    return Declare<P>("test-stream", 1)
        .summary("Passes the first and the last point on; for tests only.")
        .source("Hand-made")
        .ties("Nothing is compared.")
        .not_finite("Passed through as they are.")
        .in<PointCloud>("points", "Any cloud.")
        .out<PointCloud>("points", "The first point and the last, with their columns.")
        .param("length", &P::length, "Only logged; when it is given, scans are streamed.", word("auto"), above(0))
        .param("more", &P::more, "Only looked at by the engine.", at_least(0))
        .param("log", &P::log, "A file that every run appends a line to: how it was run, length, number of points.")
        .param("waits", &P::waits, "Goes on until it is cancelled.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", test_stream(inputs.get<PointCloud>("points"), params, context));
        })
        .run_streamed({"length"}, [](const PointStream& scan, const P& params, Context& context) {
            return Outputs().set("points", test_stream(scan, params, context));
        });
}
