// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "test_draw/test_draw.hpp"

using namespace scanmill;

SCANMILL_FILTER() {
    using P = TestDrawParams;
    return Declare<P>("test-draw", 1)
        .summary("Draws a picture of one pixel per point; for tests only.")
        .source("Hand-made")
        .ties("Nothing is compared.")
        .not_finite("Drawn like any other point.")
        .in<TriangleMesh, PointCloud>("scene", "Any mesh or cloud.")
        .out<Picture>("picture", "One row with a pixel per vertex or point.")
        .param("caption", &P::caption, "The picture's caption.")
        .param("fails", &P::fails, "Fails instead of drawing.")
        .draws("scene")
        .run([](const Inputs& inputs, const P& params, Context&) {
            const TriangleMesh* mesh = inputs.find<TriangleMesh>("scene");
            return Outputs().set("picture",
                                 test_draw(mesh ? mesh->positions : inputs.get<PointCloud>("scene").positions, params));
        });
}
