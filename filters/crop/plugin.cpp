// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/plugin.hpp"
#include "crop/crop.hpp"

using namespace scanmill;

namespace {

CropResult cropped(const Inputs& inputs, const CropParams& params, Context& context) {
    const auto& points = inputs.get<PointCloud>("points");
    if (const auto* near = inputs.find<PointCloud>("near")) return crop(points, *near, params, context);
    if (const auto* near = inputs.find<TriangleMesh>("near")) return crop(points, *near, params, context);
    return crop(points, params, context);
}

}  // namespace

SCANMILL_FILTER() {
    using P = CropParams;
    return Declare<P>("crop", 1)
        .summary("Keeps the points in a box, in a ball, or near other points or a mesh.")
        .source("nearest points of triangles: Ericson 2005, section 5.1.5")
        .ties("A point on the border of the region stays.")
        .not_finite("Refused, with their number and the first of them.")
        .in<PointCloud>("points", "The points to crop, with finite coordinates; every column is carried along.")
        .in<PointCloud, TriangleMesh>("near", "Points or a mesh; `within` keeps the points near them.", optional)
        .out<PointCloud>("points", "The kept points, in input order.")
        .param("box", &P::box,
               "x, y, z of a box's low corner, then of its high corner, in the coordinates of the file. Give either "
               "this, or `centre` with `radius`, or `within`.",
               size(6))
        .param("centre", &P::centre, "x, y, z of a ball's centre, in the coordinates of the file.", size(3))
        .param("radius", &P::radius, "Points up to this distance from the centre are kept.", at_least(0))
        .param("within", &P::within, "Points up to this distance from the value at `near` are kept.", at_least(0))
        .metric("kept", Unit::count, "Points kept.", headline)
        .metric("removed", Unit::count, "Points removed.")
        .run([](const Inputs& inputs, const P& params, Context& context) {
            return Outputs().set("points", cropped(inputs, params, context).points);
        })
        .run_streamed({}, [](const PointStream& scan, const P& params, Context& context) {
            return Outputs().set("points", crop(scan, params, context).points);
        });
}
